"""How much Python costs: `python bindings/examples/speed.py [--task TASK] [--envs N ...]`.

Steps with and without Python in turns, in one process, so that both see the same neighbours on a shared machine.
"""

import argparse
import time
from collections.abc import Callable

import numpy as np
from gymnasium.utils.performance import benchmark_vector_step

import myoenv


def python_steps(envs: myoenv.MyoVectorEnv, actions: np.ndarray, steps: int) -> list[float]:
    """Seconds of each step."""
    times = []
    for _ in range(steps):
        start = time.perf_counter()
        envs.step(actions)
        times.append(time.perf_counter() - start)
    return times


def overhead(task: str, num_envs: int, rounds: int, **kwargs) -> tuple[float, float]:
    """Seconds of a step in Rust and in Python, in turns: the lower decile, as a median would measure neighbours."""
    envs = myoenv.make_vec(task, num_envs, "cpu", seed=1, **kwargs)
    envs.reset()
    envs.action_space.seed(1)
    actions = envs.action_space.sample()
    rust, python = [], []
    for _ in range(rounds):
        rust.extend(envs._env.time_steps(actions, 10))
        python.extend(python_steps(envs, actions, 10))
    envs.close()
    return float(np.quantile(rust, 0.1)), float(np.quantile(python, 0.1))


def gymnasium_rates(task: str, num_envs: int, seconds: int, rounds: int) -> tuple[float, float]:
    """Control steps per second in Rust, and as Gymnasium measures them; best of the rounds."""
    envs = myoenv.make_vec(task, num_envs, "cpu", seed=1)
    envs.reset()
    actions = envs.action_space.sample()
    rust, gymnasium = [], []
    for _ in range(rounds):
        steps = round(seconds / envs._env.time_steps(actions, 20).mean())
        rust.append(num_envs / envs._env.time_steps(actions, steps).mean())
        gymnasium.append(benchmark_vector_step(envs, seconds, seed=1))
    envs.close()
    return max(rust), max(gymnasium)


def jax_step(task: str, num_envs: int, steps: int, within_xla: bool) -> Callable[[], float]:
    """So many steps under `scan`; seconds of one on average."""
    import jax

    import myoenv.jax

    myoenv.jax.XLA_TAKES_STEPS = within_xla
    env = myoenv.jax.JaxEnv(task, num_envs, "cpu")
    action = env.envs.action_space.sample()

    @jax.jit
    def run(state):
        return jax.lax.scan(lambda state, _: (env.step(state, action)[0], None), state, length=steps)[0]

    def seconds() -> float:
        state = jax.block_until_ready(env.reset(jax.random.key(1))[0])
        start = time.perf_counter()
        jax.block_until_ready(run(state))
        return (time.perf_counter() - start) / steps

    seconds()  # compiles
    return seconds


def jax_overheads(task: str, num_envs: int, rounds: int) -> tuple[float, float]:
    """Seconds that a step in JAX takes longer than in Rust, within XLA and by callback, in turns: medians."""
    steps = max(10, 20_000 // num_envs)
    envs = myoenv.make_vec(task, num_envs, "cpu", seed=1, autoreset="same_step")
    actions = envs.action_space.sample()
    ways = [jax_step(task, num_envs, steps, within_xla) for within_xla in (True, False)]
    times = []
    for _ in range(rounds):
        envs.reset(seed=1)
        times.append([envs._env.time_steps(actions, steps).mean(), *(seconds() for seconds in ways)])
    envs.close()
    rust, within_xla, callback = np.median(times, axis=0)
    return within_xla - rust, callback - rust


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--task", default="pointing-uitb")
    parser.add_argument("--envs", type=int, nargs="+", default=[1, 1024, 4096])
    parser.add_argument("--seconds", type=int, default=4)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--jax", action="store_true", help="measure steps in JAX, too")
    args = parser.parse_args()
    for num_envs in args.envs:
        for copy in (True, False):
            rust, python = overhead(args.task, num_envs, 20 * args.rounds, copy=copy)
            name = "copies" if copy else "views"
            cost = 1e6 * (python - rust)
            line = f"{1e6 * rust:8.1f} us in Rust, {1e6 * python:8.1f} us in Python, {cost:+.1f} us"
            print(f"{num_envs:5} environments, {name:6}: {line}")
        if args.jax:
            xla, callback = (1e6 * cost for cost in jax_overheads(args.task, num_envs, 2 * args.rounds))
            print(f"{num_envs:5} environments in JAX: {xla:+.1f} us within XLA, {callback:+.1f} us by callback")
    num_envs = max(args.envs)
    rust, gymnasium = gymnasium_rates(args.task, num_envs, args.seconds, args.rounds)
    rates = f"{gymnasium:,.0f} steps/s of {rust:,.0f} in Rust, {gymnasium / rust:.0%}"
    print(f"benchmark_vector_step, {num_envs} environments: {rates}")


if __name__ == "__main__":
    main()
