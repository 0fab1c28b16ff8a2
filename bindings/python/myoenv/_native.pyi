"""The compiled half of `myoenv`. Arrays are NumPy's; lengths m, times s, forces N, angles rad."""

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Self, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "ActionError",
    "Bodies",
    "BusyError",
    "ClosedError",
    "DeviceError",
    "Env",
    "ForkedError",
    "Model",
    "NeedsResetError",
    "Policy",
    "Session",
    "Simulation",
    "Task",
    "TaskError",
    "TrainingError",
    "__version__",
    "check_recordings",
    "compare",
    "default_settings",
    "devices",
    "evaluation_seed",
    "fit",
    "fitting_candidates",
    "fitting_layouts",
    "fitting_settings",
    "misfits",
    "model_names",
    "preset_names",
    "run_config",
    "task_batches",
    "task_schema",
    "train_at_once",
    "trained_users",
    "trajectories",
    "write_whole",
    "xla_step_handler",
]

__version__: str

class TaskError(ValueError):
    """A task or model that cannot be read, checked or simulated."""

class ActionError(ValueError):
    """Actions of the wrong shape or type, or not finite."""

class ClosedError(RuntimeError):
    """An environment was used after it was closed."""

class ForkedError(RuntimeError):
    """An object was used in a process forked after it was made."""

class BusyError(RuntimeError):
    """Two threads used one object at the same time."""

class NeedsResetError(RuntimeError):
    """A finished environment was stepped, with autoreset disabled."""

class DeviceError(RuntimeError):
    """A graphics card cannot be had, or failed."""

class TrainingError(RuntimeError):
    """Training cannot start or go on."""

def preset_names() -> list[str]:
    """Names of the tasks that come with the library."""

def task_schema() -> str:
    """JSON Schema of a task file, as JSON."""

def model_names() -> list[str]:
    """Names of the models that come with the library."""

def devices() -> list[tuple[str, str]]:
    """Graphics cards that answer, best first: name and kind (`discrete`, `integrated`, ...)."""

def default_settings(user: str) -> str:
    """The settings of PPO that users of a kind learn with, as JSON."""

def compare(first: str, second: str) -> str:
    """What users of two layouts allow to say, from two groups as JSON; JSON with the sentences."""

def task_batches(tasks: Sequence[Task], model: Model) -> list[list[int]]:
    """Which of these tasks users can do at once on a graphics card: batches of their numbers."""

def train_at_once(
    tasks: Sequence[Task],
    model: Model,
    seeds: Sequence[int],
    *,
    config: str,
    device: str | None,
    until: str,
    steps: int,
) -> tuple[list[tuple[str | None, str]], BaseException | None]:
    """Users of one batch, trained at once on a graphics card: for each, how it went as JSON, or what went wrong.

    And what a signal handler raised meanwhile.
    """

def trained_users(name: str, runs: Sequence[str | PathLike[str]]) -> str:
    """The users of some runs of one layout, as JSON for `compare`."""

def run_config(path: str | PathLike[str]) -> str:
    """`config.json` of a run folder, refused if no training could have begun with it."""

def misfits(run: str | PathLike[str], task: Task, model: Model) -> list[str]:
    """What keeps the user of a run from doing another task, as half sentences; none if it can."""

def trajectories(
    run: str | PathLike[str], policy: Policy, episodes: int, seed: int
) -> dict[str, NDArray[np.uint32] | NDArray[np.float64] | list[str]]:
    """Columns of `episodes` episodes of each layout of a run, by their names."""

def fitting_candidates(task: Task, vision_delay_ms: list[float], height_m: list[float]) -> list[tuple[str, str]]:
    """Among whom is looked: of each delay (ms) with each stature (m), what its folder is called behind that of the user
    of the task, and its task as a text."""

def fitting_layouts(task: Task) -> list[str]:
    """The layouts in which the user of a task learns to be anybody, as texts of tasks."""

def fitting_settings(task: Task) -> str:
    """Settings with which it learns that, as JSON."""

def check_recordings(table: str, together: bool, task: Task, model: Model) -> None:
    """Refuses a table whose people no user of this task can be fitted to."""

def fit(
    runs: list[list[str]],
    task: Task,
    model: Model,
    among: tuple[list[float], list[float]],
    table: str,
    together: bool,
    seed: int,
    threads: int | None,
) -> str:
    """The user who comes nearest to each of the people of a table, as JSON. `runs` are the trainings of who learnt
    to be anybody, in the order of `fitting_candidates` of `task`, each in `fitting_layouts` of its own."""

def write_whole(path: str | PathLike[str], contents: bytes) -> None:
    """Writes a file so that whoever looks, whenever, finds the old contents or all of the new ones.

    A link is followed, a file that must not be written is refused, and anything else than a regular file, such as a
    pipe, is written to directly.
    """

def xla_step_handler() -> int:
    """Address of the handler that steps environments in programs of XLA, for `jax.ffi.pycapsule`."""

def evaluation_seed(training_seed: int, number: int) -> int:
    """A seed for the `number`-th evaluation of a training that is not the training's own; 0 is that of `evaluate`."""

@final
class Task:
    """A task: targets to point at or to press within a time limit.

    Lengths are metres from the shoulder centre (x forward, y to the left, z up), times seconds, forces newtons.
    """

    @staticmethod
    def load(name_or_path: str) -> Task:
        """A preset by its name, or a YAML file."""
    @staticmethod
    def from_yaml(text: str, name: str = "task") -> Task:
        """A YAML text; `name` stands in messages. JSON is YAML, too."""
    def done_as(self, other: Task) -> Task:
        """The same done by the user of another task, with that user's body, where this text says nothing of them."""
    def to_yaml(self) -> str:
        """The task as a YAML file, every field written out."""
    def to_json(self) -> str:
        """The task as JSON, with the keys of a task file."""
    def check(self, model: Model) -> list[str]:
        """Refuses what the body cannot do; returns sentences about what is odd."""
    @property
    def name(self) -> str:
        """Short name."""
    @property
    def model(self) -> str:
        """Name of the body that does it."""
    @property
    def num_targets(self) -> int:
        """Number of targets, repetitions counted."""
    @property
    def is_preset(self) -> bool:
        """Whether it is a preset as it comes with the library: these need no check."""

@final
class Model:
    """A body: bodies, joints, sites, muscles."""

    def __new__(cls, name: str = "mobl-arms") -> Self:
        """A model that comes with the library, by its name."""
    @staticmethod
    def from_yaml(text: str, name: str = "model") -> Model:
        """A YAML text; `name` stands in messages. JSON is YAML, too."""
    @staticmethod
    def from_mjcf(
        file: str | PathLike[str],
        landmarks: tuple[str, str, str | None, str | None, Mapping[str, str]],
        without_contacts: bool,
        side_rule: str,
        locked: Sequence[str],
        root: str | PathLike[str] | None,
    ) -> tuple[Model, list[str]]:
        """A model of MuJoCo's file, and what of it has no part in the simulation; see `myoenv.import_model`."""
    def to_yaml(self) -> str:
        """The model as a YAML file."""
    def to_json(self) -> str:
        """The model as JSON, with the keys of a model file."""
    def to_mjcf(self) -> str:
        """The model for MuJoCo."""
    @property
    def name(self) -> str:
        """Short name."""
    def tables(self) -> dict[str, Any]:
        """Every table as arrays, one row per entity, the entity first in each name.

        Bodies (the world first): `body_name` (list), `body_parent` (index), `body_pos` (3, m, in the parent's frame),
        `body_quat` (4, w x y z), `body_mass` (kg), `body_com` (3, m), `body_inertia` (3, 3, kg m^2, body axes).
        Joints: `joint_name` (list), `joint_kind` (list of `hinge`, `slide`, `ball`, `free`), `joint_body`,
        `joint_axis` (3, zero of ball and free joints), `joint_pos` (3, m), `joint_range` (2, rad or m, infinite without
        limits), `joint_stiffness`, `joint_spring_ref`, `joint_damping`, `joint_armature`.
        Couplings: `coupling_dependent`, `coupling_independent` (joint, -1 for a joint that is held),
        `coupling_polycoef` (5, constant first).
        Sites: `site_name` (list), `site_body`, `site_pos` (3, m, in the body's frame).
        Muscles: `muscle_name` (list), `muscle_path` (list of arrays of sites), `muscle_branch` (list of arrays: the
        elements of the path with which branches behind pulleys begin), `muscle_divisor` (list of arrays: what their
        lengths are divided by), `muscle_limit` (2, m, infinite without limits), `muscle_length_range` (2, m),
        `muscle_range` (2, optimal lengths), `muscle_force` (N, NaN where it follows from `muscle_scale`),
        `muscle_scale`, `muscle_lmin`, `muscle_lmax`, `muscle_vmax`, `muscle_fvmax`, `muscle_fpmax`,
        `muscle_tau_act` (s), `muscle_tau_deact` (s), `muscle_ctrl_range` (2).
        """

@final
class Simulation:
    """One body, stepped directly: the double-precision reference. Coupled joints follow the independent ones.

    Positions are metres from the shoulder centre (x forward, y to the left, z up). Arrays are copies; assign a whole
    array to `qpos`, `qvel` or `activation` to set it. What follows from the state is computed when it is asked for.
    """

    def __new__(cls, model: Model, task: Task | None = None) -> Self:
        """A body at rest in the zero pose; with a task, its buttons can be touched."""
    def step(self, ctrl: ArrayLike, steps: int = 1) -> None:
        """Advances `steps` physics steps under excitations `(nmuscle,)` in [0, 1]."""
    def reset(self) -> None:
        """Back to rest in the zero pose."""
    @property
    def time(self) -> float:
        """Seconds simulated."""
    @property
    def timestep(self) -> float:
        """Seconds per physics step."""
    @property
    def qpos(self) -> NDArray[np.float64]:
        """Positions of the independent joints (rad or m), `(ndof,)`."""
    @qpos.setter
    def qpos(self, values: ArrayLike) -> None: ...
    @property
    def qvel(self) -> NDArray[np.float64]:
        """Their rates (1/s), `(ndof,)`."""
    @qvel.setter
    def qvel(self, values: ArrayLike) -> None: ...
    @property
    def activation(self) -> NDArray[np.float64]:
        """Muscle activations in [0, 1], `(nmuscle,)`."""
    @activation.setter
    def activation(self, values: ArrayLike) -> None: ...
    @property
    def qacc(self) -> NDArray[np.float64]:
        """Accelerations of the independent joints in this state (rad/s^2), `(ndof,)`."""
    @property
    def mass_matrix(self) -> NDArray[np.float64]:
        """Mass matrix of the independent joints (kg m^2), `(ndof, ndof)`."""
    @property
    def joint_positions(self) -> NDArray[np.float64]:
        """Positions of all joints of the model, coupled ones included (rad or m), `(njoint,)`."""
    @property
    def tendon_length(self) -> NDArray[np.float64]:
        """Lengths of the muscles' paths (m), `(nmuscle,)`."""
    @property
    def tendon_velocity(self) -> NDArray[np.float64]:
        """Their rates (m/s), `(nmuscle,)`."""
    @property
    def moment_arms(self) -> NDArray[np.float64]:
        """Moment arms (m), `(nmuscle, ndof)`: minus the derivative of length with respect to position, so that force
        times moment arm is the torque of the muscle."""
    @property
    def muscle_force(self) -> NDArray[np.float64]:
        """Muscle forces (N), `(nmuscle,)`, positive when pulling."""
    @property
    def contact_force(self) -> float:
        """Sum of normal forces on the button that the fingertip touches (N), 0 without contact."""
    @property
    def fingertip(self) -> NDArray[np.float64]:
        """Position of the fingertip (m), `(3,)`."""
    @property
    def body_positions(self) -> NDArray[np.float64]:
        """Origins of all bodies (m), `(nbody, 3)`, the world first."""
    @property
    def joint_names(self) -> list[str]:
        """Names of the independent joints, in the order of `qpos`."""
    @property
    def muscle_names(self) -> list[str]:
        """Names of the muscles."""
    @property
    def body_names(self) -> list[str]:
        """Names of the bodies."""

@final
class Bodies:
    """Bodies of one kind without a task, stepped side by side on all threads, in single precision.

    Arrays are copies. Positions of sites are in axes of the model's world.
    """

    def __new__(
        cls, model: Model, num_bodies: int, *, soft_couplings: bool = False, threads: int | None = None
    ) -> Self:
        """So many bodies at rest in the pose of reference: joints at zero, free bodies where the model puts them. With
        `soft_couplings` coupled joints have positions of their own, held together by soft constraints as MuJoCo's are;
        else they follow the independent ones."""
    def step(self, ctrl: NDArray[np.float32], steps: int = 1) -> None:
        """Advances all by `steps` physics steps under excitations `(num_bodies, nmuscle)`, clipped to [0, 1]."""
    def set(
        self,
        bodies: NDArray[np.int64],
        qpos: NDArray[np.float64],
        qvel: NDArray[np.float64],
        activation: NDArray[np.float64],
    ) -> None:
        """Gives these bodies positions `(n, nq)`, rates `(n, ndof)` and activations `(n, nmuscle)`."""
    def site_positions(self, sites: Sequence[str], qpos: NDArray[np.float64] | None = None) -> NDArray[np.float64]:
        """Positions of sites in these poses `(n, nq)`, in axes of the model's world (m), `(n, nsite, 3)`; poses of
        the bodies if none are told."""
    def sensors(self) -> dict[str, NDArray[np.float64]]:
        """What sensors read of the bodies as they are now, in double precision: `(num_bodies, size)` of each, by its
        name."""
    @property
    def sensor_names(self) -> list[str]:
        """Names of the sensors, in the order of the model."""
    @property
    def sensor_sizes(self) -> list[int]:
        """How many numbers each sensor reads."""
    @property
    def qpos(self) -> NDArray[np.float32]:
        """Positions of the joints (rad or m), `(num_bodies, nq)`: of a ball joint a quaternion (w, x, y, z), of a free
        one its place in the world and then that."""
    @property
    def qvel(self) -> NDArray[np.float32]:
        """Rates of the coordinates (rad/s or m/s), `(num_bodies, ndof)`: of ball and free joints three and six."""
    @property
    def activation(self) -> NDArray[np.float32]:
        """Muscle activations in [0, 1], `(num_bodies, nmuscle)`."""
    @property
    def joint_names(self) -> list[str]:
        """Names of the coordinates that have rates, in their order: of the joints, and of ball and free joints with
        `_tx` to `_rz`."""
    @property
    def joint_ranges(self) -> NDArray[np.float64]:
        """Limits of these coordinates (rad or m), `(ndof, 2)`; infinite where there are none."""
    @property
    def muscle_names(self) -> list[str]:
        """Names of the muscles."""
    @property
    def timestep(self) -> float:
        """Seconds per physics step."""

@final
class Policy:
    """A trained policy, as `myoenv.Policy` wraps it."""

    @staticmethod
    def load(path: str | PathLike[str]) -> Policy:
        """The newest whole checkpoint of a run folder, or a checkpoint file."""
    @staticmethod
    def from_weights(
        weights: dict[str, NDArray[np.float32]], observation_names: list[str], action_names: list[str]
    ) -> Policy:
        """A policy of arrays as `weights` returns them."""
    def weights(self) -> dict[str, NDArray[np.float32]]:
        """Everything that an action is computed from, by name; see `myoenv.Policy.weights`."""
    def act(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        """Mean actions `(rows, actions)` for observations `(rows, observations)`."""
    @property
    def observation_names(self) -> list[str]:
        """Names of the observations that it was trained on, in order."""
    @property
    def action_names(self) -> list[str]:
        """Names of the actions, in order: muscles."""

@final
class Env:
    """Environments without Gymnasium: strict about types, `(num_envs, ...)` arrays in and out."""

    def __new__(
        cls,
        layouts: Sequence[Task],
        model: Model,
        num_envs: int,
        *,
        seed: int,
        autoreset: str,
        backend: str,
        device: str | None,
        threads: int | None,
        copy: bool,
    ) -> Self: ...
    def reset(self, seed: int | None, seeds: list[int] | None, mask: NDArray[np.bool_] | None) -> NDArray[np.float32]:
        """Starts episodes where `mask` says so, else everywhere; returns all observations.

        `seed` restarts the random streams of the batch, `seeds` gives each environment its own.
        """
    def step(
        self, actions: NDArray[np.float32]
    ) -> tuple[
        NDArray[np.float32],
        NDArray[np.float32],
        NDArray[np.bool_],
        NDArray[np.bool_],
        tuple[NDArray[np.int64], NDArray[np.float32], NDArray[np.float32]] | None,
    ]:
        """One control step: observation, reward, terminated, truncated, and of the episodes that ended, if any, the
        environments, the last observations and the summaries."""
    def time_steps(self, actions: NDArray[np.float32], steps: int) -> NDArray[np.float64]:
        """Seconds that each of so many steps took without Python: what its overhead is measured against."""
    def save_state(self) -> bytes:
        """Everything that the next steps depend on."""
    def load_state(self, state: bytes) -> None:
        """Goes back to what `save_state` returned, bit for bit."""
    def set_task(self, task: Task) -> None:
        """Goes on with another task of the same structure; a reset of all must follow."""
    def peek(self, start: int, stop: int) -> dict[str, Any]:
        """The fields of `myoenv.Peek` for the environments from `start` up to `stop`, by name."""
    def render(self, start: int, stop: int, size: tuple[int, int]) -> list[NDArray[np.uint8]]:
        """Pictures of the environments from `start` up to `stop`, `(height, width, 3)` each."""
    def close(self) -> None:
        """Frees the environments, after a step that is going on; a second time does nothing."""
    def xla_id(self) -> int:
        """A number by which programs of XLA know these environments."""
    @property
    def token(self) -> list[int]:
        """Names the present state: a number of these environments, and one that every reset and step changes."""
    def check_token(self, token: Sequence[int]) -> None:
        """Refuses the token of any state but the present one."""
    @property
    def num_envs(self) -> int:
        """How many environments."""
    @property
    def observation_names(self) -> list[str]:
        """Names of the entries of an observation, in order."""
    @property
    def action_names(self) -> list[str]:
        """Names of the entries of an action, in order: muscles."""
    @property
    def episode_names(self) -> list[str]:
        """Names of the entries of an episode's summary, in order."""
    @property
    def control_dt(self) -> float:
        """Seconds of a control step."""
    @property
    def max_episode_steps(self) -> int:
        """Control steps after which an episode is over in any case."""
    @property
    def backend(self) -> str:
        """`cpu` or `gpu`."""
    @property
    def device(self) -> str | None:
        """Name of the graphics card, if it is one."""
    @property
    def observation_bounds(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Least and greatest value of every entry of the observation."""

@final
class Session:
    """A training; `myoenv.train` loops over it. `start_from` is a run folder or a checkpoint."""

    def __new__(
        cls,
        layouts: Sequence[Task],
        model: Model,
        *,
        config: str,
        seed: int,
        backend: str,
        device: str | None,
        threads: int | None,
        until: str,
        steps: int,
        start_from: str | PathLike[str] | None,
    ) -> Self: ...
    @staticmethod
    def resume(
        run: str | PathLike[str],
        *,
        backend: str | None,
        device: str | None,
        threads: int | None,
        until: str | None,
        steps: int | None,
    ) -> Session:
        """Continues the training of a run folder: on the device where it began, unless a backend or a device is given,
        and with its own `until` and `steps`, unless others are given."""
    def description(self) -> str:
        """What is trained, on what, until when: the parts `run`, `ppo` and `seed` of `config.json`."""
    def record_in(self, path: str | PathLike[str]) -> None:
        """Makes a run folder, where metrics, checkpoints and the evaluation are kept."""
    def record_on(self) -> None:
        """Records in the run folder that it was resumed from, and keeps the goal that it has now there."""
    def advance(self) -> dict[str, Any]:
        """One update, its record, and a look at the goal when it is time to.

        Keys: `metrics`, what `metrics.csv` has as columns, or None when the training went back to an earlier state;
        `line`, how it goes, or None likewise; `news`, sentences; `end`, None until the training is over; `reason`, of
        the loss of a graphics card; `raised`, what a signal handler raised meanwhile, which is left to the caller.
        After an error the training is over and writes nothing more.
        """
    def conclude(self, end: str) -> tuple[str, BaseException | None]:
        """Closes the training after the `end` that `advance` told, or another: a last checkpoint, and, unless it was
        interrupted or lost, the evaluation. How it went as JSON, and what a signal handler raised meanwhile, which ends
        the evaluation and is left to the caller."""
    def leave(self) -> None:
        """Leaves the run folder to others. A training that is whole and was not concluded leaves a checkpoint there."""
    def policy(self) -> Policy:
        """A copy of the policy as it is now."""
    @property
    def env_steps(self) -> int:
        """Control steps of all environments since the start."""
    @property
    def over(self) -> str | None:
        """Why there is nothing left to train, if so: `until`, `plateau` or `steps`."""
    @property
    def confirmed_success(self) -> float | None:
        """Share of success that confirmed the goal, if an evaluation did."""
    @property
    def is_evaluated(self) -> bool:
        """Whether the run being resumed has the evaluation of its newest checkpoint."""
