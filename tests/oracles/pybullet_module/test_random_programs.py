"""Programs of random calls: bodies come, go, move, are pushed and asked about, in any order; wrong calls among them."""

from collections.abc import Callable

import numpy as np
import pytest
from bodies import place, random_chain

from benchmarks.bullet.beside import Beside

FILES = [
    "kuka_iiwa/model.urdf",
    "cube_small.urdf",
    "cartpole.urdf",
    "table/table.urdf",
    "sphere2.urdf",
    "lego/lego.urdf",
]
LENGTH = 60


class Program:
    """Both worlds, and the bodies in them."""

    def __init__(self, both: Beside, rng: np.random.Generator) -> None:
        self.both, self.rng = both, rng
        self.bodies: list[int] = []
        self.states: list[tuple[int, list[int]]] = []

    def body(self) -> int:
        """One of the bodies, or now and then one that is not there."""
        missing = not self.bodies or self.rng.uniform() < 0.05
        return 99 if missing else self.bodies[int(self.rng.integers(len(self.bodies)))]

    def link(self, body: int) -> int:
        joints = self.both.getNumJoints(body)
        return int(self.rng.integers(-1, joints)) if joints else -1

    def load(self) -> None:
        file = FILES[int(self.rng.integers(len(FILES)))]
        options = {"useFixedBase": bool(self.rng.integers(2)), "globalScaling": self.rng.uniform(0.5, 2)}
        self.bodies.append(self.both.loadURDF(file, *place(self.rng, 5), **options))

    def make(self) -> None:
        self.bodies.append(random_chain(self.both, self.rng, int(self.rng.integers(1, 4))))

    def remove(self) -> None:
        if len(self.bodies) > 2:
            self.both.removeBody(self.bodies.pop(int(self.rng.integers(len(self.bodies)))))
            self.states.clear()
        self.both.getNumBodies()

    def put(self) -> None:
        body = self.body()
        self.both.resetBasePositionAndOrientation(body, *place(self.rng, 5))
        if body != 99 and self.both.getDynamicsInfo(body, -1, within=1e-3)[0] > 0:  # Bullet's fixed bases drift
            self.both.resetBaseVelocity(body, self.rng.normal(size=3).tolist(), self.rng.normal(size=3).tolist())
        self.look()

    def bend(self) -> None:
        body = self.body()
        for joint in range(self.both.getNumJoints(body)):
            if self.both.getJointInfo(body, joint, within=1e-5)[2] in (0, 1):
                self.both.resetJointState(body, joint, self.rng.uniform(-0.5, 0.5), self.rng.normal())
        self.look()

    def look(self) -> None:
        for body in self.bodies:
            links = range(self.both.getNumJoints(body))
            self.both.getBasePositionAndOrientation(body, within=1e-5)
            self.both.getBaseVelocity(body, within=1e-5)
            self.both.getLinkStates(body, links, computeLinkVelocity=1, computeForwardKinematics=1, within=1e-4)
            self.both.getJointStates(body, links, view=lambda states: states and [s[:2] for s in states], within=1e-5)

    def change(self) -> None:
        body = self.body()
        link = self.link(body)
        numbers = {"lateralFriction": self.rng.uniform(0, 1), "restitution": self.rng.uniform(0, 1)}
        if link >= 0:
            numbers["mass"] = self.rng.uniform(0.1, 3)
        self.both.changeDynamics(body, link, **numbers)
        if body != 99:
            self.both.getDynamicsInfo(body, link, within=1e-3)

    def paint(self) -> None:
        body = self.body()
        self.both.changeVisualShape(body, self.link(body), rgbaColor=self.rng.uniform(size=4).tolist())
        self.both.getVisualShapeData(body, within=1e-5)

    def count(self) -> None:
        for i in range(self.both.getNumBodies() + 1):
            self.both.getBodyUniqueId(i)

    def describe(self) -> None:
        if self.bodies:
            self.both.getBodyInfo(self.bodies[-1])
            self.both.computeDofCount(self.bodies[-1])

    def keep(self) -> None:
        self.states.append((self.both.saveState(), list(self.bodies)))

    def go_back(self) -> None:
        if self.states and self.states[-1][1] == self.bodies:
            self.both.restoreState(self.states[-1][0])
        self.look()

    def err(self) -> None:
        wrong = [
            ("getJointInfo", 99, 0),
            ("resetJointState", 99, 0, 0.0),
            ("setJointMotorControl2", 99, 0, 2),
            ("loadURDF", "missing.urdf"),
            ("getBaseVelocity", 99),
            ("resetBasePositionAndOrientation", 0, [0], [0, 0, 0, 1]),
            ("createConstraint", 99, -1, -1, -1, 4, [0, 0, 0], [0, 0, 0], [0, 0, 0]),
            ("setGravity", [0, 0, 1]),
        ]
        self.both.refuses(*wrong[int(self.rng.integers(len(wrong)))])


@pytest.mark.parametrize("seed", range(12))
def test_a_random_program(both: Beside, rng: np.random.Generator) -> None:
    program = Program(both, rng)
    moves: list[Callable[[], None]] = [
        program.load,
        program.make,
        program.remove,
        program.put,
        program.bend,
        program.change,
        program.paint,
        program.count,
        program.describe,
        program.keep,
        program.go_back,
        program.err,
    ]
    program.load()
    for _ in range(LENGTH):
        moves[int(rng.integers(len(moves)))]()
    program.look()
