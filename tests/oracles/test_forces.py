"""Forces that files ask for besides motors and contacts: accelerations equal MuJoCo's in any state."""

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

import manyhands as mh  # noqa: E402
from benchmarks.mujoco_map import Array, Scene  # noqa: E402

INERTIAL = '<inertial pos="0.1 -0.2 0.3" mass="1.5" diaginertia="0.02 0.03 0.04"/>'

SPRINGS = f"""
<mujoco><compiler angle="degree"/><option gravity="1 2 -9"/><worldbody>
  <body name="a" pos="0 0 1" euler="10 20 30">
    <joint name="h" axis="1 2 3" stiffness="40" springref="25" ref="10"/>{INERTIAL}
    <body name="b" pos="0.1 0 0.3"><joint name="s" type="slide" axis="0 1 1" stiffness="300" springref="0.2"/>{INERTIAL}
      <body name="c" pos="0 0.2 0"><joint name="ball" type="ball" stiffness="7" damping="0.3" pos="0.1 0 0"/>{INERTIAL}
        <body name="d" pos="0 0.2 0"><joint name="d" springdamper="0.1 0.7" armature="0.01"/>{INERTIAL}</body></body>
    </body></body>
  <body name="free" pos="1 2 3" euler="30 20 10"><joint type="free" stiffness="11" damping="0.2"/>{INERTIAL}
    <body name="e" pos="0 0.2 0"><joint name="e" type="ball" springdamper="0.2 1.3"/>{INERTIAL}</body></body>
  <body name="soft" pos="3 2 3"><joint type="free" springdamper="0.3 0.9"/>{INERTIAL}</body>
</worldbody></mujoco>"""


GRAVCOMP = f"""
<mujoco><option gravity="1 2 -9"/><worldbody>
  <body pos="0 0 1" euler="10 20 30" gravcomp="1"><joint axis="1 2 3"/>{INERTIAL}
    <body pos="0.1 0 0.3" gravcomp="0.4">{INERTIAL}
      <body pos="0 0.2 0"><joint type="ball" pos="0.1 0 0"/>{INERTIAL}
        <body pos="0 0.2 0" gravcomp="-0.7">{INERTIAL}</body></body></body></body>
  <body pos="1 2 3" gravcomp="1.5"><freejoint/>{INERTIAL}</body>
</worldbody></mujoco>"""

FLAGGED = f"""
<mujoco><option gravity="1 2 -9"><flag FLAG="disable"/></option><worldbody>
  <geom type="plane" size="1 1 1" pos="0 0 -9"/>
  <body pos="0 0 1" gravcomp="0.5"><joint name="a" axis="0 1 0" stiffness="9" springref="40" damping="2"/>{INERTIAL}
    <geom size="0.1"/>
    <body pos="0.1 0 0.3"><joint name="b" axis="1 1 0" damping="3"/>{INERTIAL}<geom size="0.1"/></body></body>
</worldbody><actuator><motor joint="a" ctrlrange="-1 1"/><position joint="b" kp="5" ctrlrange="-1 1"/></actuator>
</mujoco>"""

RUBBING = f"""
<mujoco><option gravity="1 2 -9"/><default><joint frictionloss="0.2" damping="0.1"/></default><worldbody>
  <body pos="0 0 1" euler="10 20 30"><joint name="a" axis="1 2 3" armature="0.3"/>{INERTIAL}
    <body pos="0.1 0 0.3"><joint name="b" type="slide" axis="0 1 1"/>{INERTIAL}
      <body pos="0 0.2 0"><joint name="c" axis="0 1 0" armature="0.1"/>{INERTIAL}
        <body pos="0 0.2 0"><joint name="d" armature="0.2"/>{INERTIAL}</body></body></body></body>
</worldbody><actuator><velocity joint="a" kv="7" forcerange="-9 9"/><position joint="b" kp="40" kv="3" gear="-2"/>
  <position joint="c" kp="20" forcerange="-5 5"/><position joint="d" kp="9"/><velocity joint="d" kv="2"/>
  <motor joint="d" gear="3"/></actuator></mujoco>"""


def acceleration(model: mh.Model, q: Array, v: Array, ctrl: Array) -> Array:
    """v' (nv) in this state, by a short step and one of half its length, extrapolated to none."""

    def mean(step: float) -> Array:
        world = mh.World(model, time_step=step)
        world.q = q
        world.v = v
        world.ctrl = ctrl
        world.step()
        return (np.asarray(world.v) - v) / step

    return 2 * mean(5e-8) - mean(1e-7)


def assert_equal_accelerations(text: str, states: int = 20) -> None:
    scene = Scene.of_string(text)
    model, data = scene.mujoco, scene.data
    rng, compared = np.random.default_rng(0), 0
    for k in range(states):
        data.qpos = model.qpos0 if k == 0 else scene.random_qpos(rng)
        data.qvel = 0 if k == 0 else rng.uniform(-1, 1, model.nv)
        if model.nu:
            data.ctrl = rng.uniform(-2, 2, model.nu)
        mujoco.mj_forward(model, data)
        slides = (np.abs(data.efc_force) >= (1 - 1e-12) * data.efc_frictionloss) & (data.efc_force * data.efc_vel < 0)
        if not np.all(slides):
            continue  # slow, so that MuJoCo's dry friction yields or is ahead of the motion
        compared += 1
        G = scene.velocity_map(data.qpos)  # of angular accelerations, too: omega x omega = 0
        v, a = G @ data.qvel, G @ data.qacc
        ours = acceleration(scene.ours, scene.configuration(data.qpos), v, np.array(data.ctrl))
        assert np.max(np.abs(ours - a)) < 1e-6 * max(1.0, np.max(np.abs(a))), k
    assert compared >= states // 4


def test_springs() -> None:
    assert_equal_accelerations(SPRINGS)


def test_servos_of_joints_with_dry_friction_and_several_of_one_joint() -> None:
    assert_equal_accelerations(RUBBING)


def test_gravity_compensation() -> None:
    assert_equal_accelerations(GRAVCOMP)


@pytest.mark.parametrize("medium", ['density="900"', 'viscosity="0.7"', 'density="40" viscosity="2" wind="3 -1 2"'])
def test_the_drag_of_a_medium(medium: str) -> None:
    assert_equal_accelerations(SPRINGS.replace("<option", f"<option {medium}"))


def test_without_passive_forces_there_is_no_drag() -> None:
    still = FLAGGED.replace('FLAG="disable"', 'spring="disable" damper="disable"')
    assert_equal_accelerations(still.replace("<option", '<option density="900"'))


@pytest.mark.parametrize("flag", ["gravity", "spring", "damper", "actuation", "clampctrl", "warmstart", "eulerdamp"])
def test_flags(flag: str) -> None:
    assert_equal_accelerations(FLAGGED.replace("FLAG", flag))


def test_without_passive_forces() -> None:
    assert_equal_accelerations(FLAGGED.replace('FLAG="disable"', 'spring="disable" damper="disable"'))


LIMITED = f"""
<mujoco><option timestep="0.001"><flag FLAG="disable"/></option><worldbody>
  <geom name="floor" type="plane" size="1 1 1"/>
  <body name="ball" pos="0 0 0.5"><freejoint/><geom name="ball" size="0.1"/></body>
  <body name="a" pos="1 0 3"><joint name="a" axis="0 1 0" range="-10 10" frictionloss="0.1"/>{INERTIAL}</body>
  <body name="b" pos="2 0 3"><joint name="b" axis="0 1 0"/>{INERTIAL}</body>
  <body name="c" pos="3 0 3"><joint name="c" axis="0 1 0" frictionloss="99"/>{INERTIAL}</body>
</worldbody><equality><joint joint1="b"/></equality></mujoco>"""


@pytest.mark.filterwarnings("ignore:.*a joint held at one place")
@pytest.mark.parametrize("flag", ["contact", "limit", "frictionloss", "equality", "constraint"])
def test_constraint_flags(flag: str) -> None:
    """What is switched off does not hold in half a second's fall, and what is not does."""
    text = LIMITED.replace("FLAG", flag).replace('<joint joint1="b"/>', '<weld body1="b"/>')
    scene = Scene.of_string(text)
    model, data = scene.mujoco, scene.data
    world = mh.World(scene.ours)
    mujoco.mj_step(model, data, 500)
    world.step(500)
    q = scene.configuration(data.qpos)
    assert world.q[2] == pytest.approx(q[2], abs=0.01)  # on the floor, or through it
    free = {"limit": "a", "frictionloss": "c", "equality": "b", "constraint": "abc"}.get(flag, "")
    for i, joint in enumerate("abc"):
        moved = abs(world.q[7 + i] - (0 if joint != "a" else np.sign(world.q[7]) * np.deg2rad(10)))
        assert (moved > 0.05) == (joint in free), joint
        if joint in free and flag != "constraint":
            assert world.q[7 + i] == pytest.approx(q[7 + i], abs=0.01), joint


def test_parents_touch_children_where_nothing_filters_them() -> None:
    """A ball hangs on a hinge, deep in its parent's box: MuJoCo has contacts there only without the filter."""
    text = f"""<mujoco><option><flag filterparent="FLAG"/></option><worldbody>
      <body name="a" pos="0 0 1"><joint axis="0 1 0"/>{INERTIAL}<geom name="box" type="box" size="0.1 0.1 0.1"/>
        <body name="b" pos="0 0 0.15"><joint axis="1 0 0"/>{INERTIAL}<geom name="ball" size="0.1"/>
          <body name="c" pos="0 0 0.3"><joint axis="0 1 0"/><joint axis="1 0 0"/>{INERTIAL}
            <geom name="other" pos="0 0 -0.2" size="0.12"/></body></body></body></worldbody></mujoco>"""
    for flag in ("enable", "disable"):
        scene = Scene.of_string(text.replace("FLAG", flag))
        mujoco.mj_forward(scene.mujoco, scene.data)
        theirs = {frozenset(scene.mujoco.geom(int(i)).name for i in c.geom) for c in scene.data.contact}
        world = mh.World(scene.ours)
        world.step()
        assert {frozenset((c.geom_a, c.geom_b)) for c in world.contacts()} == theirs, flag


MOCAP = f"""
<mujoco><worldbody>
  <body name="hand" mocap="true" pos="0.2 0 1" euler="0 0 20"/>
  <body name="arm" pos="0 0 1"><joint axis="0 0 1" damping="1"/>{INERTIAL}
    <body name="fore" pos="0.3 0 0"><joint axis="0 0 1" damping="1"/>{INERTIAL}
      <body name="tip" pos="0.3 0 0"><joint axis="0 0 1" damping="1"/>{INERTIAL}</body></body></body>
  <body name="stand" mocap="true" pos="3 0 1">
    <body name="bob" pos="0.1 0 0"><joint axis="1 0 0"/>{INERTIAL}</body></body>
</worldbody><equality><weld body1="hand" body2="tip" relpose="0 0 0 1 0 0 0"/></equality></mujoco>"""


def turned(angle: float) -> Array:
    """About z."""
    return np.array([0, 0, np.sin(angle / 2), np.cos(angle / 2)])


def test_keyframes_place_mocap_bodies() -> None:
    keys = """<key name="moved" mpos="1 2 3 4 5 6" mquat="0 1 0 0 0.5 0.5 0.5 0.5" qpos="0.1 0.2 0.3 0.4"/>
      <key name="turned" mquat="0 0 2 0 1 0 0 0"/><key name="start"/>"""
    scene = Scene.of_string(MOCAP.replace("</mujoco>", f"<keyframe>{keys}</keyframe></mujoco>"))
    model, data = scene.mujoco, scene.data
    world = mh.World(scene.ours)
    assert scene.ours.mocap_bodies == ["hand", "stand"]
    for i, name in enumerate(("moved", "turned", "start")):
        mujoco.mj_resetDataKeyframe(model, data, i)
        mujoco.mj_kinematics(model, data)
        world.set_keyframe(name)
        assert np.array_equal(world.mocap, scene.ours.keyframes[i].mocap)
        for body in ("hand", "tip", "stand", "bob"):
            position, quaternion = world.body_pose(body)
            assert np.allclose(position, data.body(body).xpos, rtol=0, atol=1e-12), (name, body)
            assert abs(quaternion[[3, 0, 1, 2]] @ data.body(body).xquat) == pytest.approx(1, abs=1e-12), (name, body)
    with pytest.raises(KeyError, match="'moved' 'turned' 'start'"):
        world.set_keyframe("other")


def test_mocap_bodies_lead_what_is_welded_to_them() -> None:
    """Both arms end where the hand has been moved to; MuJoCo's weld is soft, and gives way by a millimetre."""
    scene = Scene.of_string(MOCAP)
    model, data = scene.mujoco, scene.data
    world = mh.World(scene.ours)
    assert world.model.nq == model.nq
    for k in range(3000):
        part = min(1.0, k / 2000)
        position = np.array([0.2 + 0.2 * part, 0.3 * part, 1.0])
        quaternion = turned(np.deg2rad(20 + 40 * part))
        data.mocap_pos[0], data.mocap_quat[0] = position, quaternion[[3, 0, 1, 2]]
        data.mocap_pos[1] = position
        mujoco.mj_step(model, data)
        world.set_mocap("hand", position, quaternion)
        world.set_mocap("stand", position)
        world.step()
    position = data.mocap_pos[0]
    assert np.allclose(world.body_pose("tip")[0], position, rtol=0, atol=1e-6)
    assert np.allclose(world.body_pose("tip")[0], data.body("tip").xpos, rtol=0, atol=1e-3)
    assert np.allclose(world.body_pose("bob")[0], data.body("bob").xpos, rtol=0, atol=1e-9)


GRIPPER = """
<mujoco><option timestep="0.002"/><worldbody>
  <geom type="plane" size="2 2 1" friction="0.6"/>
  <body name="gripper" mocap="true" pos="-0.15 0 0.05">
    <geom name="left" type="box" size="0.02 0.01 0.04" pos="0.02 0.04 0" friction="0.3"/>
    <geom name="right" type="box" size="0.02 0.01 0.04" pos="0.02 -0.04 0" friction="0.3"/>
    <geom name="palm" type="box" size="0.01 0.05 0.04" pos="-0.01 0 0" friction="0.3"/></body>
  <body name="cube" pos="0 0 0.025"><freejoint/>
    <geom type="box" size="0.025 0.025 0.025" mass="0.2" friction="0.3"/></body>
</worldbody></mujoco>"""


def test_a_mocap_gripper_takes_a_cube_along() -> None:
    """It slides over the cube, turns it by the fingers, and pushes it with the palm, as slowly as a user would."""
    scene = Scene.of_string(GRIPPER)
    model, data = scene.mujoco, scene.data
    world = mh.World(scene.ours)
    for k in range(4000):
        part = min(1.0, k / 3000)
        position, quaternion = np.array([-0.15 + 0.4 * part, 0.05 * part**2, 0.05]), turned(0.4 * part**2)
        data.mocap_pos[0], data.mocap_quat[0] = position, quaternion[[3, 0, 1, 2]]
        mujoco.mj_step(model, data)
        world.set_mocap("gripper", position, quaternion)
        world.step()
    position, quaternion = world.body_pose("cube")
    theirs = data.body("cube")
    assert theirs.xpos[0] > 0.2  # it is taken along
    assert np.allclose(position, theirs.xpos, rtol=0, atol=2e-3)
    assert abs(quaternion[[3, 0, 1, 2]] @ theirs.xquat) > np.cos(0.5 * 0.03)
    assert np.linalg.norm(world.body_velocity("cube")[1]) < 1e-3


def arm_on_a_weld(softness: str) -> str:
    """Seven joints, whose hand a weld leads, as the Sawyer's of metaworld."""
    axes = ["0 0 1", "0 1 0", "1 0 0", "0 1 0", "1 0 0", "0 1 0", "1 0 0"]
    bends = ["0 0 0", "0 40 0", "20 0 0", "0 60 0", "30 0 0", "0 50 0", "0 0 0"]
    body = '<geom name="finger" size="0.02" mass="0.1" contype="0" conaffinity="0"/>'
    for k in reversed(range(7)):
        name = "hand" if k == 6 else f"link{k}"
        body = f"""<body name="{name}" pos="{0.12 * (k % 2)} 0 {0.16 if k % 2 == 0 else 0.05}" euler="{bends[k]}">
          <joint axis="{axes[k]}" damping="2" armature="0.02" range="-170 170"/>
          <inertial pos="0.05 0.01 0.03" mass="{3 - 0.35 * k}" diaginertia="0.02 0.02 0.01"/>{body}</body>"""
    return f"""<mujoco><option timestep="0.0025"/><worldbody>{body}
      <body name="mocap" mocap="true" pos="0.5 0 0.5"/></worldbody>
      <equality><weld body1="mocap" body2="hand" {softness}/></equality></mujoco>"""


def test_a_weld_to_a_mocap_body_leads_an_arm_s_hand() -> None:
    """metaworld's control: the hand follows, as smoothly as by MuJoCo's weld, which lags by a centimetre."""
    scene = Scene.of_string(arm_on_a_weld('solref="0.02 1"'))
    model, data = scene.mujoco, scene.data
    world = mh.World(scene.ours)
    mujoco.mj_forward(model, data)
    start, mocap = np.array(data.body("hand").xpos), np.array(data.mocap_pos[0])
    apart, off, fastest = 0.0, 0.0, 0.0
    for k in range(1600):
        t = 0.0025 * min(k, 1200)
        way = np.array([-0.1 * np.sin(t), 0.15 * np.sin(2 * t), 0.1 * (np.cos(2 * t) - 1)])
        data.mocap_pos[0] = mocap + way
        mujoco.mj_step(model, data)
        world.set_mocap("mocap", mocap + way)
        world.step()
        hand = world.body_pose("hand")[0]
        apart = max(apart, float(np.linalg.norm(hand - data.body("hand").xpos)))
        off = max(off, float(np.linalg.norm(hand - start - way)))
        fastest = max(fastest, float(np.abs(world.v).max()) / max(1.0, float(np.abs(data.qvel).max())))
    assert off < 2e-4  # where the way ends suddenly
    assert apart < 0.015  # as far as the soft weld lags
    assert fastest < 1.3
    assert np.allclose(world.q, data.qpos, rtol=0, atol=0.05)  # of seven joints the elbow is free to swing
