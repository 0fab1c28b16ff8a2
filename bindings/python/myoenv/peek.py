"""What a viewer sees of environments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Peek:
    """`n` environments at one moment; made by `MyoVectorEnv.peek`. Arrays are copies.

    Positions are metres from the shoulder centre, in world axes: x forward, y to the left, z up. Columns of a rotation
    are the own axes in the world's.

    Attributes:
        joint_names: Names of the independent joints, `ndof`.
        muscle_names: Names of the muscles, `nmuscle`.
        body_names: Names of the bodies, `nbody`, the world first.
        object_names: Names of what stands there, `nobject`.
        object_kinds: `"sphere"`, `"button"`, `"slider"`, `"stick"` or
            `"obstacle"` for each of them.
        qpos: Positions of the independent joints (rad or m), `(n, ndof)`.
        qvel: Their rates (1/s), `(n, ndof)`.
        act: Muscle activations in [0, 1], `(n, nmuscle)`.
        fingertip: Position of the fingertip (m), `(n, 3)`.
        pointer: Position of what points (m), `(n, 3)`: the fingertip, or what the technique makes of the posture.
        body_positions: Origins of the bodies (m), `(n, nbody, 3)`.
        body_rotations: Their axes, `(n, nbody, 3, 3)`.
        muscle_paths: Of each muscle the points that its path runs through, in straight lines (m), `(n, points, 3)`;
            seven of them for an arc.
        object_positions: Centres of the objects in this episode (m), `(n, nobject, 3)`.
        object_rotations: Their axes, `(n, nobject, 3, 3)`; those of a box are x up its upright face, y across it to the
            left, z out of it.
        object_half_sizes: Half their sizes along their own axes (m), `(n, nobject, 3)`; three times the radius of a
            sphere or a knob.
        object_done: Whether steps of the task asked for the object, and all of them are done, `(n, nobject)`.
        object_values: Where the handles of sliders stand, in the values of the slider, and the angles of sticks
            (degrees), `(n, nobject)`; NaN for what is neither, and for sliders that are not dragged.
        current_object: Index of the object that the current step asks for, `(n,)`; -1 once all steps are done, and
            before one of several lights up.
        steps_done: How many steps of the task are done, `(n,)`.
        touch: Greatest force on the current button in the last control step (N), `(n,)`; 0 for a sphere.
        time: Seconds since the episode began, `(n,)`.
        episode: Number of the episode, counted from the last seed, `(n,)`.
        ended: Whether the episode is over and no other one has begun, `(n,)`.
    """

    joint_names: list[str]
    muscle_names: list[str]
    body_names: list[str]
    object_names: list[str]
    object_kinds: list[str]
    qpos: NDArray[np.float64]
    qvel: NDArray[np.float64]
    act: NDArray[np.float64]
    fingertip: NDArray[np.float64]
    pointer: NDArray[np.float64]
    body_positions: NDArray[np.float64]
    body_rotations: NDArray[np.float64]
    muscle_paths: list[NDArray[np.float64]]
    object_positions: NDArray[np.float64]
    object_rotations: NDArray[np.float64]
    object_half_sizes: NDArray[np.float64]
    object_done: NDArray[np.bool_]
    object_values: NDArray[np.float64]
    current_object: NDArray[np.int64]
    steps_done: NDArray[np.int64]
    touch: NDArray[np.float64]
    time: NDArray[np.float64]
    episode: NDArray[np.int64]
    ended: NDArray[np.bool_]
