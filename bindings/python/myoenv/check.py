"""A checker for vector environments: does one keep the promises of Gymnasium's `VectorEnv`?"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

# Seeds of two runs that must differ.
_SEED, _OTHER_SEED = 123, 456


class CheckError(AssertionError):
    """A vector environment breaks a promise; the message is one sentence."""


def check_vec_env(env: VectorEnv, *, steps: int = 1000, actions: Callable[[], Any] | None = None) -> list[str]:
    """Checks a vector environment, anybody's, and returns the names of the checks that it passed.

    Checked: metadata and spaces; observations lie in them, rewards are finite, flags are bool; one seed gives one
    sequence, another seed another; resets differ; masks reset what they name; the declared autoreset mode is kept, with
    terminal observations and masks in their places; arrays and infos are not reused between calls.

    Args:
        env: The environment; it is left open, and reset.
        steps: Steps to wait at most for the end of an episode; what needs one is left out without.
        actions: What to do, such as the actions of a policy that succeeds; random actions by default.

    Raises:
        CheckError: A promise is broken.
    """
    _require(isinstance(env, VectorEnv), f"it is a {type(env).__name__}, no gymnasium.vector.VectorEnv")
    checker = _Checker(env, steps, actions or env.action_space.sample)
    for check in checker.checks():
        if check() is not False:
            checker.passed.append(check.__name__.lstrip("_"))
    env.reset(seed=_SEED)
    return checker.passed


def _require(condition: Any, sentence: str) -> None:
    if not condition:
        raise CheckError(sentence)


def _leaves(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    """Everything in nested dictionaries and tuples, with its path."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _leaves(inner, f"{name}[{key!r}]")
    elif isinstance(value, tuple):
        for k, inner in enumerate(value):
            yield from _leaves(inner, f"{name}[{k}]")
    else:
        yield name, value


def _same(a: Any, b: Any) -> bool:
    pairs = zip(_leaves(a, ""), _leaves(b, ""), strict=True)
    return all(
        np.array_equal(np.asarray(x), np.asarray(y), equal_nan=np.asarray(x).dtype.kind == "f")
        for (_, x), (_, y) in pairs
    )


def _copy(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _copy(inner) for key, inner in value.items()}
    if isinstance(value, tuple):
        return tuple(_copy(inner) for inner in value)
    return np.array(value, copy=True)


def _row(value: Any, env: int) -> Any:
    """The part of a batched observation that belongs to one environment."""
    if isinstance(value, dict):
        return {key: _row(inner, env) for key, inner in value.items()}
    if isinstance(value, tuple):
        return tuple(_row(inner, env) for inner in value)
    return np.asarray(value)[env]


class _Checker:
    def __init__(self, env: VectorEnv, steps: int, actions: Callable[[], Any]) -> None:
        self.env, self.steps, self.actions = env, steps, actions
        self.passed: list[str] = []
        self.mode: AutoresetMode | None = None

    def checks(self) -> list[Callable[[], bool | None]]:
        """In order; a check that returns False could not be made."""
        return [
            self._metadata,
            self._spaces,
            self._outputs,
            self._determinism,
            self._resets_differ,
            self._no_shared_memory,
            self._infos,
            self._reset_mask,
            self._autoreset,
        ]

    def _step(self, actions: Any | None = None) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        return self.env.step(self.actions() if actions is None else actions)

    def _metadata(self) -> None:
        self.mode = self.env.metadata.get("autoreset_mode")
        _require(
            isinstance(self.mode, AutoresetMode),
            f"metadata['autoreset_mode'] is {self.mode!r}; it must be a member of AutoresetMode",
        )
        _require(isinstance(self.env.num_envs, int) and self.env.num_envs > 0, f"num_envs is {self.env.num_envs!r}")

    def _spaces(self) -> None:
        for kind in ("observation", "action"):
            single: Any = getattr(self.env, f"single_{kind}_space", None)
            batch = getattr(self.env, f"{kind}_space", None)
            _require(isinstance(single, gymnasium.Space), f"single_{kind}_space is no space but {single!r}")
            _require(
                batch == batch_space(single, self.env.num_envs), f"{kind}_space is not single_{kind}_space batched"
            )

    def _check_observation(self, observation: Any, where: str) -> None:
        for env in range(self.env.num_envs):
            row = _row(observation, env)
            if not self.env.single_observation_space.contains(row):
                raise CheckError(f"the observation of environment {env} after {where} is not in the observation space")

    def _outputs(self) -> None:
        answer = self.env.reset(seed=_SEED)
        _require(isinstance(answer, tuple) and len(answer) == 2, "reset must return observations and infos")
        self._check_observation(answer[0], "a reset")
        for k in range(20):
            observation, reward, terminated, truncated, infos = self._step()
            self._check_observation(observation, f"step {k + 1}")
            shape = (self.env.num_envs,)
            _require(np.shape(reward) == shape, f"rewards have the shape {np.shape(reward)}, expected {shape}")
            _require(np.isfinite(reward).all(), f"a reward of step {k + 1} is not finite")
            for name, flags in (("terminations", terminated), ("truncations", truncated)):
                flags = np.asarray(flags)
                _require(flags.dtype == np.bool_, f"{name} are of type {flags.dtype}; they must be bool")
                _require(flags.shape == shape, f"{name} have the shape {flags.shape}, expected {shape}")
            _require(isinstance(infos, dict), f"infos are a {type(infos).__name__}; they must be a dictionary")
            self._reset_finished(terminated, truncated)

    def _reset_finished(self, terminated: Any, truncated: Any) -> None:
        done = np.logical_or(terminated, truncated)
        if self.mode is AutoresetMode.DISABLED and done.any():
            self.env.reset(options={"reset_mask": done})

    def _sequence(self, seed: int, count: int = 12) -> list[Any]:
        self.env.action_space.seed(seed)
        sequence = [_copy(self.env.reset(seed=seed)[0])]
        for _ in range(count):
            # Random actions even where others are wished: these may come from a stateful policy.
            step = self.env.step(self.env.action_space.sample())
            sequence.append(_copy(step[:4]))
            self._reset_finished(step[2], step[3])
        return sequence

    def _determinism(self) -> None:
        first, again, other = self._sequence(_SEED), self._sequence(_SEED), self._sequence(_OTHER_SEED)
        for k, (a, b) in enumerate(zip(first, again, strict=True)):
            _require(_same(a, b), f"the same seed gives other results at {'the reset' if k == 0 else f'step {k}'}")
        _require(not _same(first[0], other[0]), "another seed gives the same first observations")

    def _resets_differ(self) -> None:
        seeded = _copy(self.env.reset(seed=_SEED)[0])
        following = _copy(self.env.reset()[0])
        _require(not _same(seeded, following), "a reset without a seed repeats the one with a seed")
        _require(not _same(following, self.env.reset()[0]), "two resets without a seed give the same observations")
        if self.env.num_envs > 1:
            _require(
                not _same(_row(seeded, 0), _row(seeded, 1)),
                "two environments start with the same observation under one seed",
            )

    def _no_shared_memory(self) -> None:
        answers: list[Any] = [self.env.reset(seed=_SEED)]
        kept = [_copy(answers[0][0])]
        for _ in range(3):
            answers.append(self._step())
            kept.append(_copy(answers[-1][:4]))
        for k, (answer, before) in enumerate(zip(answers, kept, strict=True)):
            now = answer[0] if k == 0 else answer[:4]
            _require(
                _same(now, before),
                f"what {'reset' if k == 0 else f'step {k}'} returned was overwritten by a later step",
            )
        infos = [answer[-1] for answer in answers]
        _require(len({id(info) for info in infos}) == len(infos), "the dictionary of infos is reused between calls")

    def _check_infos(self, infos: dict[str, Any], path: str = "infos") -> None:
        for key, value in infos.items():
            if key.startswith("_"):
                continue
            mask = infos.get(f"_{key}")
            _require(mask is not None, f"{path}[{key!r}] has no mask {path}['_{key}']")
            mask = np.asarray(mask)
            shape_is_right = mask.dtype == np.bool_ and mask.shape == (self.env.num_envs,)
            _require(shape_is_right, f"the mask {path}['_{key}'] must be a bool array of one entry per environment")
            if isinstance(value, dict):
                self._check_infos(value, f"{path}[{key!r}]")
            else:
                _require(
                    len(value) == self.env.num_envs,
                    f"{path}[{key!r}] has {len(value)} entries, not one per environment",
                )

    def _infos(self) -> None:
        self._check_infos(self.env.reset(seed=_SEED)[1])
        for _ in range(self.steps):
            _, _, terminated, truncated, infos = self._step()
            self._check_infos(infos)
            if np.logical_or(terminated, truncated).any():
                break
        self.env.reset(seed=_SEED)

    def _reset_mask(self) -> bool | None:
        if self.env.num_envs < 2:
            return False
        self.env.reset(seed=_SEED)
        before = _copy(self._step()[0])
        mask = np.zeros(self.env.num_envs, np.bool_)
        mask[0] = True
        after = self.env.reset(options={"reset_mask": mask})[0]
        _require(not _same(_row(before, 0), _row(after, 0)), "reset_mask does not reset the environment that it names")
        for env in range(1, self.env.num_envs):
            _require(
                _same(_row(before, env), _row(after, env)),
                f"reset_mask resets environment {env}, which it does not name",
            )
        for wrong in (np.zeros_like(mask), np.ones(self.env.num_envs + 1, np.bool_)):
            try:
                self.env.reset(options={"reset_mask": wrong})
            except Exception:
                continue
            what = "is false everywhere" if wrong.shape == mask.shape else "has a wrong shape"
            raise CheckError(f"a reset_mask that {what} is not refused")
        return None

    def _until_done(self) -> tuple[int, Any] | None:
        """Steps to the first end of an episode: its environment and what that step returned."""
        self.env.reset(seed=_SEED)
        for _ in range(self.steps):
            answer = self._step()
            done = np.logical_or(answer[2], answer[3])
            if done.any():
                return int(np.flatnonzero(done)[0]), answer
        return None

    def _autoreset(self) -> bool | None:
        ended = self._until_done()
        if ended is None:
            return False
        env, answer = ended
        if self.mode is AutoresetMode.SAME_STEP:
            self._same_step(env, answer)
        elif self.mode is AutoresetMode.NEXT_STEP:
            self._next_step(env, answer)
        else:
            self._disabled(env, answer)
        return None

    def _same_step(self, env: int, answer: Any) -> None:
        observation, _, terminated, truncated, infos = answer
        done = np.logical_or(terminated, truncated)
        for key in ("final_obs", "final_info"):
            _require(key in infos and f"_{key}" in infos, f"an episode ended and infos have no {key!r} with its mask")
            _require(
                np.array_equal(np.asarray(infos[f"_{key}"]), done),
                f"infos['_{key}'] does not name the episodes that ended",
            )
        last = infos["final_obs"][env]
        _require(
            self.env.single_observation_space.contains(last),
            "infos['final_obs'] of an episode that ended is no observation",
        )
        _require(
            not _same(last, _row(observation, env)),
            "the step that ends an episode must return the first observation of the next",
        )
        for other in np.flatnonzero(~done):
            _require(infos["final_obs"][other] is None, "infos['final_obs'] must be None where no episode ended")

    def _next_step(self, env: int, answer: Any) -> None:
        last = _copy(_row(answer[0], env))
        _require(
            "final_obs" not in answer[4],
            "next-step autoreset has no 'final_obs': the observation itself is the last one",
        )
        observation, reward, terminated, truncated, _ = self._step()
        _require(np.asarray(reward)[env] == 0, "the step that resets must give reward 0")
        _require(not (terminated[env] or truncated[env]), "the step that resets must not end an episode")
        _require(
            not _same(last, _row(observation, env)),
            "the step after the end must return the first observation of the next",
        )

    def _disabled(self, env: int, answer: Any) -> None:
        last = _copy(_row(answer[0], env))
        mask = np.logical_or(answer[2], answer[3])
        _require(
            "final_obs" not in answer[4],
            "without autoreset there is no 'final_obs': the observation itself is the last one",
        )
        observation, _ = self.env.reset(options={"reset_mask": mask})
        _require(not _same(last, _row(observation, env)), "a reset by mask does not start a new episode")
        self._step()
