"""Records short scripts on robosuite's operational-space controller: `robosuite_tasks.py FOLDER TASK...`."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import robosuite  # pyright: ignore[reportMissingImports]
from scipy.spatial.transform import Rotation

from benchmarks.scripted.recorders.recorder import Recorder

FULL_POSITION, FULL_ROTATION = 0.05, 0.5  # [m], [rad]: what an action of 1 asks for
OPEN, CLOSED = -1.0, 1.0


def above(place: Any, height: float) -> Any:
    """The place (3) [m] so much higher."""
    return place + np.array([0, 0, height])


class Hand:
    """The Panda's, led from place to place; every step of physics is recorded."""

    def __init__(self, task: str, **options: Any) -> None:
        self.environment = robosuite.make(
            task,
            robots="Panda",
            has_renderer=False,
            has_offscreen_renderer=False,
            use_camera_obs=False,
            ignore_done=True,
            lite_physics=True,
            seed=0,
            **options,
        )
        self.environment.reset()
        self.sim = self.environment.sim
        self.robot = self.environment.robots[0]
        self.recorder = Recorder(self.sim.model._model, self.sim.data._data)
        second_half = self.sim.step2

        def step2() -> None:
            self.recorder.note()
            second_half()

        self.sim.step2 = step2
        self.turned = self.rotation()
        self.go(self.position(), OPEN, 0.5)  # things fall into place

    def position(self) -> Any:
        """Between the fingers (3) [m]."""
        return self.sim.data.site_xpos[self.robot.eef_site_id["right"]].copy()

    def rotation(self) -> Rotation:
        """Of the hand in the world."""
        return Rotation.from_matrix(self.sim.data.site_xmat[self.robot.eef_site_id["right"]].reshape(3, 3))

    def body(self, name: str) -> tuple[Any, Any]:
        """Its position (3) [m] and axes (3, 3)."""
        i = self.sim.model.body_name2id(name)
        return self.sim.data.body_xpos[i].copy(), self.sim.data.body_xmat[i].reshape(3, 3).copy()

    def fingers_across(self, direction: Any) -> None:
        """From now on they close along this horizontal direction (3), either way round."""
        pads = [
            self.sim.data.geom_xpos[self.sim.model.geom_name2id(f"gripper0_right_finger{k}_pad_collision")]
            for k in (1, 2)
        ]
        closing = pads[1] - pads[0]
        angle = np.arctan2(direction[1], direction[0]) - np.arctan2(closing[1], closing[0])
        self.turn((angle + np.pi / 2) % np.pi - np.pi / 2, self.rotation())

    def turn(self, angle: float, start: Rotation) -> None:
        """From now on it stands turned by that angle [rad] about the vertical from `start`."""
        self.turned = Rotation.from_rotvec([0, 0, angle]) * start

    def go(self, target: Any, fingers: float, seconds: float) -> None:
        """Moves towards a place (3) [m] for so long."""
        for _ in range(round(seconds * self.environment.control_freq)):
            away = (self.turned * self.rotation().inv()).as_rotvec()
            move = np.concatenate([(target - self.position()) / FULL_POSITION, away / FULL_ROTATION])
            self.environment.step(np.append(np.clip(move, -1, 1), fingers))

    def grasp(self, place: Any) -> None:
        """From above."""
        self.go(above(place, 0.1), OPEN, 2.0)
        self.go(place, OPEN, 1.5)
        self.go(place, CLOSED, 0.7)


def lift() -> Hand:
    """A cube, by 15 cm."""
    hand = Hand("Lift")
    place, axes = hand.body("cube_main")
    hand.fingers_across(axes[:, 0])
    hand.grasp(place)
    hand.go(above(place, 0.15), CLOSED, 1.5)
    return hand


def stack() -> Hand:
    """A cube onto another."""
    hand = Hand("Stack")
    place, axes = hand.body("cubeA_main")
    hand.fingers_across(axes[:, 0])
    hand.grasp(place)
    goal, _ = hand.body("cubeB_main")
    hand.go(above(place, 0.12), CLOSED, 1.0)
    hand.go(above(goal, 0.12), CLOSED, 2.0)
    hand.go(above(goal, 0.047), CLOSED, 1.5)
    hand.go(above(goal, 0.047), OPEN, 0.5)
    hand.go(above(goal, 0.15), OPEN, 1.0)
    return hand


def nut() -> Hand:
    """A square nut onto its peg, carried by its handle."""
    hand = Hand("NutAssemblySquare")
    centre, axes = hand.body("SquareNut_main")
    peg, _ = hand.body("peg1")
    handle = centre + 0.06 * axes[:, 0]
    hand.fingers_across(axes[:, 1])
    hand.grasp(handle)
    hand.go(above(handle, 0.16), CLOSED, 1.5)
    angle = np.arctan2(axes[1, 0], axes[0, 0])
    hand.turn(round(angle / (np.pi / 2)) * np.pi / 2 - angle, hand.rotation())
    for height, seconds in ((0.14, 1.5), (0.14, 1.5), (0.06, 1.0), (0.06, 1.0)):
        now, _ = hand.body("SquareNut_main")  # it may have turned in the fingers
        beside = (hand.position() - now) * [1, 1, 0]
        hand.go(above(peg, height) + beside, CLOSED, seconds)
    hand.go(hand.position(), OPEN, 1.0)
    return hand


def door() -> Hand:
    """Opened by its handle, which turns with it."""
    hand = Hand("Door", use_latch=False)
    model = hand.sim.model
    place = hand.sim.data.site_xpos[model.site_name2id("Door_handle")].copy()
    hinge = hand.sim.data.xanchor[model.joint_name2id("Door_hinge")].copy()
    _, axes = hand.body("Door_door")
    hand.fingers_across(axes[:, 1])
    hand.grasp(place)
    start = hand.rotation()
    for angle in np.linspace(0, 0.4, 21)[1:]:
        hand.turn(angle, start)
        hand.go(hinge + Rotation.from_rotvec([0, 0, angle]).apply(place - hinge), CLOSED, 0.15)
    return hand


SCRIPTS: dict[str, Callable[[], Hand]] = {"door": door, "lift": lift, "nut": nut, "stack": stack}


def record(task: str, folder: Path) -> None:
    """One script, from the reset to its end."""
    hand = SCRIPTS[task]()
    print(task, "succeeds" if hand.environment._check_success() else "fails")
    hand.recorder.write(folder / task, Path())


if __name__ == "__main__":
    for name in sys.argv[2:]:
        record(name, Path(sys.argv[1]))
