"""Simulated users made of muscle: describe a pointing or pressing task, train a muscle-driven arm on it.

>>> import myoenv
>>> envs = myoenv.make_vec("pointing", 1024, seed=1)
>>> observations, infos = envs.reset()

- `make_vec`, `make`: environments for Gymnasium; importing this package registers `myo/Pointing-v0` and the like
- `myoenv.myosuite`: MyoSuite's environments of elbow, finger, hand and arm, side by side
- `myoenv.sb3.MyoVecEnv`: environments for Stable-Baselines3
- `check_vec_env`: does a vector environment, of anybody, keep its promises
- `train`, `Policy`, `evaluate`: the library's own PPO; `Policy` goes to NumPy, PyTorch and ONNX and back
- `trajectories`: what a user does, physics step by physics step
- `fit`: which user moves as the people of recordings do
- `Callback`, `myoenv.callbacks`: what follows a training, among them Weights & Biases and MLflow
- `myoenv.sweep`, `myoenv.tune`: many trainings, with Ray and Ray Tune
- `build_task`, `myoenv.scene`: tasks built from objects; `task_schema`: the format of task files
- `Task`, `Model`, `Simulation`, `Bodies`: what to do, who does it, and the body alone, one or many; `import_model`:
  bodies of MuJoCo's files
"""

import os as _os

if _os.name == "posix" and "XDG_RUNTIME_DIR" not in _os.environ:
    # Without a graphical session, a layer of Mesa complains on standard error whenever graphics cards are listed. It
    # only chooses where windows are drawn, so it is left out.
    _os.environ.setdefault("NODEVICE_SELECT", "1")

from myoenv import myosuite
from myoenv._native import (
    ActionError,
    Bodies,
    BusyError,
    ClosedError,
    DeviceError,
    ForkedError,
    Model,
    NeedsResetError,
    Simulation,
    Task,
    TaskError,
    TrainingError,
    __version__,
    devices,
    model_names,
    preset_names,
)
from myoenv.check import CheckError, check_vec_env
from myoenv.comparison import compare
from myoenv.evaluation import evaluate
from myoenv.fitting import fit
from myoenv.peek import Peek
from myoenv.policy import Policy
from myoenv.registration import env_id, register_envs
from myoenv.scene import build_task
from myoenv.session import Callback, TrainResult
from myoenv.single import MyoEnv, make
from myoenv.tasks import import_model, load_model, load_task, task_schema, to_dict
from myoenv.training import train
from myoenv.trajectories import trajectories
from myoenv.vector import MyoVectorEnv, make_vec

__all__ = [
    "ActionError",
    "Bodies",
    "BusyError",
    "Callback",
    "CheckError",
    "ClosedError",
    "DeviceError",
    "ForkedError",
    "Model",
    "MyoEnv",
    "MyoVectorEnv",
    "NeedsResetError",
    "Peek",
    "Policy",
    "Simulation",
    "Task",
    "TaskError",
    "TrainResult",
    "TrainingError",
    "__version__",
    "build_task",
    "check_vec_env",
    "compare",
    "devices",
    "env_id",
    "evaluate",
    "fit",
    "import_model",
    "load_model",
    "load_task",
    "make",
    "make_vec",
    "model_names",
    "myosuite",
    "preset_names",
    "register_envs",
    "task_schema",
    "to_dict",
    "train",
    "trajectories",
]

register_envs()
myosuite.register_envs()
