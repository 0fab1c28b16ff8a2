"""What a user does, physics step by physics step."""

from __future__ import annotations

from os import PathLike

import numpy as np
from numpy.typing import NDArray

from myoenv import _native
from myoenv.arguments import as_count, as_path, as_seed
from myoenv.policy import Policy
from myoenv.runs import read_run


def trajectories(
    run: str | PathLike[str],
    episodes: int = 20,
    *,
    checkpoint: int | str | PathLike[str] | None = None,
    seed: int | None = None,
) -> dict[str, NDArray[np.uint32] | NDArray[np.float64] | NDArray[np.object_]]:
    """What the user of a run does in fresh episodes, every 2 ms: one array per quantity, one entry per physics step.

    `pandas.DataFrame(trajectories("runs/pointing-1"))` is a table, of which pandas and polars make Parquet;
    `myo export` writes the same as CSV. Places are in m from the centre of the shoulder: x forward, y to the left,
    z up. Columns: `episode`, from 1; `layout`, where there are several; `time_s`, since the start of the episode;
    `step` of the script, from 1, 0 once all are done; `object` that it asks for, `object_x_m`, `object_y_m`,
    `object_z_m` and `object_width_m`; `fingertip_x_m` and so on; `pointer_x_m` and so on, where something else points;
    `force_n` on the fingertip; `event`: `entered`, `done`, `given_up`, `success`, `time_out` or nothing; of each
    joint `elbow_flexion_rad` and `elbow_flexion_rad_s`; of each muscle `DELT1_activation` and `DELT1_force_n`; of the
    muscles together their torque on each joint (`elbow_flexion_torque_nm`), the power with which they pull
    (`mechanical_w`) and what they consume (`metabolic_w`; Bhargava et al. 2004). What there is not is NaN, 0 or an
    empty text.

    Args:
        run: A run folder.
        episodes: How many, of each layout. A second of one takes 0.4 MB.
        checkpoint: Another checkpoint of the run than the newest: the control steps after which it was written, or the
            path of its file.
        seed: Seed of the episodes; by default that of `evaluate`.
    """
    policy, trained_with = Policy.load(run, checkpoint=checkpoint), read_run(run).seed
    seed = _native.evaluation_seed(trained_with, 0) if seed is None else as_seed(seed)
    native = _native.trajectories(as_path("run", run), policy._native, as_count("episodes", episodes), seed)
    return {name: np.array(column, object) if isinstance(column, list) else column for name, column in native.items()}
