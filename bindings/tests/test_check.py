"""The checker finds what it is to find."""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import myoenv


class Broken(gymnasium.vector.VectorWrapper):
    """An environment with one fault."""

    def __init__(self, env, fault):
        super().__init__(env)
        self.fault = fault
        self.kept = None
        if fault == "metadata":
            self.metadata = {**env.metadata, "autoreset_mode": "NextStep"}
        if fault == "space":
            self.action_space = env.single_action_space
        if fault == "wrong mode":
            self.metadata = {**env.metadata, "autoreset_mode": AutoresetMode.NEXT_STEP}

    def reset(self, *, seed=None, options=None):
        if self.fault == "deaf to seeds":
            seed = None
        if self.fault == "deaf to masks":
            options = None
        if self.fault == "same resets":
            seed = 0 if seed is None and not options else seed
        observation, infos = super().reset(seed=seed, options=options)
        if self.fault == "shared memory":
            self.kept = observation
        return observation, infos

    def step(self, actions):
        observation, reward, terminated, truncated, infos = super().step(actions)
        if self.fault == "shared memory":
            self.kept[:] = observation
            observation = self.kept
        if self.fault == "not finite":
            reward[0] = np.nan
        if self.fault == "flags":
            terminated = terminated.astype(int)
        if self.fault == "outside":
            observation += 10
        if self.fault == "lost terminal observation":
            infos.pop("final_obs", None)
        if self.fault == "no masks":
            infos.pop("_final_info", None)
        if self.fault == "final is next" and "final_obs" in infos:
            for i in np.flatnonzero(infos["_final_obs"]):
                infos["final_obs"][i] = observation[i]
        return observation, reward, terminated, truncated, infos


FAULTS = {
    "metadata": "member of AutoresetMode",
    "space": "not single_action_space batched",
    "deaf to seeds": "same seed gives other results",
    "deaf to masks": "reset_mask",
    "same resets": "give the same observations",
    "shared memory": "was overwritten",
    "not finite": "not finite",
    "flags": "must be bool",
    "outside": "not in the observation space",
    "lost terminal observation": "final_obs",
    "no masks": "has no mask",
    "final is next": "first observation of the next",
    "wrong mode": "has no 'final_obs'",
}


@pytest.mark.parametrize("fault", FAULTS)
def test_every_fault_is_found(make, short_task, fault):
    env = Broken(make(short_task, autoreset="same_step"), fault)
    with pytest.raises(myoenv.CheckError, match=FAULTS[fault]) as error:
        myoenv.check_vec_env(env)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("other", [3, myoenv.MyoVectorEnv, "CartPole-v1"])
def test_what_is_no_vector_environment_is_told(other):
    with pytest.raises(myoenv.CheckError, match=r"no gymnasium\.vector\.VectorEnv"):
        myoenv.check_vec_env(other)


def test_it_is_of_use_on_others():
    others = gymnasium.make_vec("CartPole-v1", num_envs=3, vectorization_mode="sync")
    assert "autoreset" in myoenv.check_vec_env(others)


def test_views_are_refused_as_what_they_are(make):
    with pytest.raises(myoenv.CheckError, match="overwritten"):
        myoenv.check_vec_env(make(copy=False))
