"""MJX, MuJoCo in JAX: all environments in one compiled control step, random excitations drawn within it."""

import time

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
from common import TOLERANCE, best_and_median, distance_from_c, rates, settings
from mujoco import mjx

s = settings()
host = mujoco.MjModel.from_xml_path(s["file"])
host.opt.tolerance = TOLERANCE
device = jax.devices()[0]


def measure(envs: int) -> None:
    """A row for so many environments."""
    start = time.perf_counter()
    model = mjx.put_model(host)
    data = jax.vmap(lambda _: mjx.make_data(model))(jnp.arange(envs))

    @jax.jit
    def control_step(data, key):
        key, drawn = jax.random.split(key)
        data = data.replace(ctrl=jax.random.uniform(drawn, (envs, host.nu)))
        physics_step = jax.vmap(lambda d: mjx.step(model, d))
        return jax.lax.fori_loop(0, s["substeps"], lambda _, d: physics_step(d), data), key

    state = [control_step(data, jax.random.key(s["seed"]))]
    jax.block_until_ready(state[0])
    ready_s = time.perf_counter() - start
    first = jax.tree.map(np.asarray, (state[0][0].ctrl[0], state[0][0].qpos[0]))
    difference = distance_from_c(host, [(first[0], s["substeps"])], first[1])

    def step() -> None:
        state[0] = control_step(*state[0])

    times = best_and_median(step, lambda: jax.block_until_ready(state[0]), s["seconds"])
    finite = float(jnp.isfinite(state[0][0].qpos).all(axis=1).mean())
    checks = {"finite": finite, "difference_rad": difference}
    where = {"version": f"{mujoco.__version__}, JAX {jax.__version__}", "device": device.device_kind}
    rates("MJX", envs, s["substeps"], times, **where, ready_s=ready_s, **checks)


for envs in s["envs"]:
    measure(envs)
