"""Reads MyoSuite's tasks and bodies into the data of `myoenv.myosuite`, and what its environments do into a reference.

Where `myosuite` is installed, with a program of this library:

python bindings/tests/myosuite_data.py target/debug/myo

Or, with this library's package beside it, how far more episodes are from MyoSuite's:

python bindings/tests/myosuite_data.py compare
"""

import importlib.metadata
import json
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path
from xml.etree import ElementTree

import gymnasium
import myosuite  # noqa: F401  (registers its environments)
import numpy as np
from myosuite.terms import base_reward
from myosuite.utils import reach_workspace

PACKAGE = Path(__file__).resolve().parents[1] / "python/myoenv/myosuite"
REFERENCE = Path(__file__).resolve().parent / "references/myosuite.npz"
#: Body, its file, the site that points, the body at the shoulder.
BODIES = {
    "Elbow": ("myoelbow", "wrist", "r_humerus"),
    "Finger": ("myofinger", "IFtip", "proximal"),
    "Hand": ("myohand", "IFtip_r", "humerus_r"),
    "Arm": ("myoarm", "IFtip", "humerus_r"),
}
IDS = [
    *(f"myoElbowPose1D6M{kind}-v0" for kind in ("Fixed", "Random")),
    *(f"myoFinger{task}{kind}-v0" for task in ("Pose", "Reach") for kind in ("Fixed", "Random")),
    *(f"myoHandPose{numeral}Fixed-v0" for numeral in ("", *range(10))),
    "myoHandPoseRandom-v0",
    *(f"my{body}Reach{kind}-v0" for body in ("oHand", "oArm") for kind in ("Fixed", "Random")),
]
#: Steps of an episode that are kept, and episodes that are compared.
STEPS = 25
EPISODES = 20


def body_of(env_id):
    return next(known for part, known in BODIES.items() if env_id.startswith(f"myo{part}"))


def task_of(env):
    """What an environment asks, as numbers and words."""
    inner, spec = env.unwrapped, env.spec
    if inner.rwd_keys_wt.keys() - {"pose", "reach", "bonus", "penalty", "act_reg"}:
        raise SystemExit(f"{spec.id}: unknown rewards {inner.rwd_keys_wt}")
    task = {
        "body": body_of(spec.id)[0],
        "frame_skip": inner.frame_skip,
        "max_episode_steps": gymnasium.spec(spec.id).max_episode_steps or steps_of(env),
        "weights": inner.rwd_keys_wt,
        "init_qpos": list(map(float, inner._init_qpos)),
    }
    if hasattr(inner, "pose_thd"):
        generated = inner.target_type == "generate"
        low, high = inner._target_jnt_range.T if generated else (inner.target_jnt_value, inner.target_jnt_value)
        return task | {
            "kind": "pose",
            "generated": generated,
            "low": list(map(float, low)),
            "high": list(map(float, high)),
            "near": inner.pose_thd,
            "bonus_within": base_reward._POSE_BONUS_FAR_MULTIPLIER,
            "far": float(base_reward._POSE_PENALTY_THRESHOLD),
            "random_start": inner.reset_type == "random",
        }
    spans = inner.target_reach_range
    return task | {
        "kind": "reach",
        "tips": list(spans),
        "low": [list(map(float, low)) for low, _ in spans.values()],
        "high": [list(map(float, high)) for _, high in spans.values()],
        "within_reach": inner.target_sampling == "workspace",
        "far_per_tip": inner.far_th,
    }


def steps_of(env):
    """The time limit, where a wrapper has it alone."""
    while not hasattr(env, "_max_episode_steps"):
        env = env.env
    return env._max_episode_steps


def episode_of(env):
    """The beginning of an episode under actions of chance."""
    rng = np.random.default_rng(7)
    observations = [env.reset(seed=3)[0]]
    rewards, terminations, solutions, actions = [], [], [], []
    for _ in range(STEPS):
        action = rng.uniform(-1, 1, env.action_space.shape).astype(np.float32)
        observation, reward, terminated, _, info = env.step(action)
        observations.append(observation)
        rewards.append(reward)
        terminations.append(terminated)
        solutions.append(bool(np.asarray(info["solved"]).item()))
        actions.append(action)
        if terminated:
            break
    return {
        "observations": np.array(observations, np.float32),
        "rewards": np.array(rewards),
        "terminated": np.array(terminations),
        "solved": np.array(solutions),
        "actions": np.array(actions, np.float32),
    }


def exact(xml, model):
    """MuJoCo writes six digits; this gives a model all of them, so that bodies move alike for more than some steps."""
    root = ElementTree.fromstring(xml)

    def write(element, **values):
        for key, value in values.items():
            element.set(key, " ".join(repr(float(x)) for x in np.ravel(value)))

    # What a frame moves stands in the file as it is within that frame, and in the model as it is on its body.
    framed = {body for frame in root.iter("frame") for body in frame.findall("body")}
    for body in root.iter("body"):
        own = model.body(body.get("name"))
        if body not in framed:
            write(body, pos=own.pos, quat=own.quat)
        for inertial in body.findall("inertial"):
            write(inertial, pos=own.ipos, quat=own.iquat, mass=own.mass, diaginertia=own.inertia)
    for joint in root.find("worldbody").iter("joint"):
        own = model.joint(joint.get("name"))
        write(joint, pos=own.pos, axis=own.axis, **({"range": own.range} if model.jnt_limited[own.id] else {}))
    for site in root.find("worldbody").iter("site"):
        write(site, pos=model.site(site.get("name")).pos)
    for muscle in root.find("actuator"):
        own = model.actuator(muscle.get("name"))
        write(muscle, lengthrange=own.lengthrange, gainprm=own.gainprm[:9], biasprm=own.biasprm[:9])
    return ElementTree.tostring(root, encoding="unicode")


def import_body(env, program, folder):
    """Its model as a model file of this library."""
    name, tip, shoulder = body_of(env.spec.id)
    out = PACKAGE / f"{name}.yaml"
    spec = env.unwrapped._mj_spec
    spec.compiler.saveinertial = True
    mjcf = folder / f"{name}.xml"
    mjcf.write_text(exact(spec.to_xml(), env.unwrapped.model))
    out.unlink(missing_ok=True)
    command = [program, "model", "import", mjcf, "--fingertip", tip, "--shoulder", shoulder, "--out", out]
    subprocess.run(command, check=True)


def compare():
    """Of each environment, the middle and the worst of how far observations of episodes are apart at most, and how many
    steps end or are solved in one of the two alone.
    """
    import myoenv  # noqa: F401  (registers ours)

    for env_id in IDS:
        theirs, ours = gymnasium.make(env_id), gymnasium.make(f"myosuite/{env_id}")
        apart, differ = [], 0
        for seed in range(EPISODES):
            rng = np.random.default_rng(100 + seed)
            apart.append(np.abs(theirs.reset(seed=seed)[0] - ours.reset(seed=seed)[0]).max())
            for _ in range(STEPS):
                action = rng.uniform(-1, 1, theirs.action_space.shape).astype(np.float32)
                (seen, _, ended, _, told), (own, _, own_ended, _, own_told) = theirs.step(action), ours.step(action)
                apart[-1] = max(apart[-1], np.abs(seen - own).max())
                differ += ended != own_ended or bool(np.asarray(told["solved"]).item()) != bool(own_told["solved"])
                if ended or own_ended:
                    break
        print(f"{env_id}: {np.median(apart):.1e} in the middle, {max(apart):.1e} at worst, {differ} steps differ")


def main(program):
    tasks, arrays, bodies = {}, {}, set()
    with tempfile.TemporaryDirectory() as folder:
        for env_id in IDS:
            env = gymnasium.make(env_id)
            tasks[env_id] = task_of(env)
            arrays |= {f"{env_id}/{name}": array for name, array in episode_of(env).items()}
            if (body := body_of(env_id)[0]) not in bodies:
                bodies.add(body)
                import_body(env, program, Path(folder))
    versions = {name: importlib.metadata.version(name) for name in ("myosuite", "myo-sim", "mujoco")}
    (PACKAGE / "tasks.json").write_text(json.dumps({"from": versions, "tasks": tasks}, indent=1) + "\n")
    REFERENCE.parent.mkdir(exist_ok=True)
    np.savez_compressed(REFERENCE, **arrays)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    # With MuJoCo 4 its search for targets within reach takes no joint for a hinge, and all targets are where the tip is
    # at rest. Numbers in place of names are what is meant.
    reach_workspace._JOINT_TYPES = tuple(map(int, reach_workspace._JOINT_TYPES))
    if sys.argv[1] == "compare":
        compare()
    else:
        main(Path(sys.argv[1]).resolve())
