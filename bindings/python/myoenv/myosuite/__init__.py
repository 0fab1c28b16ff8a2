"""MyoSuite's environments, stepped side by side: its elbow, finger, hand and arm, posing and reaching.

>>> import myoenv.myosuite
>>> envs = myoenv.myosuite.make_vec("myoElbowPose1D6MRandom-v0", 64, seed=1)
>>> observations, infos = envs.reset()
>>> observations.shape, envs.single_action_space.shape
((64, 9), (6,))

Observations, rewards, terminations, time limits, seeds and what `solved` means are those of MyoSuite 3.0.0, and the
bodies those of its models (myo-sim 0.2.3) as MuJoCo 4.0.0 simulates them; numbers are single precision. Gymnasium has
them as `myosuite/myoElbowPose1D6MRandom-v0` and so on.

What it does not know: variants with tired, weak or rerouted muscles (`myoFati`, `myoSarc`, `myoReaf`), motors and
exoskeletons, pictures, and MyoSuite's other tasks.
"""

from __future__ import annotations

from myoenv.myosuite.envs import MyoSuiteEnv, MyoSuiteVectorEnv, make, make_vec
from myoenv.myosuite.tasks import SUITE, ids, load_body, register_envs

__all__ = ["SUITE", "MyoSuiteEnv", "MyoSuiteVectorEnv", "ids", "load_body", "make", "make_vec", "register_envs"]
