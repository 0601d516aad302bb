"""Sensors: the values that MuJoCo has in the same state, or for a step from it."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

mujoco = pytest.importorskip("mujoco")

import manyhands as mh  # noqa: E402
from benchmarks.mujoco_map import XYZW, Array, Scene  # noqa: E402

INERTIAL = '<inertial pos="0.1 -0.2 0.3" mass="1.5" diaginertia="0.02 0.03 0.04"/>'

BODIES = f"""
<compiler angle="radian"/><option timestep="0.002" gravity="1 2 -9"/>
<worldbody>
  <site name="hook" pos="0.3 0.1 1.5" euler="0.3 0.2 0.1"/>
  <geom name="wall" type="box" size="0.1 9 9" pos="-4 0 0" euler="0 0.1 0.2"/>
  <body name="arm" pos="0 0 1" euler="0.1 0.2 0.3"><joint name="a" axis="1 2 3" ref="0.2"/>{INERTIAL}
    <site name="on_arm" pos="0.1 0.1 0" euler="0.4 0.5 0.6"/>
    <geom name="egg" size="0.05" pos="0.2 0 0.1" euler="0.5 0 0" contype="0" conaffinity="0"/>
    <body name="wrist" pos="0.1 0 0.3"><joint name="w" type="slide" axis="0 1 1"/>
      <joint name="w2" axis="0 1 0" pos="0 0.1 0"/>{INERTIAL}
      <body name="pad" pos="0 0.1 0.2" euler="1 0 0">{INERTIAL}
        <site name="on_pad" pos="0.1 0 0" euler="0 0.3 0"/></body>
      <body name="f" pos="0 0.2 0"><joint name="f" axis="1 0 0" ref="-0.1"/>{INERTIAL}
        <site name="tip" pos="0 0.1 0.1" quat="1 2 3 4"/></body>
      <body name="g" pos="0 -0.2 0"><joint name="g" type="ball" pos="0.1 0.05 0"/>{INERTIAL}
        <site name="s2" pos="0 -0.1 0.1" euler="1 0 0"/></body></body></body>
  <body name="free" pos="1 2 3" euler="0.3 0.2 0.1"><joint name="x" type="free"/>{INERTIAL}
    <site name="on_free" pos="0 0.2 0" euler="0 1 0"/>
    <body name="e" pos="0 0.2 0"><joint name="e" axis="0 1 0"/>{INERTIAL}</body></body>
</worldbody>
<tendon><fixed name="chain"><joint joint="a" coef="1.5"/><joint joint="w" coef="-2"/></fixed>
  <spatial name="rope"><site site="hook"/><site site="on_arm"/><site site="tip"/></spatial></tendon>
<actuator><motor name="m" joint="a" gear="3" forcerange="-1 2"/><general name="k" joint="e" gear="2" gainprm="5"/>
  <motor name="n" tendon="chain" gear="-2"/><motor name="p" site="tip" refsite="on_arm" gear="1 0 2 0.3 0 0"/>
  <general name="d" joint="f" dyntype="filter" dynprm="0.1" gainprm="3"/></actuator>"""

FRAMES = [("site", "tip"), ("site", "s2"), ("xbody", "f"), ("xbody", "free"), ("geom", "egg"), ("body", "wrist")]
POINTS = ["framepos", "framelinvel", "frameangvel", "framelinacc", "frameangacc"]
AXES = ["framequat", "framexaxis", "frameyaxis", "framezaxis"]


def frame_sensors() -> str:
    """Every kind of every frame, in the world and in other frames."""
    lines: list[str] = []
    for kind, name in FRAMES:
        for sensor in POINTS + (AXES if kind != "body" else []):
            of = f'<{sensor} objtype="{kind}" objname="{name}"'
            lines.append(f"{of}/>")
            if not sensor.endswith("acc"):
                lines += [f'{of} reftype="site" refname="on_arm"/>', f'{of} reftype="xbody" refname="free"/>']
    return "".join(lines)


STATE = """
<jointpos joint="a"/><jointvel joint="w"/><jointpos joint="f" cutoff="0.3"/><ballquat joint="g"/>
<ballangvel joint="g"/><tendonpos tendon="rope"/><tendonvel tendon="rope"/><tendonpos tendon="chain"/>
<actuatorpos actuator="m"/><actuatorvel actuator="m"/><actuatorpos actuator="n"/><actuatorvel actuator="n"/>
<actuatorpos actuator="p"/><actuatorvel actuator="p"/><subtreecom body="arm"/><subtreecom body="g"/>
<subtreelinvel body="wrist"/><subtreelinvel body="free"/><subtreeangmom body="wrist"/><subtreeangmom body="arm"/>
<velocimeter site="tip"/><gyro site="tip"/><velocimeter site="s2"/><gyro site="on_free" cutoff="0.5"/>
<rangefinder site="tip"/><rangefinder site="hook" cutoff="2"/><rangefinder site="s2"/><clock/>"""

STEP = """
<accelerometer site="tip"/><accelerometer site="s2"/><accelerometer site="hook"/><accelerometer site="on_free"/>
<force site="tip"/><torque site="tip"/><force site="on_arm"/><torque site="on_arm"/><force site="on_pad"/>
<torque site="on_pad"/><force site="s2"/><torque site="s2"/>
<actuatorfrc actuator="m"/><actuatorfrc actuator="k"/><actuatorfrc actuator="n"/><actuatorfrc actuator="p"/>
<actuatorfrc actuator="d"/>"""


def scene_of(sensors: str, bodies: str = BODIES) -> Scene:
    return Scene.of_string(f"<mujoco>{bodies}<sensor>{sensors}</sensor></mujoco>")


def theirs(scene: Scene) -> list[Array]:
    """Sensor by sensor, quaternions xyzw."""
    model, result = scene.mujoco, []
    for kind, first, size in zip(model.sensor_type, model.sensor_adr, model.sensor_dim, strict=True):
        numbers = np.array(scene.data.sensordata[first : first + size])
        is_quaternion = int(kind) in (mujoco.mjtSensor.mjSENS_FRAMEQUAT, mujoco.mjtSensor.mjSENS_BALLQUAT)
        result.append(numbers[XYZW] if is_quaternion else numbers)
    return result


def assert_equal(scene: Scene, world: mh.World, tolerance: float) -> None:
    sensors = scene.ours.sensors
    assert len(sensors) == scene.mujoco.nsensor
    np.testing.assert_array_equal(
        world.sensor_data(), np.concatenate([world.sensor(sensor.name) for sensor in sensors])
    )
    for i, (sensor, expected) in enumerate(zip(sensors, theirs(scene), strict=True)):
        ours = world.sensor(sensor.name)
        if len(ours) == 4:  # either sign
            assert (Rotation.from_quat(ours).inv() * Rotation.from_quat(expected)).magnitude() < 1e-9
            continue
        scale = max(1.0, np.max(np.abs(expected)))
        error = np.max(np.abs(ours - expected))
        assert error < tolerance * scale, f"{i}: {sensor} {scene.mujoco.sensor(i)} {ours} {expected}"


def put(scene: Scene, world: mh.World, rng: np.random.Generator) -> None:
    model, data = scene.mujoco, scene.data
    data.qpos, data.qvel = scene.random_qpos(rng), rng.uniform(-1, 1, model.nv)
    data.ctrl, data.act = rng.uniform(-2, 2, model.nu), rng.uniform(-2, 2, model.na)
    mujoco.mj_forward(model, data)
    world.q, world.v = scene.configuration(data.qpos), scene.velocity_map(data.qpos) @ data.qvel
    world.ctrl, world.act = data.ctrl, data.act


@pytest.mark.parametrize("sensors", [STATE, frame_sensors()], ids=["others", "frames"])
def test_of_the_present_state(sensors: str) -> None:
    scene = scene_of(sensors.replace("framelinacc", "framepos").replace("frameangacc", "framepos"))
    rng = np.random.default_rng(0)
    assert not any("sensor" in note.element for note in scene.report.notes), str(scene.report)
    world = mh.World(scene.ours)
    for _ in range(20):
        put(scene, world, rng)
        assert_equal(scene, world, 1e-9)


@pytest.mark.parametrize("sensors", [STEP, frame_sensors()], ids=["others", "frames"])
def test_of_a_step(sensors: str) -> None:
    """Those that need accelerations and forces: of the step from that state, taken or to come."""
    only = "".join(line + ">" for line in sensors.split(">") if "frame" not in line or "acc" in line)
    scene, rng = scene_of(only), np.random.default_rng(1)
    world = mh.World(scene.ours)
    for k in range(20):
        put(scene, world, rng)
        if k > 0:
            world.step()
        assert_equal(scene, world, 1e-9)


def test_forces_of_welds_and_pushes_count() -> None:
    """Along a slide the joint carries nothing: a weld to a mocap body carries weight and push."""
    text = f"""<mujoco><worldbody><body name="hand" mocap="true" pos="0 0 1"/>
      <body name="a" pos="0 0 1"><joint name="a" type="slide"/>{INERTIAL}<site name="s"/></body></worldbody>
      <equality><weld body1="hand" body2="a"/></equality>
      <sensor><force site="s"/><accelerometer site="s"/></sensor></mujoco>"""
    world = mh.World(Scene.of_string(text).ours)
    for _ in range(50):
        world.apply_force("a", [0, 0, 20.0])
        world.step()
        assert world.sensor_data()[2] == pytest.approx(0, abs=1e-6)
    assert world.sensor_data()[5] == pytest.approx(9.81, abs=1e-6)


TOUCH = """<mujoco><option timestep="0.002" cone="elliptic"/><worldbody>
  <geom name="floor" type="plane" size="1 1 1"/>
  <body name="box" pos="0 0 0.1"><freejoint/><geom name="box" type="box" size="0.1 0.1 0.1" mass="2"/>
    <site name="all" type="box" size="0.11 0.11 0.11"/>
    <site name="half" type="box" size="0.06 0.11 0.11" pos="0.06 0 0"/>
    <site name="top" type="sphere" size="0.02" pos="0 0 0.1"/>
    <site name="below" type="cylinder" size="0.3 0.01" pos="0 0 -0.2"/></body>
  <body name="stand" pos="1 0 0"><geom type="box" size="0.1 0.1 0.05" contype="0" conaffinity="0"/>
    <joint name="lift" type="slide" axis="0 0 1" damping="9" stiffness="900"/><site name="under"/></body>
</worldbody><sensor><touch site="all"/><touch site="half"/><touch site="top"/><touch site="below"/>
  <touch site="all" cutoff="3"/><rangefinder site="top"/><force site="under"/></sensor></mujoco>"""


def test_touch() -> None:
    """A box at rest: its weight, half of it, nothing; beneath the floor, where rays lead, its weight."""
    scene = Scene.of_string(TOUCH)
    world, data = mh.World(scene.ours), scene.data
    mujoco.mj_step(scene.mujoco, data, 2000)
    world.step(2000)
    mujoco.mj_forward(scene.mujoco, data)
    ours = world.sensor_data()
    weight = 2 * 9.81
    np.testing.assert_allclose(ours[:5], [weight, weight / 2, 0, weight, 3], rtol=0, atol=1e-6)
    np.testing.assert_allclose(ours, data.sensordata, rtol=0, atol=2e-3 * weight)


def test_what_cannot_be_read_is_noted_and_changes_nothing() -> None:
    sensors = """<magnetometer site="tip"/><framequat objtype="body" objname="arm"/><jointpos name="j" joint="a"/>
      <user dim="2"/>"""
    model, report = mh.load_mjcf_string(f"<mujoco>{BODIES}<sensor>{sensors}</sensor></mujoco>")
    assert [(s.name, s.type, s.size) for s in model.sensors] == [("j", "jointpos", 1)]
    assert not any(note.serious for note in report.notes)
    assert sum("sensor" in note.element + note.message for note in report.notes) == 3


def test_saved_models_measure_the_same() -> None:
    scene = scene_of(STATE + STEP + frame_sensors())
    again, _ = mh.load_mjcf_string(mh.save_mjcf_string(scene.ours)[0])
    assert [(s.name, s.type) for s in again.sensors] == [(s.name, s.type) for s in scene.ours.sensors]
    assert again.fingerprint == scene.ours.fingerprint
    first, second, rng = mh.World(scene.ours), mh.World(again), np.random.default_rng(4)
    put(scene, first, rng)
    second.q, second.v, second.ctrl, second.act = first.q, first.v, first.ctrl, first.act
    np.testing.assert_allclose(second.sensor_data(), first.sensor_data(), rtol=0, atol=1e-9)
    touch = Scene.of_string(TOUCH).ours
    touching = mh.World(mh.load_mjcf_string(mh.save_mjcf_string(touch)[0])[0])
    touching.step(2000)
    assert touching.sensor_data()[1] == pytest.approx(9.81, abs=1e-6)


def test_rk4_finds_no_forces_but_positions() -> None:
    world = mh.World(scene_of(STEP).ours, integrator="rk4")
    with pytest.raises(RuntimeError, match="rk4 has no reactions"):
        world.sensor_data()
    assert len(mh.World(scene_of(STATE).ours, integrator="rk4").sensor_data()) > 0


def test_unknown_names_and_builder() -> None:
    builder = mh.ModelBuilder("stick")
    builder.add_link("stick", mass=2.0, com=(0, 0, -1.0), inertia=((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    builder.add_joint("hinge", "revolute", "world", "stick", axis=(0, 1, 0))
    builder.add_frame("end", "stick", position=(0, 0, -2.0))
    builder.add_sensor("angle", "jointpos", joint="hinge")
    builder.add_sensor("imu", "accelerometer", frame="end")
    world = mh.World(builder.build())
    np.testing.assert_allclose(world.sensor("imu"), [0, 0, 9.81], atol=1e-9)
    world.step()
    np.testing.assert_allclose(world.sensor_data(), [0, 0, 0, 9.81], atol=1e-9)
    with pytest.raises(KeyError, match="angle"):
        world.sensor("nothing")
    with pytest.raises(ValueError, match="jointpos"):
        builder.add_sensor("x", "smell")
