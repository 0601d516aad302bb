"""What gives way by solref and solimp does so as in MuJoCo: accelerations, motion, and where it comes to rest."""

from dataclasses import dataclass

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

import manyhands as mh  # noqa: E402
from benchmarks.mujoco_map import Array, Scene  # noqa: E402

SHORT = 1e-8  # [s]: what one step adds to v is MuJoCo's acceleration but for h damping, 1e-6 of it
G = 9.81


def scene_of(body: str, rest: str = "", option: str = "") -> Scene:
    return Scene.of_string(
        f'<mujoco><compiler angle="radian"/><option solver="Newton" tolerance="0" iterations="200" {option}/>'
        f"<worldbody>{body}</worldbody>{rest}</mujoco>"
    )


def accelerations(scene: Scene, qpos: Array, qvel: Array) -> tuple[Array, Array]:
    """MuJoCo's and ours, in our coordinates (nv)."""
    data = scene.data
    data.qpos, data.qvel = qpos, qvel
    mujoco.mj_forward(scene.mujoco, data)
    world = mh.World(scene.ours, SHORT)
    world.q = scene.configuration(qpos)
    v = scene.velocity_map(qpos) @ qvel
    world.v = v
    world.step()
    return scene.velocity_map(qpos) @ data.qacc, (np.asarray(world.v) - v) / SHORT


def assert_alike(theirs: Array, ours: Array, what: str) -> None:
    assert np.max(np.abs(theirs - ours)) <= 1e-5 * (1 + np.max(np.abs(theirs))), f"{what}: {theirs} {ours}"


def limb(joint: str, inner: str = "", name: str = "", place: str = "0 0 -0.3") -> str:
    named = f'name="{name}"' if name else ""
    return (
        f'<body {named} pos="{place}">{joint}<geom type="capsule" fromto="0 0 0 0.05 0 -0.3" size="0.02" mass="1.3" '
        f'contype="0" conaffinity="0"/>{inner}</body>'
    )


def arm(attributes: str, count: int = 4) -> str:
    """Hinges in turn about y and x."""
    text = ""
    for k in reversed(range(count)):
        axis = ("0 1 0", "1 0 0.2")[k % 2]
        text = limb(f'<joint name="j{k}" axis="{axis}" armature="0.01" {attributes}/>', text, f"b{k}")
    return text


SOFT = [
    ("0.05 1", "0.9 0.95 0.001 0.5 2"),
    ("0.02 1", "0.3 0.8 0.4 0.3 3"),
    ("-300 -7", "0.5 0.9 0.1 0.5 1"),
    ("0.1 0.3", "0.0 0.5 0.2 0.6 2.5"),
]


@pytest.mark.parametrize(("solref", "solimp"), SOFT)
def test_soft_limits_of_joints_accelerate_as_mujocos(solref: str, solimp: str) -> None:
    scene = scene_of(arm(f'range="-0.3 0.4" solreflimit="{solref}" solimplimit="{solimp}" frictionloss="0"'))
    rng = np.random.default_rng(1)
    acting = 0
    for _ in range(50):
        theirs, ours = accelerations(scene, rng.uniform(-0.7, 0.7, 4), rng.uniform(-2, 2, 4))
        assert_alike(theirs, ours, "limits")
        acting += scene.data.nefc
    assert acting > 50


@pytest.mark.parametrize(("solref", "solimp"), SOFT)
def test_soft_limits_of_tendons_and_equations_between_them_accelerate_as_mujocos(solref: str, solimp: str) -> None:
    tendons = f"""<tendon><fixed name="a" range="-0.2 0.3" solreflimit="{solref}" solimplimit="{solimp}">
        <joint joint="j0" coef="1"/><joint joint="j1" coef="-0.7"/></fixed>
      <spatial name="b"><site site="fixed"/><site site="tip"/></spatial>
      <fixed name="c"><joint joint="j2" coef="0.5"/></fixed></tendon>
      <equality><tendon tendon1="c" tendon2="b" polycoef="0.1 0.6 0.2 0 0" solref="{solref}" solimp="{solimp}"/>
      </equality>"""
    body = arm("").replace('<body name="b3"', '<site name="tip" pos="0.1 0 -0.1"/><body name="b3"')
    scene = scene_of('<site name="fixed" pos="0.4 0.1 0"/>' + body, tendons)
    rng = np.random.default_rng(2)
    for _ in range(50):
        theirs, ours = accelerations(scene, rng.uniform(-0.7, 0.7, 4), rng.uniform(-2, 2, 4))
        assert_alike(theirs, ours, "tendons")


@pytest.mark.parametrize(("solref", "solimp"), SOFT)
def test_soft_equations_between_joints_accelerate_as_mujocos(solref: str, solimp: str) -> None:
    rows = f"""<equality><joint joint1="j2" joint2="j0" polycoef="0.1 -1.5 0 0 0" solref="{solref}" solimp="{solimp}"/>
      <joint joint1="j3" joint2="k0" polycoef="0 0.5 0 0 0" solref="{solref}" solimp="{solimp}"/></equality>"""
    other = limb('<joint name="k0" axis="0 1 0"/>', place="1 0 0")
    scene = scene_of(arm("") + other, rows)
    rng = np.random.default_rng(3)
    for _ in range(50):
        theirs, ours = accelerations(scene, rng.uniform(-0.7, 0.7, 5), rng.uniform(-2, 2, 5))
        assert_alike(theirs, ours, "joints")


@pytest.mark.parametrize(("solref", "solimp"), SOFT)
@pytest.mark.parametrize("kind", ["connect", "weld"])
def test_soft_equations_between_bodies_accelerate_as_mujocos(kind: str, solref: str, solimp: str) -> None:
    """An arm's hand held to the world, and a free body to the arm."""
    anchor = 'anchor="0.1 0 0.05"' if kind == "connect" else 'anchor="0.1 0 0.05" torquescale="0.7"'
    soft = f'solref="{solref}" solimp="{solimp}"'
    rows = f"""<equality><{kind} body1="b3" {anchor} {soft}/><{kind} body1="free" body2="b1" {anchor} {soft}/>
      </equality>"""
    free = '<body name="free" pos="0.2 0 -0.5"><freejoint/><geom type="box" size="0.1 0.07 0.04" mass="2" '
    scene = scene_of(arm("") + free + 'contype="0" conaffinity="0"/></body>', rows)
    rng = np.random.default_rng(4)
    for _ in range(50):
        qpos = scene.mujoco.qpos0 + rng.uniform(-0.2, 0.2, 11)
        qpos[7:] /= np.linalg.norm(qpos[7:])
        theirs, ours = accelerations(scene, qpos, rng.uniform(-1, 1, 10))
        assert_alike(theirs, ours, kind)


@dataclass
class Motion:
    theirs: Array
    ours: Array


def motion(scene: Scene, steps: int, h: float, v: float = 0.0) -> Motion:
    """q (steps, nq) of both from the start, all joints at velocity v."""
    model, data = scene.mujoco, scene.data
    model.opt.timestep = h
    world = mh.World(scene.ours, h)
    data.qvel[:] = v
    world.v = np.full(model.nv, v)
    found = Motion(np.zeros((steps, model.nq)), np.zeros((steps, model.nq)))
    for k in range(steps):
        mujoco.mj_step(model, data)
        world.step()
        found.theirs[k], found.ours[k] = scene.configuration(data.qpos), world.q
    return found


def test_a_weight_rests_beyond_a_soft_limit_where_mujocos_does() -> None:
    """A slide pressed by its weight: by the law 2 s later, and on the way as MuJoCo's within 1 % of how far it gives
    way, at a step of 0.1 ms."""
    joint = '<joint type="slide" axis="0 0 1" range="-0.01 1" solreflimit="0.1 0.5" solimplimit="0.4 0.8 0.05 0.5 2"/>'
    scene = scene_of(f'<body>{joint}<geom size="0.1" mass="2"/></body>')
    found = motion(scene, 20000, 1e-4)
    way = np.max(np.abs(found.theirs))
    assert np.max(np.abs(found.ours[:5000] - found.theirs[:5000])) < 0.01 * way
    depth = -0.01 - found.ours[-1, 0]
    d = np.interp(depth, [0, 0.05], [0, 1])
    growth = 2 * d**2 if d < 0.5 else 1 - 2 * (1 - d) ** 2
    impedance = 0.4 + 0.4 * growth
    stiffness = 1 / (0.8 * 0.1 * 0.5) ** 2 * impedance
    assert depth == pytest.approx((1 - impedance) / impedance * G / stiffness, rel=1e-3)


def test_a_soft_limit_gives_way_with_friction_and_a_servo_at_its_joint() -> None:
    """The laws of a joint stand beside its soft limit."""
    joint = """<joint name="j" axis="0 1 0" range="-0.1 0.1" solreflimit="0.1 1" solimplimit="0.4 0.8 0.05"
      frictionloss="0.02" damping="0.05"/>"""
    scene = scene_of(
        limb(joint), '<actuator><position joint="j" kp="20" kv="1" ctrlrange="-2 2"/></actuator>', 'gravity="0 0 0"'
    )
    model, data = scene.mujoco, scene.data
    model.opt.timestep = 1e-4
    world = mh.World(scene.ours, 1e-4)
    data.ctrl[:] = world.ctrl = [1.0]
    for _ in range(20000):
        mujoco.mj_step(model, data)
        world.step()
    assert data.qpos[0] > 0.15
    assert world.q[0] == pytest.approx(data.qpos[0], abs=2e-3)  # friction holds it anywhere within 1e-3


def test_a_hand_sags_in_a_soft_weld_to_a_mocap_body_as_mujocos() -> None:
    """An arm held by its hand: the way on which it settles, and how far it sags in the end."""
    body = arm('damping="0.5"') + '<body name="mocap" mocap="true" pos="0 0 -1.2"/>'
    weld = '<equality><weld body1="mocap" body2="b3" solref="0.08 1" solimp="0.3 0.6 0.1 0.5 2"/></equality>'
    scene = scene_of(body, weld, 'gravity="4 1 -9.81"')
    found = motion(scene, 20000, 1e-4)
    way = np.max(np.abs(found.theirs))
    assert way > 0.005
    assert np.max(np.abs(found.ours - found.theirs)) < 0.01 * way


@pytest.mark.parametrize("mass", [0.1, 5.0])
def test_a_ball_rests_in_a_soft_plane_where_mujocos_does(mass: float) -> None:
    soft = 'solref="0.05 1" solimp="0.3 0.6 0.02 0.5 2"'
    body = f'<geom type="plane" size="1 1 1" {soft}/><body pos="0 0 0.1"><freejoint/><geom size="0.1" mass="{mass}" '
    scene = scene_of(body + f"{soft}/></body>", option='cone="elliptic"')
    found = motion(scene, 5000, 2e-4)
    depth = 0.1 - found.theirs[-1, 2]
    assert depth > 2e-3
    assert np.max(np.abs(found.ours[:, :3] - found.theirs[:, :3])) < 0.02 * depth
    assert found.ours[-1, 2] == pytest.approx(found.theirs[-1, 2], abs=1e-3 * depth)


def test_defaults_and_harder_numbers_hold_exactly_unless_all_shall_give_way() -> None:
    joint = '<joint type="slide" axis="0 0 1" range="-0.01 1" {}/>'
    for numbers in ("", 'solreflimit="0.02 1"', 'solreflimit="0.004 1" solimplimit="0.95 0.99"'):
        text = f'<mujoco><worldbody><body>{joint.format(numbers)}<geom size="0.1"/></body></worldbody></mujoco>'
        assert mh.load_mjcf_string(text)[0].joints[0].compliance is None
        assert mh.load_mjcf_string(text, compliance="all")[0].joints[0].compliance is not None
    soft = joint.format('solreflimit="0.06 1"')
    text = f'<mujoco><worldbody><body>{soft}<geom size="0.1"/></body></worldbody></mujoco>'
    assert mh.load_mjcf_string(text)[0].joints[0].compliance == mh.Compliance(0.06, 1)
    assert mh.load_mjcf_string(text, compliance="none")[0].joints[0].compliance is None


def test_all_of_a_scene_gives_way_as_in_mujoco_where_a_user_wants_it() -> None:
    """MuJoCo's defaults: a slide pressed onto its limit by 50 N."""
    text = '<mujoco><option gravity="0 0 -50"/><worldbody><body><joint type="slide" axis="0 0 1" range="0 1"/>'
    text += '<geom size="0.1" mass="1"/></body></worldbody></mujoco>'
    for compliance in ("stated", "all"):
        scene = Scene.of_string(text, compliance=compliance)
        found = motion(scene, 2000, 1e-3)
        depth = -found.theirs[-1, 0]
        assert depth > 9e-4
        ours = -found.ours[-1, 0]
        assert ours == pytest.approx(depth, rel=1e-3) if compliance == "all" else abs(ours) < 1e-9


def test_lanes_give_way_as_a_single_world() -> None:
    soft = 'solref="0.08 1" solimp="0.3 0.6 0.1"'
    body = arm('damping="0.5" range="-0.05 0.05" solreflimit="0.1 1" solimplimit="0.3 0.6 0.1"')
    body += f'<geom type="plane" pos="0 0 -1.25" size="3 3 1" {soft}/><body pos="0.7 0 -1.1"><freejoint/>'
    scene = scene_of(
        body + f'<geom type="box" size="0.1 0.1 0.1" mass="1" {soft}/></body>',
        f'<equality><connect body1="b3" anchor="0 0 0" {soft}/></equality>',
        'gravity="4 1 -9.81"',
    )
    batch = mh.Batch(scene.ours, 5, time_step=1e-3)
    world = mh.World(scene.ours, 1e-3)
    for _ in range(500):
        batch.step()
        world.step()
    assert np.max(np.abs(np.asarray(batch.q) - world.q)) < 2e-4
    assert np.max(np.abs(world.q[:4])) > 0.05


def test_what_gives_way_is_saved_and_read_back() -> None:
    soft = 'solref="0.07 0.9" solimp="0.31 0.6 0.1 0.4 3"'
    joint = 'range="-0.1 0.1" solreflimit="0.03 1.3" solimplimit="0.5 0.77 0.02"'
    body = arm(joint) + f'<geom name="floor" type="plane" size="3 3 1" pos="0 0 -3" {soft} solmix="2"/>'
    rest = f"""<equality><weld body1="b3" torquescale="0.3" solref="-100 -3"/>
      <connect body1="b2" anchor="0 0 0" {soft}/>
      <joint joint1="j0" joint2="j1" {soft}/></equality>
      <tendon><fixed range="-1 1" solreflimit="0.3 1"><joint joint="j0" coef="1"/></fixed></tendon>"""
    scene = scene_of(body, rest)
    text, _ = mh.save_mjcf_string(scene.ours)
    again, _ = mh.load_mjcf_string(text)
    assert again.fingerprint == scene.ours.fingerprint
    assert again.equalities[0].torque_scale == 0.3
    assert all(equality.compliance is not None for equality in again.equalities)
    assert again.tendons[0].compliance == mh.Compliance(0.3, 1)
    assert 'solreflimit="0.03 1.3"' in text
