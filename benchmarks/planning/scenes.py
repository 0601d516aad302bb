"""Scenes like MotionBenchMaker's, made from seeds: what stands there, and from where to where a hand is to go.

C. Chamzas and others, MotionBenchMaker: A tool to generate and benchmark motion planning datasets, IEEE RA-L 7(2),
2022, has the idea: a table, shelves, a cage and a bin, with objects that move a little from problem to problem, and
hands that reach for something. Numbers and code are this project's.
"""

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

import manyhands as mh
from manyhands import kinematics, planning, rotations

Array = NDArray[np.float64]
Random = np.random.Generator


@dataclass(frozen=True)
class Robot:
    name: str
    file: str
    frame: str
    home: tuple[float, ...]
    fingers: tuple[float, ...]
    length: float
    """[m] by which scenes are farther away than the Panda's"""


ROBOTS = (
    Robot("panda", "panda/panda.urdf", "panda_grasptarget", (0, -0.785, 0, -2.356, 0, 1.571, 0.785), (0.03, 0.03), 0.0),
    Robot("arm6", "arm6/arm6.urdf", "arm6_grasptarget", (0, -1.571, 1.571, -1.571, -1.571, 0), (0.03, 0.03), 0.05),
)


@dataclass(frozen=True)
class Solid:
    """A box (half extents) or a cylinder (radius, half length), turned about z."""

    kind: str
    size: tuple[float, ...]
    position: tuple[float, ...]
    yaw: float = 0.0


@dataclass
class Place:
    """Where a hand may be asked to go: an origin drawn from a box, and the direction that it points in."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    direction: tuple[float, float, float]
    spread: float = 0.2
    """[rad] by which the direction is off"""


@dataclass
class Scene:
    solids: list[Solid] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)

    def box(self, half: Any, position: Any, yaw: float = 0.0) -> None:
        self.solids.append(Solid("box", tuple(map(float, half)), tuple(map(float, position)), yaw))

    def cylinder(self, radius: float, half: float, position: Any) -> None:
        self.solids.append(Solid("cylinder", (radius, half), tuple(map(float, position))))


def table(rng: Random, far: float) -> Scene:
    """Things stand on a table; the hand goes from one to another, between them."""
    scene = Scene()
    x, height = 0.55 + far, rng.uniform(0.1, 0.25)
    scene.box((0.3, 0.55, 0.02), (x, 0, height - 0.02))
    for _ in range(9):
        px, py, half = x + rng.uniform(-0.25, 0.25), rng.uniform(-0.5, 0.5), rng.uniform(0.04, 0.13)
        if rng.random() < 0.5:
            scene.cylinder(rng.uniform(0.02, 0.045), half, (px, py, height + half))
        else:
            scene.box((*rng.uniform(0.02, 0.05, 2), half), (px, py, height + half), rng.uniform(0, np.pi))
    for side in (-1, 1):
        y = sorted((side * 0.1, side * 0.5))
        scene.places.append(Place((x - 0.2, y[0], height + 0.08), (x + 0.15, y[1], height + 0.2), (0, 0, -1)))
    return scene


def _shelf(scene: Scene, rng: Random, x: float, y: float, boards: list[float], width: float, depth: float) -> None:
    """Boards at heights, two sides and a back, open towards the robot; something stands in each compartment."""
    top, bottom = boards[-1], boards[0]
    for z in boards:
        scene.box((depth, width, 0.01), (x, y, z))
    for side in (-1, 1):
        scene.box((depth, 0.01, (top - bottom) / 2 + 0.01), (x, y + side * width, (top + bottom) / 2))
    scene.box((0.01, width, (top - bottom) / 2 + 0.01), (x + depth, y, (top + bottom) / 2))
    for low, high in itertools.pairwise(boards):
        half = rng.uniform(0.05, 0.09)
        scene.cylinder(
            rng.uniform(0.025, 0.035), half, (x + 0.05, y + rng.uniform(-0.6, 0.6) * width, low + 0.01 + half)
        )
        middle = (low + high) / 2
        scene.places.append(
            Place((x - 0.05, y - 0.5 * width, middle - 0.03), (x, y + 0.5 * width, middle + 0.03), (1, 0, 0))
        )


def shelf(rng: Random, far: float) -> Scene:
    """A shelf of two compartments in front."""
    scene = Scene()
    base = rng.uniform(0.1, 0.2)
    _shelf(
        scene,
        rng,
        0.72 + far + rng.uniform(-0.03, 0.03),
        rng.uniform(-0.15, 0.15),
        [base, base + 0.33, base + 0.66],
        0.35,
        0.16,
    )
    return scene


def bookshelf(rng: Random, far: float) -> Scene:
    """Two narrow bookcases side by side, three compartments each."""
    scene = Scene()
    base = rng.uniform(0.02, 0.1)
    heights = [base, base + 0.3, base + 0.6, base + 0.9]
    for side in (-1, 1):
        _shelf(scene, rng, 0.7 + far + rng.uniform(-0.02, 0.02), side * 0.32, heights, 0.26, 0.15)
    return scene


def cage(rng: Random, far: float) -> Scene:
    """Bars around a block; the hand goes in between them, and out to the side."""
    scene = Scene()
    x, y, height = 0.55 + far + rng.uniform(-0.03, 0.03), rng.uniform(-0.1, 0.1), rng.uniform(0.12, 0.22)
    half = 0.2
    scene.box((half, half, 0.01), (x, y, height))
    block = rng.uniform(0.03, 0.05)
    scene.box((0.03, 0.03, block), (x, y, height + block), rng.uniform(0, np.pi))
    for dx in (-half, half):
        for dy in (-half, half):
            scene.box((0.012, 0.012, 0.2), (x + dx, y + dy, height + 0.2))
    for dx, dy, hx, hy in (
        (half, 0, 0.012, half),
        (-half, 0, 0.012, half),
        (0, half, half, 0.012),
        (0, -half, half, 0.012),
    ):
        scene.box((hx, hy, 0.012), (x + dx, y + dy, height + 0.4))
        if dx >= 0:
            scene.box((hx, hy, 0.012), (x + dx, y + dy, height + 0.2))
    scene.places.append(Place((x - 0.05, y - 0.05, height + 0.15), (x + 0.05, y + 0.05, height + 0.22), (0, 0, -1)))
    side = rng.choice((-1, 1))
    beside = sorted((side * 0.4, side * 0.5))
    scene.places.append(Place((x - 0.15, beside[0], height), (x + 0.05, beside[1], height + 0.2), (0, 0, -1)))
    return scene


def bin_(rng: Random, far: float) -> Scene:
    """Two open bins side by side; the hand goes from the bottom of one into the other."""
    scene = Scene()
    for side in (-1, 1):
        x, y = 0.5 + far + rng.uniform(-0.03, 0.03), side * (0.27 + rng.uniform(0, 0.03))
        floor, wall, half = rng.uniform(0.02, 0.1), rng.uniform(0.1, 0.14), (0.19, 0.2)
        scene.box((*half, 0.01), (x, y, floor))
        for dx in (-1, 1):
            scene.box((0.01, half[1], wall), (x + dx * half[0], y, floor + wall))
            scene.box((half[0], 0.01, wall), (x, y + dx * half[1], floor + wall))
        for _ in range(3):
            px, py, h = x + rng.uniform(-0.13, 0.13), y + rng.uniform(-0.13, 0.13), rng.uniform(0.02, 0.05)
            scene.box((0.025, 0.025, h), (px, py, floor + h), rng.uniform(0, np.pi))
        scene.places.append(Place((x - 0.08, y - 0.08, floor + 0.08), (x + 0.08, y + 0.08, floor + 0.2), (0, 0, -1)))
    return scene


SCENES: dict[str, Callable[[Random, float], Scene]] = {
    "table": table,
    "shelf": shelf,
    "cage": cage,
    "bin": bin_,
    "bookshelf": bookshelf,
}


@dataclass
class Problem:
    scene: str
    number: int
    robot: Robot
    solids: list[Solid]
    model: mh.Model
    q: Array
    start: Array
    goal: Array
    planner: planning.Planner


def _world(robot: Robot, solids: list[Solid]) -> mh.World:
    world = mh.World.from_file(mh.asset_path(robot.file))
    for i, solid in enumerate(solids):
        turn = (0, 0, np.sin(solid.yaw / 2), np.cos(solid.yaw / 2))
        name = f"{solid.kind} {i}"
        if solid.kind == "box":
            world.add_box(name, solid.size, position=solid.position, quaternion=turn, fixed=True)
        else:
            world.add_cylinder(name, *solid.size, position=solid.position, quaternion=turn, fixed=True)
    return world


def _hand(rng: Random, place: Place) -> tuple[Array, Array]:
    """A pose: its z axis along the place's direction, more or less, and turned about it at random."""
    z = np.asarray(place.direction, float)
    z = z + np.tan(place.spread) * rng.uniform(-1, 1, 3)
    z /= np.linalg.norm(z)
    tilt = np.array([-z[1], z[0], 0, 1 + z[2]]) if z[2] > -0.99 else np.array([1.0, 0, 0, 0])  # turns the z axis there
    spin = rng.uniform(0, 2 * np.pi)
    turn = rotations.multiply(tilt / np.linalg.norm(tilt), np.array([0, 0, np.sin(spin / 2), np.cos(spin / 2)]))
    return rng.uniform(place.low, place.high), np.asarray(turn)


def _configuration(rng: Random, planner: planning.Planner, robot: Robot, place: Place) -> Array | None:
    """One that is free, with the hand at that place."""
    position, quaternion = _hand(rng, place)
    start = planner.configuration(np.asarray(robot.home) + rng.uniform(-0.5, 0.5, len(robot.home)))
    found = kinematics.inverse(
        planner.model,
        robot.frame,
        position=position,
        quaternion=quaternion,
        start=start,
        restarts=20,
        seed=int(rng.integers(2**31)),
    )
    if not found.success:
        return None
    planned = found.q[: len(robot.home)]
    return planned if planner.is_free(planned) else None


def problems(robot: Robot, scene: str, count: int) -> Iterator[Problem]:
    """Problem i is made from the seed i alone."""
    for number in range(count):
        rng = np.random.default_rng([number, sorted(SCENES).index(scene), len(robot.home)])
        while True:
            made = SCENES[scene](rng, robot.length)
            world = _world(robot, made.solids)
            q = np.array(world.q)
            q[: len(robot.home)], q[len(robot.home) :] = robot.home, robot.fingers
            world.q = q
            planner = planning.Planner(world, robot.frame)
            if not planner.is_free(robot.home):
                continue
            ends = []
            for _ in range(60):
                place = made.places[rng.integers(len(made.places))]
                if ends and place is ends[0][0]:
                    continue
                planned = _configuration(rng, planner, robot, place)
                if planned is not None:
                    ends.append((place, planned))
                if len(ends) == 2:
                    break
            if len(ends) == 2:
                break
        yield Problem(scene, number, robot, made.solids, world.model, q, ends[0][1], ends[1][1], planner)
