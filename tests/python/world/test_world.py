"""World from Python: parts in a line each, forces and contacts, absurd input."""

import copy
import math
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import manyhands as mh
from manyhands import Camera

NUMBERS = st.one_of(
    st.floats(allow_nan=True, allow_infinity=True), st.sampled_from([0.0, -1.0, 1e300, -1e300, 1e-300, 1e6])
)
TRIPLES = st.tuples(NUMBERS, NUMBERS, NUMBERS)


def table() -> mh.World:
    """A floor and two cubes of 4 cm, one on the other."""
    world = mh.World()
    world.add_plane("floor")
    world.add_box("low", [0.02, 0.02, 0.02], 0.1, [0, 0, 0.02])
    world.add_box("high", [0.02, 0.02, 0.02], 0.1, [0, 0, 0.06])
    return world


def test_parts_come_and_go_in_a_line_each() -> None:
    world = table()
    world.add_sphere("ball", 0.03, 0.2, [0.2, 0, 0.03], friction=0.9, rolling_friction=1e-3)
    world.add_cylinder("can", 0.03, 0.05, position=[0.4, 0, 0.05])
    world.add_capsule("pill", 0.01, 0.02, position=[0.6, 0, 0.01], quaternion=[0, math.sqrt(0.5), 0, math.sqrt(0.5)])
    world.add_mesh("wedge", np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]), position=[0.8, 0, 0])
    world.add(mh.asset_path("panda/panda.urdf"), [0, 1, 0], name="panda")
    assert world.names == ["floor", "low", "high", "ball", "can", "pill", "wedge", "panda"]
    world.step(100)
    assert world.body_pose("ball")[0][2] == pytest.approx(0.03, abs=1e-3)
    world.remove("panda")
    world.remove("wedge")
    assert world.names == ["floor", "low", "high", "ball", "can", "pill"]
    with pytest.raises(KeyError, match="floor"):
        world.remove("panda")
    with pytest.raises(ValueError, match="ball"):
        world.add_sphere("ball", 0.1)
    builder = mh.ModelBuilder("hook")
    builder.add_link("hook", mass=1, inertia=np.eye(3) * 0.01)
    world.add(builder, name="shop")
    assert world.model.link("shop/hook").mass == 1


def test_contacts_tell_who_carries_whom() -> None:
    world = table()
    world.step(1000)
    weight = 0.1 * 9.81
    assert world.contact_wrench("low", "high").total[5] == pytest.approx(-weight, rel=1e-5)
    assert world.contact_wrench("low", "floor").total[5] == pytest.approx(2 * weight, rel=1e-5)
    assert world.contact_wrench("low").total[5] == pytest.approx(weight, rel=1e-5)
    points = world.contacts()
    assert {(c.link_a, c.link_b) for c in points} == {("low", "high"), ("low", "floor")}
    for point in points:
        assert point.normal_force == pytest.approx(point.force @ point.normal)
        np.testing.assert_allclose(point.force, point.impulse / world.time_step)
        np.testing.assert_allclose(point.normal_force * point.normal + point.friction_force, point.force, atol=1e-12)
    assert world.residuals().signorini < 1e-8
    assert 0 <= world.max_penetration() < 1e-4


def test_copies_and_snapshots_go_on_alike() -> None:
    world = table()
    world.step(20)
    snapshot, twin, other = world.snapshot(), copy.deepcopy(world), table()
    world.apply_force("high", [0.3, 0, 0])
    world.step(30)
    other.restore(snapshot)
    for each in (twin, other):
        each.apply_force("high", [0.3, 0, 0])
        each.step(30)
        assert each.state_hash() == world.state_hash()
    with pytest.raises(ValueError, match=r"the snapshot is of a World of .*; expected one of a World of"):
        mh.World().restore(snapshot)


def through_pickle(value: Any) -> Any:
    return pickle.loads(pickle.dumps(value))


def test_a_model_is_its_own_copy_and_its_pickle_the_same_to_the_last_bit() -> None:
    model = table().model
    assert copy.copy(model) is model
    assert copy.deepcopy({"model": model})["model"] is model
    for path in ("panda/panda.urdf", "arm6/arm6.urdf"):
        model, _ = mh.load_urdf(mh.asset_path(path))
        again = through_pickle(model)
        assert again.fingerprint == model.fingerprint
        assert mh.save_mjcf_string(again)[0] == mh.save_mjcf_string(model)[0]


@pytest.mark.parametrize("copied", [copy.deepcopy, through_pickle])
def test_worlds_go_on_alike_when_copied_and_pickled(copied: Callable[[Any], Any]) -> None:
    world = mh.World.from_file(mh.asset_path("panda/panda.urdf"), time_step=0.004)
    world.step(3)
    world.add_plane("floor")
    world.add_box("gone", [0.1] * 3, position=[1, 1, 1])
    world.add_box("cube", [0.02] * 3, position=[0.5, 0, 0.02])
    world.set_solver(max_iterations=7)
    world.remove("gone")
    world.step(40)
    other = copied(world)
    assert repr(other) == repr(world)
    assert str(other.report) == str(world.report)
    for each in (world, other):
        each.apply_force("cube", [0.3, 0, 0])
        each.step(60)
    assert other.state_hash() == world.state_hash()
    assert other.time == world.time


@pytest.mark.parametrize("copied", [copy.deepcopy, through_pickle])
@pytest.mark.parametrize("lanes", [0, 1])
def test_batches_go_on_alike_when_copied_and_pickled(copied: Callable[[Any], Any], lanes: int) -> None:
    batch = mh.Batch(table().model, 5, time_step=0.003, num_threads=2, lanes=lanes)
    batch.set_solver(max_iterations=9)
    batch.set_mass("high", np.linspace(0.5, 1.5, 5))
    batch.step(30)
    other = copied(batch)
    assert repr(other) == repr(batch)
    for each in (batch, other):
        each.step(50)
    assert other.state_hash() == batch.state_hash()


def test_damaged_pickles_are_refused() -> None:
    world = table()
    for each in (world, world.model, mh.Batch(world.model, 2), Camera.perspective(8, 8, 1)):
        state = bytearray(each.__getstate__())
        state[len(state) // 2] ^= 1
        with pytest.raises(ValueError, match="damaged"):
            type(each).__new__(type(each)).__setstate__(bytes(state))


def test_what_pictures_are_taken_with_can_be_pickled() -> None:
    camera = Camera.perspective(40, 30, 0.8).look_at([1, 1, 1], [0, 0, 0], frame="low")
    texture = mh.Texture.noise((1, 0, 0), (0, 0, 1), seed=3, repeat=2)
    look = mh.Look(shadow_rays=4, sun_size=0.2, zenith=(0.1, 0.2, 0.3))
    marks = [mh.Mark("sphere", [0.1], [0, 0, 0.5])]
    world = table()
    first = world.render(camera, look=look, marks=marks, textures={"low": texture})
    again = world.render(
        through_pickle(camera), look=through_pickle(look), marks=through_pickle(marks),
        textures={"low": through_pickle(texture)},
    )  # fmt: skip
    np.testing.assert_array_equal(again.colour, first.colour)
    assert [repr(each) for each in (camera, look, texture, marks[0], first)] == [
        "<Camera of 40 x 30 pixels, on 'low'>", "<Look: 4 shadow rays, 1 x 1 samples>", "<Texture of 128 x 128 pixels>",
        "<Mark: sphere>", "<Picture of 40 x 30 pixels: colour depth segmentation>",
    ]  # fmt: skip


def test_a_wrist_feels_what_hangs_on_it() -> None:
    model, _ = mh.load_urdf(mh.asset_path("panda/panda.urdf"))
    world = mh.World(model)
    world.set_motors(target_q=world.q, kp=0.1, max_force=1e4)
    world.step(100)
    beyond = {"panda_hand", "panda_leftfinger", "panda_rightfinger", "panda_grasptarget"}
    weight = 9.81 * sum(link.mass for link in model.links if link.name in beyond)
    wrench = world.joint_wrench("panda_hand_joint")
    assert wrench[5] == pytest.approx(weight, rel=1e-6)


SCENE = """
<mujoco>
  <option timestep="0.004"/>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="ball" pos="0 0 0.1"><freejoint/><geom type="sphere" size="0.05"/></body>
    <body name="arm" pos="1 0 1"><joint name="hinge" axis="0 1 0"/><geom type="capsule" size="0.02 0.1"/></body>
  </worldbody>
  <actuator><position name="servo" joint="hinge" kp="50" kv="5" ctrlrange="-1 1"/></actuator>
</mujoco>
"""


def test_a_scene_file_brings_time_step_places_and_drives(tmp_path: Path) -> None:
    (tmp_path / "scene.xml").write_text(SCENE)
    world = mh.World.from_file(tmp_path / "scene.xml")
    assert world.time_step == 0.004
    assert world.body_pose("ball")[0][2] == pytest.approx(0.1)
    world.ctrl = [3.0]
    assert world.ctrl == [1.0]
    world.step(1000)
    assert world.body_pose("ball")[0][2] == pytest.approx(0.05, abs=1e-3)
    assert world.q[world.model.joint("hinge").iq] == pytest.approx(1.0, abs=1e-2)
    with pytest.raises(ValueError, match="hinge"):
        world.set_motors(max_force=1.0)
    world.add(tmp_path / "scene.xml", [0, 5, 0], name="other")
    assert world.body_pose("other/ball")[0].tolist() == pytest.approx([0, 5, 0.1])
    assert world.ctrl.tolist() == [1.0, 0.0]


def test_errors_name_what_was_wrong() -> None:
    world = table()
    with pytest.raises(ValueError, match="time_step"):
        mh.World(time_step=0)
    with pytest.raises(KeyError, match="low"):
        world.body_pose("nobody")
    with pytest.raises(ValueError, match="fixed to the world"):
        world.set_body_velocity("floor", [1, 0, 0])
    world.apply_force("high", [1e308, 0, 0])
    with pytest.raises(mh.SimulationError, match="high_free"):
        world.step()
    world.step()
    with pytest.raises(FileNotFoundError):
        mh.World.from_file("nowhere.xml")


def bounded(world: mh.World, reach: float = 1e7) -> bool:
    """No number is infinite, not a number, or beyond reason."""
    return bool(np.all(np.abs(world.q) < reach) and np.all(np.isfinite(world.v)))


@settings(deadline=None, max_examples=60)
@given(force=TRIPLES, torque=TRIPLES, point=TRIPLES)
def test_any_force_is_refused_or_survived(
    force: tuple[float, ...], torque: tuple[float, ...], point: tuple[float, ...]
) -> None:
    world = table()
    world.step(3)
    before = world.q
    try:
        world.apply_force("high", force, torque, point)
        world.step(2)
    except ValueError:
        assert not np.all(np.isfinite([*force, *torque, *point]))
    except mh.SimulationError:
        assert np.all(np.isfinite(world.q)) and np.all(np.isfinite(world.v))
        world.restore(table().snapshot())
        return
    assert np.all(np.isfinite(world.q)) and np.all(np.isfinite(before))


@settings(deadline=None, max_examples=60)
@given(size=TRIPLES, mass=NUMBERS, position=TRIPLES, friction=NUMBERS, restitution=NUMBERS)
def test_any_body_is_refused_or_stays_finite(
    size: tuple[float, ...], mass: float, position: tuple[float, ...], friction: float, restitution: float
) -> None:
    world = table()
    try:
        world.add_box("box", size, mass, position, friction=friction, restitution=restitution)
        world.step(5)
    except (ValueError, mh.SimulationError):
        pass
    assert np.all(np.isfinite(world.q)) and np.all(np.isfinite(world.v))


@settings(deadline=None, max_examples=40)
@given(
    time_step=st.floats(1e-5, 1.0),
    ratio=st.floats(-6, 6),
    overlap=st.floats(-0.04, 0.04),
    friction=st.floats(0, 10),
)
@example(time_step=1.0, ratio=0.0, overlap=0.0, friction=3.8e-162)  # its square is no normal number
def test_harsh_scenes_stay_bounded(time_step: float, ratio: float, overlap: float, friction: float) -> None:
    world = mh.World(time_step=time_step)
    world.add_plane("floor", friction=friction)
    world.add_box("low", [0.02, 0.02, 0.02], 1.0, [0, 0, 0.02 + overlap], friction=friction)
    world.add_box("high", [0.02, 0.02, 0.02], 10.0**ratio, [0.001, 0, 0.06 + overlap], friction=friction)
    world.step(60)
    assert bounded(world)


def test_parameters_are_read_back() -> None:
    world = table()
    world.set_mass("low", 0.5)
    world.set_friction("low", 0.8)
    world.set_restitution("high", 0.3)
    world.gravity = [0, 0, -1.6]
    world.set_geom_size("high", [0.01, 0.02, 0.03])
    assert world.mass("low") == 0.5
    assert world.friction("low") == 0.8
    assert world.restitution("high") == 0.3
    np.testing.assert_array_equal(world.gravity, [0, 0, -1.6])
    np.testing.assert_array_equal(world.geom_size("high"), [0.01, 0.02, 0.03])
    world.set_solver(max_iterations=7)
    assert world.max_iterations == 7
    with pytest.raises(ValueError, match="mass"):
        world.set_mass("low", 0)


def test_mocap_bodies_join_a_world_with_an_arm() -> None:
    """They come before what stands on a welded link, and have no dofs: the arm's bodies move up, its dofs do not."""
    world = mh.World.from_file(mh.asset_path("panda/panda.urdf"))
    rng = np.random.default_rng(0)
    for k in range(2):
        builder = mh.ModelBuilder(f"ghost{k}")
        builder.add_link(f"ghost{k}")
        builder.add_joint(f"place{k}", "mocap", "world", f"ghost{k}")
        world.add(builder)
        world.set_mocap(f"ghost{k}", [k, 0, 1])
    world.q = rng.uniform(-0.5, 0, world.model.nq)
    for link in world.model.links:
        if not link.name.startswith("ghost"):
            expected = mh.dynamics.frame_pose(world.model, world.q, link.name)[0]
            np.testing.assert_allclose(world.body_pose(link.name)[0], expected, atol=1e-12)
    twin = mh.World(world.model)  # built at once
    twin.q = world.q
    world.step(20)
    twin.step(20)
    np.testing.assert_array_equal(world.q, twin.q)
