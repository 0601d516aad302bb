"""The tasks, and by what number each is judged."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.mujoco_map import Array, MjData, MjModel, mujoco

Measure = Callable[[MjModel, MjData], float]


@dataclass(frozen=True)
class Task:
    """One script. `measure`: of a state; the outcome is by how much it has changed from the start."""

    package: str
    name: str
    outcome: str
    unit: str
    measure: Measure
    target: tuple[float, float, float]  # [m] what pictures show, from
    distance: float  # [m]
    yaw: float  # [degrees], as of `mh.Camera.orbit`
    pitch: float = -25.0

    @property
    def title(self) -> str:
        """For tables."""
        return f"{self.package}: {self.name}"


def joint(name: str) -> Measure:
    """The position of the joint of that name [rad or m]."""
    return lambda model, data: float(data.joint(name).qpos[0])


def joint_of(body: str) -> Measure:
    """The same of a joint without a name, by its body."""
    return lambda model, data: float(data.qpos[model.jnt_qposadr[model.body(body).jntadr[0]]])


def height(body: str) -> Measure:
    """Of the body's origin [m]."""
    return lambda model, data: float(data.body(body).xpos[2])


def along(body: str, direction: tuple[float, float, float]) -> Measure:
    """How far the body's origin lies in a direction [m]."""
    return lambda model, data: float(data.body(body).xpos @ np.array(direction))


TASKS = (
    Task("robosuite", "lift", "height of the cube", "m", height("cube_main"), (-0.05, 0, 0.95), 0.9, 60),
    Task("robosuite", "stack", "height of the upper cube", "m", height("cubeA_main"), (-0.05, 0, 0.95), 0.9, 60),
    Task("robosuite", "nut", "nut to its peg", "m", along("SquareNut_main", (1, 0, 0)), (0, 0.05, 0.95), 1.1, 50),
    Task("robosuite", "door", "angle of the door", "rad", joint("Door_hinge"), (-0.2, -0.25, 1.05), 1.3, -40),
    Task("metaworld", "assembly", "nut to its peg", "m", along("RoundNut", (0, 1, 0)), (0.1, 0.65, 0.15), 1, 150),
    Task("metaworld", "button-press", "depth of the button", "m", joint("btnbox_joint"), (0, 0.65, 0.15), 1.1, 130),
    Task("metaworld", "door-open", "angle of the door", "rad", joint("doorjoint"), (0.1, 0.75, 0.2), 1.3, 210),
    Task("metaworld", "drawer-open", "way of the drawer", "m", joint("goal_slidey"), (0, 0.7, 0.15), 1.1, 130),
    Task("metaworld", "handle-press", "way of the handle", "m", joint_of("handle_link"), (0, 0.7, 0.15), 1.1, 130),
    Task("metaworld", "lever-pull", "angle of the lever", "rad", joint("LeverAxis"), (0.05, 0.65, 0.2), 1.2, 130),
    Task("metaworld", "peg-insert-side", "depth of the peg", "m", along("peg", (-1, 0, 0)), (-0.1, 0.6, 0.12), 1, 150),
    Task("metaworld", "pick-place", "height of the puck", "m", height("obj"), (0, 0.7, 0.15), 1, 150),
    Task("metaworld", "window-open", "way of the window", "m", joint("window_slide"), (0, 0.7, 0.2), 1.1, 150),
)


def outcomes(task: Task, model: MjModel, qpos: Array) -> Array:
    """By how much it has changed since the first of the states (n, nq): (n)."""
    data = mujoco.MjData(model)
    found = []
    for state in qpos:
        data.qpos = state
        mujoco.mj_kinematics(model, data)
        found.append(task.measure(model, data))
    return np.array(found) - found[0]
