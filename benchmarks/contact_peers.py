"""The scenes in contact in MuJoCo and PyBullet: the same robot file, the same places, motors as near as can be."""

import re
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from manyhands import asset_path

TIME_STEP = 0.002  # [s]
SETTLING_STEPS = 100
REPEATED_STEPS = 250  # after that many a peer begins anew: MuJoCo's cube creeps out of the hand, 8 mm in a second
CUBE_HALF = 0.02  # [m]
TABLE_HALF = (0.55, 0.35, 0.2)  # [m]
TABLE_AT = (0.3, 0.0, -0.2)  # [m]
INERTIA = 'ixx="{0}" ixy="0" ixz="0" iyy="{0}" iyz="0" izz="{0}"'
ROBOT, ROBOT_WITH_ITSELF, OUTSIDE = (1, 2), (1, 3), (2, 3)  # contype and conaffinity
HELD_UP = 0.2  # a grasped cube is higher than this [m]


@dataclass
class Scene:
    """World 0 of one of our scenes, as the C++ program describes it."""

    name: str
    q: Sequence[float]  # (9) [rad] and [m]
    target: Sequence[float]  # (9)
    max_force: Sequence[float]  # (9) [N m] and [N]
    cubes: Sequence[Sequence[float]]  # (cubes, 3) [m]
    yaw: float  # of the cubes [rad]


@dataclass
class Peer:
    """A scene of a peer at rest."""

    version: str
    restore: Callable[[], None]  # to the state at rest
    step: Callable[[int], None]  # so many substeps
    look: Callable[[], tuple[int, list[float]]]  # the number of contacts, and the heights of the cubes [m]
    clock: Callable[[], float] = time.thread_time

    def run(self, steps: int) -> None:
        """So many substeps, from the state at rest again and again."""
        for done in range(0, steps, REPEATED_STEPS):
            self.restore()
            self.step(min(REPEATED_STEPS, steps - done))

    def note(self, scene: Scene) -> str:
        """How the scene stands now."""
        contacts, heights = self.look()
        fallen = scene.name == "grasp" and heights[0] < HELD_UP
        away = max(abs(h - cube[2]) for h, cube in zip(heights, scene.cubes, strict=True))
        return f"{contacts} contacts, cube {1e3 * away:.2g} mm off in height{', dropped' if fallen else ''}"


def read_robot(mj: Any, text: str, meshes: Path) -> Any:
    """The robot of a URDF file's text as MuJoCo reads it."""
    compiler = (
        f'<mujoco><compiler meshdir="{meshes}" discardvisual="true" balanceinertia="true" strippath="false" '
        'fusestatic="true"/></mujoco>'
    )
    return mj.MjSpec.from_string(re.sub(r"<robot [^>]*>", lambda _: f'<robot name="panda">{compiler}', text, count=1))


def our_robot(mj: Any) -> Any:
    """Our file. The robot's links do not collide with each other: as in our scenes."""
    path = asset_path("panda/panda.urdf")
    spec = read_robot(mj, path.read_text(), path.parent)
    for geom in spec.geoms:
        geom.contype, geom.conaffinity = ROBOT
    return spec


def pybullet_robot(mj: Any) -> Any:
    """The file that PyBullet brings: meshes, and links that collide with each other, as by default."""
    import pybullet_data  # pyright: ignore[reportMissingImports]

    path = Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf"
    text = path.read_text().replace("package://meshes/collision/", "").replace("package://meshes/visual/", "")
    for wrong, right in (
        ('<mass value="0.0"/>', '<mass value="0.001"/>'),
        (INERTIA.format("0.1"), INERTIA.format("0.01")),
        ('<axis xyz="0 0 0"/>', '<axis xyz="0 0 1"/>'),
    ):
        text = text.replace(wrong, right)
    spec = read_robot(mj, text, path.parent / "meshes" / "collision")
    for geom in spec.geoms:
        geom.contype, geom.conaffinity = ROBOT_WITH_ITSELF
    return spec


def mujoco_peer(scene: Scene, robot: Callable[[Any], Any] = our_robot) -> Peer:
    """MuJoCo as its users run it fast: implicitfast, Newton's method, pyramidal cones, position actuators.

    Raises ImportError where it is not installed.
    """
    import mujoco  # pyright: ignore[reportMissingImports]

    mj: Any = mujoco
    spec = robot(mj)
    spec.option.timestep = TIME_STEP
    spec.option.integrator = mj.mjtIntegrator.mjINT_IMPLICITFAST
    world = spec.worldbody
    outside = dict(zip(("contype", "conaffinity"), OUTSIDE, strict=True))
    world.add_geom(type=mj.mjtGeom.mjGEOM_BOX, size=TABLE_HALF, pos=TABLE_AT, **outside)
    for place in scene.cubes:
        body = world.add_body(pos=place, euler=[0, 0, scene.yaw])
        body.add_freejoint()
        body.add_geom(type=mj.mjtGeom.mjGEOM_BOX, size=[CUBE_HALF] * 3, mass=1.0, **outside)
    for joint in [j.name for j in spec.joints if "panda" in j.name]:
        finger = "finger" in joint
        actuator = spec.add_actuator(name=f"{joint}_position", target=joint, trntype=mj.mjtTrn.mjTRN_JOINT)
        actuator.set_to_position(kp=5000 if finger else 2000, kv=50 if finger else 200)
    model = spec.compile()
    data, rest = mj.MjData(model), mj.MjData(model)
    data.qpos[:9] = scene.q
    data.ctrl[:] = scene.target
    mj.mj_step(model, data, nstep=SETTLING_STEPS)
    mj.mj_copyData(rest, model, data)

    def restore() -> None:
        mj.mj_copyData(data, model, rest)

    def look() -> tuple[int, list[float]]:
        return data.ncon, [float(data.qpos[9 + 7 * i + 2]) for i in range(len(scene.cubes))]

    return Peer(mj.__version__, restore, lambda steps: mj.mj_step(model, data, nstep=steps), look)


def pybullet_peer(scene: Scene) -> Peer:
    """PyBullet as it comes: 50 iterations, its position motors with our forces. Raises ImportError."""
    import pybullet  # pyright: ignore[reportMissingModuleSource]

    p: Any = pybullet
    client = p.connect(p.DIRECT)
    p.setTimeStep(TIME_STEP, physicsClientId=client)
    p.setGravity(0, 0, -9.81, physicsClientId=client)
    robot = p.loadURDF(str(asset_path("panda/panda.urdf")), useFixedBase=True, physicsClientId=client)
    table = p.createCollisionShape(p.GEOM_BOX, halfExtents=TABLE_HALF, physicsClientId=client)
    p.createMultiBody(0, table, basePosition=TABLE_AT, physicsClientId=client)
    cube = p.createCollisionShape(p.GEOM_BOX, halfExtents=[CUBE_HALF] * 3, physicsClientId=client)
    turned = p.getQuaternionFromEuler([0, 0, scene.yaw])
    cubes = [
        p.createMultiBody(1.0, cube, basePosition=place, baseOrientation=turned, physicsClientId=client)
        for place in scene.cubes
    ]
    for body in cubes:
        p.changeDynamics(body, -1, lateralFriction=1.0, physicsClientId=client)
    movable = (p.JOINT_REVOLUTE, p.JOINT_PRISMATIC)
    count = p.getNumJoints(robot, physicsClientId=client)
    joints = [j for j in range(count) if p.getJointInfo(robot, j, physicsClientId=client)[2] in movable]
    for joint, q in zip(joints, scene.q, strict=True):
        p.resetJointState(robot, joint, q, physicsClientId=client)
    forces, targets = list(scene.max_force), list(scene.target)
    p.setJointMotorControlArray(
        robot, joints, p.POSITION_CONTROL, targetPositions=targets, forces=forces, physicsClientId=client
    )

    def step(steps: int) -> None:
        for _ in range(steps):
            p.stepSimulation(physicsClientId=client)

    step(SETTLING_STEPS)
    rest = p.saveState(physicsClientId=client)

    def restore() -> None:
        p.restoreState(stateId=rest, physicsClientId=client)

    def look() -> tuple[int, list[float]]:
        heights = [p.getBasePositionAndOrientation(body, physicsClientId=client)[0][2] for body in cubes]
        return len(p.getContactPoints(physicsClientId=client) or ()), heights

    return Peer("3.2.7", restore, step, look)
