"""Actuators of every law on joints, tendons and sites, and their activations: as MuJoCo has them."""

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

import manyhands as mh  # noqa: E402
from benchmarks.mujoco_map import Array, Scene  # noqa: E402

INERTIAL = '<inertial pos="0.1 -0.2 0.3" mass="1.5" diaginertia="0.02 0.03 0.04"/>'

BODIES = f"""
<compiler angle="radian"/><option timestep="0.002" gravity="1 2 -9"/>
<worldbody>
  <site name="hook" pos="0.3 0.1 1.5" euler="0.3 0.2 0.1"/>
  <body name="arm" pos="0 0 1" euler="0.1 0.2 0.3"><joint name="a" axis="1 2 3" ref="0.2" damping="0.3"/>{INERTIAL}
    <site name="on_arm" pos="0.1 0.1 0" euler="0.4 0.5 0.6"/>
    <body name="wrist" pos="0.1 0 0.3"><joint name="w" type="slide" axis="0 1 1"/>{INERTIAL}
      <body name="f" pos="0 0.2 0"><joint name="f" axis="1 0 0" ref="-0.1"/>{INERTIAL}
        <site name="tip" pos="0 0.1 0.1" quat="1 2 3 4"/></body>
      <body name="g" pos="0 -0.2 0"><joint name="g" type="ball" pos="0.1 0.05 0"/>{INERTIAL}
        <site name="s2" pos="0 -0.1 0.1" euler="1 0 0"/></body></body></body>
  <body name="free" pos="1 2 3" euler="0.3 0.2 0.1"><joint name="x" type="free"/>{INERTIAL}
    <site name="on_free" pos="0 0.2 0" euler="0 1 0"/>
    <body name="e" pos="0 0.2 0"><joint name="e" axis="0 1 0"/>{INERTIAL}</body></body>
</worldbody>
<tendon><fixed name="chain"><joint joint="a" coef="1.5"/><joint joint="w" coef="-2"/></fixed>
  <spatial name="rope"><site site="hook"/><site site="on_arm"/><site site="tip"/></spatial></tendon>"""

LAWS = {
    "affine": """
  <general joint="a" gaintype="affine" gainprm="2 0.7 -0.3" biastype="affine" biasprm="0.5 -3 -0.2" gear="1.5"/>
  <general joint="w" gaintype="affine" gainprm="-2 0.7 0.3" biastype="affine" biasprm="0.5 3 0.2"/>
  <general joint="f" gaintype="affine" gainprm="1 2 3" forcerange="-0.4 0.7" gear="-2"/>
  <damper joint="e" kv="3" ctrlrange="0 2"/>
  <general tendon="chain" gaintype="affine" gainprm="2 0.7 -0.3" biastype="affine" biasprm="0.5 3 -0.2"/>
  <general tendon="rope" gainprm="0" biastype="affine" biasprm="1.5 -30 -2"/>
  <general joint="e" gainprm="0" biastype="affine" biasprm="1.5 0 0"/>""",
    "several of a joint": """
  <position joint="a" kp="40" kv="2" forcerange="-5 5"/><position joint="a" kp="30" forcerange="-1 20"/>
  <velocity joint="a" kv="9" forcerange="-4 4"/><motor joint="a" gear="3" forcerange="-1 2"/>
  <general joint="w" gainprm="5" biastype="affine" biasprm="3 -40 -1" forcerange="-3 9" gear="-1.5"/>
  <position tendon="rope" kp="40" forcerange="-2 2"/><velocity tendon="rope" kv="7" forcerange="-2 1"/>
  <position joint="f" kp="20" forcerange="-5 1"/>""",
    "activations": """
  <general joint="a" dyntype="integrator" gainprm="3"/>
  <general joint="w" dyntype="filter" dynprm="0.05" gainprm="20" biastype="affine" biasprm="1 -20 -2"/>
  <general joint="f" dyntype="filterexact" dynprm="0.05" gainprm="2" actrange="-0.5 0.7"/>
  <intvelocity joint="e" kp="30" kv="2" actrange="-1 1"/>
  <cylinder tendon="chain" timeconst="0.3" area="2" bias="0.1 -3 -1"/>
  <cylinder joint="e" timeconst="0.3" diameter="2"/>
  <position tendon="rope" kp="20" kv="1" timeconst="0.1"/>
  <motor joint="a" gear="2"/>""",
    "sites": """
  <motor site="tip" gear="1 2 3 0.4 0.5 0.6" forcerange="-1 1.5"/>
  <general site="on_free" gear="0 0 1 0 0 -0.2" gainprm="2" biastype="affine" biasprm="0.3 -9 -0.5"/>
  <motor site="tip" refsite="on_arm" gear="1 -2 0.5 0.3 0 0.2"/>
  <position site="tip" refsite="hook" gear="1 0 0 0 0 0" kp="30" kv="3"/>
  <position site="s2" refsite="tip" gear="0 0 0 1 0.5 0.2" kp="20"/>
  <position site="on_free" refsite="tip" gear="0 1 0 0.3 0 0" kp="10" kv="1"/>
  <velocity site="s2" gear="0 0 0 0 0 1" kv="2"/>
  <general site="s2" refsite="on_free" gear="1 1 1 0 0 0" gaintype="affine" gainprm="1 0.3 0.2"/>""",
    "ball joints": """
  <motor joint="g" gear="1 2 3"/><motor jointinparent="g" gear="3 -1 2"/>
  <position joint="g" gear="0 1 0.5" kp="9" kv="1"/><position jointinparent="g" gear="1 0 0.2" kp="7"/>""",
}


def scene_of(actuators: str) -> Scene:
    return Scene.of_string(f"<mujoco>{BODIES}<actuator>{actuators}</actuator></mujoco>")


def acceleration(model: mh.Model, q: Array, v: Array, ctrl: Array, act: Array) -> Array:
    """v' (nv) in this state, by short steps, extrapolated to none."""

    def mean(step: float) -> Array:
        world = mh.World(model, time_step=step)
        world.q, world.v, world.ctrl, world.act = q, v, ctrl, act
        world.step()
        return (np.asarray(world.v) - v) / step

    return 2 * mean(5e-8) - mean(1e-7)


@pytest.mark.parametrize("kind", LAWS)
def test_accelerations(kind: str) -> None:
    scene, rng = scene_of(LAWS[kind]), np.random.default_rng(0)
    assert not any(note.serious for note in scene.report.notes), str(scene.report)
    model, data = scene.mujoco, scene.data
    assert (scene.ours.nu, scene.ours.na) == (model.nu, model.na)
    for k in range(30):
        data.qpos, data.qvel = scene.random_qpos(rng), rng.uniform(-1, 1, model.nv)
        data.ctrl, data.act = rng.uniform(-2, 2, model.nu), rng.uniform(-1, 1, model.na)
        mujoco.mj_forward(model, data)
        G = scene.velocity_map(data.qpos)
        a = G @ data.qacc
        ours = acceleration(scene.ours, scene.configuration(data.qpos), G @ data.qvel, data.ctrl, data.act)
        assert np.max(np.abs(ours - a)) < 1e-6 * max(1.0, np.max(np.abs(a))), k


def test_activations_advance_as_mujocos() -> None:
    """Whatever the motion does: they follow commands alone."""
    scene, rng = scene_of(LAWS["activations"]), np.random.default_rng(1)
    model, data, world = scene.mujoco, scene.data, mh.World(scene.ours)
    data.act = world.act = rng.uniform(-2, 2, model.na)
    for _ in range(300):
        data.ctrl = world.ctrl = rng.uniform(-3, 3, model.nu)
        mujoco.mj_step(model, data)
        world.step()
        np.testing.assert_allclose(world.act, data.act, rtol=0, atol=1e-13)


@pytest.mark.parametrize("early", ["true", "false"])
def test_early_activations_act_in_the_same_step(early: str) -> None:
    """One step from rest at the joint's origin, where MuJoCo's velocity is exact."""
    text = f"""<mujoco><option timestep="0.01" gravity="0 0 0"/><worldbody><body><joint name="a"/>{INERTIAL}</body>
      </worldbody><actuator>
      <general joint="a" dyntype="filter" dynprm="0.05" actearly="{early}"/></actuator></mujoco>"""
    scene = Scene.of_string(text)
    world, data = mh.World(scene.ours), scene.data
    for _ in range(5):
        data.ctrl = world.ctrl = [2.0]
        mujoco.mj_step(scene.mujoco, data)
        world.step()
        np.testing.assert_allclose(world.v, data.qvel, rtol=0, atol=1e-12)
    assert data.qvel[0] != 0


def test_motors_at_sites_step_as_mujocos() -> None:
    """Forces are explicit in both: velocities agree after any step."""
    motors = """<motor site="tip" gear="1 2 3 0.4 0.5 0.6" forcerange="-1 1.5"/>
      <motor site="tip" refsite="on_arm" gear="1 -2 0.5 0.3 0 0.2"/>"""
    scene, rng = scene_of(motors), np.random.default_rng(2)
    model, data, world = scene.mujoco, scene.data, mh.World(scene.ours)
    model.dof_damping[:] = 0
    world.set_damping("a", 0.0)
    for _ in range(5):
        data.qpos, data.qvel = scene.random_qpos(rng), rng.uniform(-1, 1, model.nv)
        data.ctrl = world.ctrl = rng.uniform(-3, 3, 2)
        mujoco.mj_forward(model, data)
        G = scene.velocity_map(data.qpos)
        v = G @ data.qvel
        world.q, world.v = scene.configuration(data.qpos), v
        world.step()
        np.testing.assert_allclose(world.v, v + 0.002 * G @ data.qacc, rtol=0, atol=1e-12)


def test_snapshots_keyframes_and_batches_hold_activations() -> None:
    text = f"""<mujoco>{BODIES}<actuator>{LAWS["activations"]}</actuator>
      <keyframe><key name="k" act="0.1 0.2 0.3 0.4 0.5 0.6 0.7"/></keyframe></mujoco>"""
    scene = Scene.of_string(text)
    world, rng = mh.World(scene.ours), np.random.default_rng(3)
    assert world.act.tolist() == [0.0] * 7
    world.set_keyframe("k")
    np.testing.assert_array_equal(world.act, scene.mujoco.key_act[0])
    np.testing.assert_array_equal(scene.ours.keyframes[0].act, scene.mujoco.key_act[0])
    world.ctrl = rng.uniform(-1, 1, 8)
    world.step(20)
    saved = world.snapshot()
    world.step(20)
    end = world.state_hash()
    world.restore(saved)
    world.step(20)
    assert world.state_hash() == end
    actuator = scene.ours.actuators[3]
    assert world.activation(actuator.name) == world.act[actuator.iact]
    world.set_activation(actuator.name, 0.25)
    assert world.act[actuator.iact] == 0.25
    with pytest.raises(ValueError, match="has no activation"):
        world.activation(scene.ours.actuators[7].name)

    batch = mh.Batch(scene.ours, 3, time_step=0.002)
    batch.act = np.arange(21).reshape(3, 7) / 21
    batch.ctrl = rng.uniform(-1, 1, (3, 8))
    alone = mh.World(scene.ours)
    alone.act, alone.ctrl = batch.act[1].astype(float), batch.ctrl[1].astype(float)
    batch.step(50)
    alone.step(50)
    np.testing.assert_allclose(batch.act[1], alone.act, rtol=0, atol=1e-5)
    batch.reset(np.array([False, True, False]))
    assert batch.act[1].tolist() == [0.0] * 7
    assert batch.act[0].any()


def test_parts_come_and_go_with_their_activations() -> None:
    model = scene_of(LAWS["activations"] + LAWS["sites"]).ours
    world = mh.World()
    world.add(model, name="one")
    world.add(model, name="two", position=(5, 0, 0))
    act = np.linspace(-0.4, 0.4, 2 * model.na)
    world.act = act
    world.remove("one/arm")
    names = [a.name for a in world.model.actuators]
    assert all(n.startswith("two/") for n in names[3:])
    kept = [a.iact for a in world.model.actuators if a.name.startswith("two/") and a.iact >= 0]
    np.testing.assert_array_equal(world.act[kept], act[model.na :])
    world.step(10)
    alone = mh.World(world.model)
    alone.act = world.act
    alone.step()


@pytest.mark.parametrize("kind", LAWS)
def test_saved_models_are_the_same(kind: str) -> None:
    model = scene_of(LAWS[kind]).ours
    again, report = mh.load_mjcf_string(mh.save_mjcf_string(model)[0])
    assert not any(note.serious for note in report.notes)
    assert [(a.name, a.type, a.gain, a.bias, a.activation, a.act_range, a.min_force) for a in again.actuators] == [
        (a.name, a.type, a.gain, a.bias, a.activation, a.act_range, a.min_force) for a in model.actuators
    ]
    if kind != "ball joints":  # their sites' frames are products of rotations
        assert again.fingerprint == model.fingerprint


def test_builder() -> None:
    """What Python builds moves as what MJCF says."""
    builder = mh.ModelBuilder("cart")
    builder.add_link("cart", mass=2.0, inertia=((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    builder.add_joint("x", "floating", "world", "cart")
    builder.add_frame("nose", "cart", position=(0.5, 0, 0))
    builder.add_actuator("push", "force", site="nose", force=(0, 0, 3), activation="filter", time_constant=0.1)
    builder.set_gravity((0, 0, 0))
    world = mh.World(builder.build(), time_step=0.01)
    world.ctrl = [2.0]
    world.step(2)
    assert world.act[0] == pytest.approx(2 * (1 - 0.9**2))
    assert world.v[5] == pytest.approx(0.01 * 3 * 0.2 / 2.0)
    assert world.v[1] == pytest.approx(-0.5 * 0.01 * 3 * 0.2)
