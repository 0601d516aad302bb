"""Files that become bodies, with every option of the loaders, and what is told of bodies and joints."""

import re

import numpy as np
import pytest

from benchmarks.bullet.beside import DATA, Beside

FILES = [
    "kuka_iiwa/model.urdf",
    "franka_panda/panda.urdf",
    "r2d2.urdf",
    "cube_small.urdf",
    "sphere2.urdf",
    "table/table.urdf",
    "tray/tray.urdf",
    "cartpole.urdf",
    "quadruped/minitaur.urdf",
    "laikago/laikago.urdf",
    "racecar/racecar.urdf",
    "duck_vhacd.urdf",
]
FLAGS = [
    "URDF_USE_INERTIA_FROM_FILE",
    "URDF_USE_SELF_COLLISION",
    "URDF_USE_SELF_COLLISION_EXCLUDE_PARENT",
    "URDF_USE_SELF_COLLISION_EXCLUDE_ALL_PARENTS",
    "URDF_USE_SELF_COLLISION_INCLUDE_PARENT",
    "URDF_USE_IMPLICIT_CYLINDER",
    "URDF_GLOBAL_VELOCITIES_MB",
    "URDF_ENABLE_CACHED_GRAPHICS_SHAPES",
    "URDF_ENABLE_SLEEPING",
    "URDF_INITIALIZE_SAT_FEATURES",
    "URDF_MAINTAIN_LINK_ORDER",
    "URDF_ENABLE_WAKEUP",
    "URDF_MERGE_FIXED_LINKS",
    "URDF_IGNORE_VISUAL_SHAPES",
    "URDF_IGNORE_COLLISION_SHAPES",
    "URDF_USE_MATERIAL_COLORS_FROM_MTL",
    "URDF_USE_MATERIAL_TRANSPARANCY_FROM_MTL",
]


def place(rng: np.random.Generator) -> tuple[list[float], list[float]]:
    r = rng.normal(size=4)
    return rng.uniform(-1, 1, 3).tolist(), (r / np.linalg.norm(r)).tolist()


def tell(both: Beside, body: int) -> None:
    """All that is told of a body as it was loaded."""
    both.getBodyInfo(body)
    both.computeDofCount(body)
    both.getBasePositionAndOrientation(body, within=1e-5)
    both.getBaseVelocity(body)
    for joint in range(both.getNumJoints(body)):
        both.getJointInfo(body, joint, within=1e-5)
        both.getJointState(body, joint)
        both.getLinkState(body, joint, computeLinkVelocity=1, within=1e-5)
    for link in range(-1, both.getNumJoints(body)):
        both.getDynamicsInfo(body, link, within=5e-4)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("file", FILES)
def test_a_urdf(both: Beside, rng: np.random.Generator, file: str) -> None:
    tell(both, both.loadURDF(file, *place(rng), useFixedBase=bool(rng.integers(2))))


@pytest.mark.parametrize("flag", FLAGS)
@pytest.mark.parametrize("file", ["kuka_iiwa/model.urdf", "r2d2.urdf", "laikago/laikago.urdf"])
def test_a_flag(both: Beside, file: str, flag: str) -> None:
    both.loadURDF(file, flags=getattr(both, flag))
    if (file, flag) == ("r2d2.urdf", "URDF_MERGE_FIXED_LINKS"):  # Bullet misplaces the centres of mass
        for joint in range(both.getNumJoints(0)):
            both.getJointInfo(0, joint, view=lambda info: (*info[:14], info[16]))
        return
    tell(both, 0)
    for link in range(-1, both.getNumJoints(0)):
        both.getCollisionShapeData(0, link, view=len)
    both.getVisualShapeData(0, view=len)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    "file", ["kuka_iiwa/model.urdf", "franka_panda/panda.urdf", "cube_small.urdf", "quadruped/minitaur.urdf"]
)
def test_scaling(both: Beside, rng: np.random.Generator, file: str) -> None:
    tell(both, both.loadURDF(file, *place(rng), globalScaling=rng.uniform(0.3, 3)))


def test_articulated_bodies_are_the_rule(both: Beside) -> None:
    both.loadURDF("cube_small.urdf", useMaximalCoordinates=0)
    both.loadURDF("cube_small.urdf", useMaximalCoordinates=-1)
    for body in range(2):
        tell(both, body)


def test_old_forms_of_loading(both: Beside) -> None:
    both.loadURDF("cube_small.urdf", 0.1, 0.2, 0.3)
    both.getBasePositionAndOrientation(0)
    both.loadURDF("cube_small.urdf", 0.1, 0.2, 0.3, 0, 0, 0.6, 0.8)
    both.getBasePositionAndOrientation(1)


@pytest.mark.parametrize("file", ["kiva_shelf/model.sdf", "kuka_iiwa/kuka_with_gripper.sdf", "kuka_iiwa/model.sdf"])
def test_an_sdf(both: Beside, file: str) -> None:
    for body in both.loadSDF(sdfFileName=file, useMaximalCoordinates=0, globalScaling=1):
        tell(both, body)


def without_counts(info: tuple[object, ...]) -> tuple[object, ...]:
    """A joint's names, but for the count of fixed joints, which goes on through all files; not its frames."""
    return re.sub(rb"_\d+_", b"_", info[1]), *info[2:13], info[16]


@pytest.mark.parametrize("flags", [0, 8, 8 | 32])
@pytest.mark.parametrize("file", ["ant", "half_cheetah", "humanoid_symmetric_no_ground", "hopper", "reacher", "ground"])
def test_an_mjcf(both: Beside, file: str, flags: int) -> None:
    for body in both.loadMJCF(mjcfFileName=f"mjcf/{file}.xml", flags=flags):
        both.getBodyInfo(body)
        both.computeDofCount(body)
        for joint in range(both.getNumJoints(body)):
            both.getJointInfo(body, joint, view=without_counts, within=1e-5)
            both.getDynamicsInfo(body, joint, view=lambda info: info[0], within=1e-5)


@pytest.mark.parametrize("seed", range(5))
def test_bodies_come_and_go(both: Beside, rng: np.random.Generator) -> None:
    alive: list[int] = []
    for _ in range(30):
        if alive and rng.uniform() < 0.4:
            both.removeBody(alive.pop(int(rng.integers(len(alive)))))
        else:
            alive.append(both.loadURDF(["cube_small.urdf", "sphere_small.urdf"][rng.integers(2)], place(rng)[0]))
        both.getNumBodies()
        for i in range(len(alive) + 1):
            both.getBodyUniqueId(serialIndex=i)
    both.syncBodyInfo()
    both.resetSimulation()
    both.getNumBodies()
    both.loadURDF("cube_small.urdf")


def test_the_search_path(both: Beside) -> None:
    both.setAdditionalSearchPath(path="/nowhere")
    both.refuses("loadURDF", "cube_small.urdf")
    both.setAdditionalSearchPath(path=DATA)
    both.loadURDF("cube_small.urdf")


@pytest.mark.parametrize("name", ["loadURDF", "loadSDF", "loadMJCF"])
@pytest.mark.parametrize("argument", ["missing.file", 3, None, b"cube_small.urdf"])
def test_no_such_file(both: Beside, name: str, argument: object) -> None:
    both.loadURDF("cube_small.urdf")
    both.refuses(name, argument)


@pytest.mark.parametrize(
    "options",
    [
        {"basePosition": [0, 0]},
        {"basePosition": None},
        {"baseOrientation": [0, 0, 0]},
        {"useFixedBase": 1.5},
        {"flags": "x"},
        {"nonsense": 1},
        {"physicsClientId": 77},
    ],
)
def test_wrong_options(both: Beside, options: dict[str, object]) -> None:
    both.loadURDF("cube_small.urdf")
    both.refuses("loadURDF", "cube_small.urdf", **options)


@pytest.mark.parametrize("call", [("getBodyInfo", 9), ("getJointInfo", 9, 0), ("getJointInfo", 0, 99)])
def test_no_such_body(both: Beside, call: tuple[str, int]) -> None:
    both.loadURDF("kuka_iiwa/model.urdf")
    both.refuses(*call)
    both.getNumJoints(9)
    both.getBodyUniqueId(9)
    both.computeDofCount(9)
