"""panda_gym.pybullet.PyBullet: what the manual and panda-gym's own tests promise of every method."""

import math
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import manyhands as mh
from manyhands.panda_gym.pybullet import PyBullet, error

IDENTITY = [0.0, 0.0, 0.0, 1.0]
DOWN = [1.0, 0.0, 0.0, 0.0]
NEUTRAL = (0.0, 0.41, 0.0, -1.85, 0.0, 2.26, 0.79, 0.0, 0.0)


@pytest.fixture
def sim() -> Iterator[PyBullet]:
    simulation = PyBullet()
    yield simulation
    simulation.close()


@pytest.fixture
def panda(sim: PyBullet) -> PyBullet:
    sim.loadURDF(
        body_name="panda",
        fileName="franka_panda/panda.urdf",
        basePosition=[0.0, 0.0, 0.0],
        useFixedBase=True,
    )
    return sim


def box(sim: PyBullet, name: str = "my_box", **kwargs: Any) -> None:
    settings = {"half_extents": [0.5, 0.5, 0.5], "mass": 1.0, "position": [0.0, 0.0, 0.0], **kwargs}
    sim.create_box(body_name=name, **settings)


def test_a_step_takes_forty_milliseconds(sim: PyBullet) -> None:
    assert sim.dt == pytest.approx(0.04)
    assert (sim.timestep, sim.n_substeps) == (0.002, 20)
    sim.step()
    assert sim.world.time == pytest.approx(0.04)
    assert PyBullet(n_substeps=5).dt == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("arguments", "mode", "version_2"),
    [
        ({}, "rgb_array", False),
        ({"render_mode": "human"}, "human", False),
        ({"render_mode": "rgb_array", "renderer": "OpenGL"}, "rgb_array", False),
        ({"render_mode": "human", "renderer": "whatever"}, "human", False),
        ({"render": True}, "human", True),
        ({"render": False}, "rgb_array", True),
    ],
)
def test_both_versions_are_constructed(arguments: dict[str, Any], mode: str, version_2: bool) -> None:
    sim = PyBullet(**arguments)
    assert (sim.render_mode, sim.is_version_2) == (mode, version_2)
    np.testing.assert_allclose(sim.background_color, np.array([223, 54, 45]) / 255, atol=1e-6)
    assert PyBullet(True).render_mode == "human"


@pytest.mark.parametrize("arguments", [{"render_mode": "ansi"}, {"renderer": "Blender"}])
def test_unknown_ways_to_render_are_refused(arguments: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="expected one of"):
        PyBullet(**arguments)


def test_closing_twice_is_fine_and_ends_everything(sim: PyBullet) -> None:
    box(sim)
    sim.close()
    sim.close()
    for ask in (sim.step, sim.save_state, lambda: sim.get_base_position("my_box"), lambda: box(sim, "other")):
        with pytest.raises(error, match="closed"):
            ask()


def test_bodies_are_created_by_position_and_from_lists(sim: PyBullet) -> None:
    sim.create_box("my_box", [0.5, 0.5, 0.5], 1.0, [0.0, 0.0, 0.0], [0.5, 0.5, 0.5, 1.0], [0.0, 0.0, 0.0], False)
    sim.create_cylinder("my_cylinder", 0.5, 1.0, 1.0, [2.0, 0.0, 0.0], [0.5, 0.5, 0.5, 1.0], None, False, 0.3, 0.1)
    sim.create_sphere("my_sphere", 0.5, 1.0, [0.0, 2.0, 0.0], rgba_color=[0.5, 0.5, 0.5, 1.0])
    sim.create_plane(z_offset=-1.0)
    sim.create_table(length=0.5, width=0.5, height=0.5, x_offset=4.0)
    assert sim._bodies_idx == {"my_box": 0, "my_cylinder": 1, "my_sphere": 2, "plane": 3, "table": 4}
    np.testing.assert_allclose(sim.get_base_position("plane"), [0, 0, -1.01])
    np.testing.assert_allclose(sim.get_base_position("table"), [4, 0, -0.25])
    sim.step()
    np.testing.assert_allclose(sim.get_base_velocity("plane"), 0)


def test_a_box_falls_through_the_air_as_bullet_has_it(sim: PyBullet) -> None:
    box(sim)
    np.testing.assert_allclose(sim.get_base_position("my_box"), 0, atol=1e-7)
    sim.step()
    speed = 0.0  # explicit steps of -g - v (0.04 + 0.04 |v|)
    for _ in range(20):
        speed += 0.002 * (9.81 - speed * (0.04 + 0.04 * speed))
    # 0.392026 in PyBullet
    np.testing.assert_allclose(sim.get_base_velocity("my_box"), [0, 0, -speed], atol=1e-9)
    assert speed == pytest.approx(0.392026, abs=2e-6)
    np.testing.assert_allclose(sim.get_base_orientation("my_box"), IDENTITY, atol=1e-12)
    np.testing.assert_allclose(sim.get_base_rotation("my_box"), 0, atol=1e-12)
    np.testing.assert_allclose(sim.get_base_rotation("my_box", "quaternion"), IDENTITY, atol=1e-12)
    np.testing.assert_allclose(sim.get_base_angular_velocity("my_box"), 0, atol=1e-12)
    with pytest.raises(ValueError, match="euler"):
        sim.get_base_rotation("my_box", "matrix")


def test_a_ball_of_changed_mass_falls_as_fast(sim: PyBullet) -> None:
    sim.create_sphere("light", 0.1, 1.0, [0, 0, 0])
    sim.create_sphere("heavy", 0.1, 1.0, [1, 0, 0])
    sim.world.set_mass("heavy", 7.0)
    sim.step()
    np.testing.assert_allclose(sim.get_base_velocity("heavy"), sim.get_base_velocity("light"), rtol=1e-12)


def test_what_turns_is_slowed_by_the_air(sim: PyBullet) -> None:
    sim.create_sphere("ball", 0.1, 2.0, [0, 0, 0])
    sim.world.set_body_velocity("ball", [0, 0, 10.0])
    sim.step()
    turning = 10.0
    for _ in range(20):
        turning -= 0.002 * turning * (0.04 + 0.04 * turning)
    np.testing.assert_allclose(sim.get_base_angular_velocity("ball"), [0, 0, turning], atol=1e-9)


@pytest.mark.parametrize("create", ["box", "cylinder", "sphere"])
def test_inertias_are_those_of_uniform_solids(sim: PyBullet, create: str) -> None:
    expected = {
        "box": (1 / 12) * np.array([0.4**2 + 0.6**2, 0.2**2 + 0.6**2, 0.2**2 + 0.4**2]),
        "cylinder": np.array([3 * 0.1**2 + 0.5**2, 3 * 0.1**2 + 0.5**2, 6 * 0.1**2]) / 12,
        "sphere": np.full(3, 0.4 * 0.1**2),
    }[create]
    sizes = {"box": ([0.1, 0.2, 0.3],), "cylinder": (0.1, 0.5), "sphere": (0.1,)}[create]
    getattr(sim, f"create_{create}")("body", *sizes, 3.0, [0.0, 0.0, 0.0])
    link = next(link for link in sim.world.model.links if link.name == "body")
    assert link.mass == 3.0
    np.testing.assert_allclose(link.inertia, np.diag(3 * expected), rtol=1e-12)


def test_things_lie_on_the_table_and_ghosts_touch_nothing(sim: PyBullet) -> None:
    sim.create_plane(z_offset=-0.4)
    sim.create_table(1.1, 0.7, 0.4, x_offset=-0.3)
    box(sim, "cube", half_extents=np.ones(3) * 0.02, position=np.array([0.0, 0.0, 0.02]))
    box(sim, "ghost", half_extents=np.ones(3) * 0.02, position=[0.0, 0.0, 0.02], mass=0.0, ghost=True)
    box(sim, "falling_ghost", half_extents=np.ones(3) * 0.02, position=[0.1, 0.0, 0.02], ghost=True)
    for _ in range(10):
        sim.step()
    np.testing.assert_allclose(sim.get_base_position("cube"), [0, 0, 0.02], atol=2e-5)
    np.testing.assert_allclose(sim.get_base_position("ghost"), [0, 0, 0.02])
    fallen = 9.81 * 0.4**2 / 2
    np.testing.assert_allclose(sim.get_base_position("falling_ghost"), [0.1, 0, 0.02 - fallen], atol=0.02)


@pytest.mark.parametrize("slides", [False, True])
def test_frictions_multiply(sim: PyBullet, slides: bool) -> None:
    """On a table of 0.5 a cube of 0.4 holds against less than 0.2 of its weight."""
    sim.create_table(1.1, 0.7, 0.4)
    box(sim, "cube", half_extents=np.ones(3) * 0.02, position=[0.0, 0.0, 0.02], lateral_friction=0.4)
    for _ in range(100):
        sim.world.apply_force("cube", [(0.22 if slides else 0.18) * 9.81, 0, 0])
        sim.world.step()
    moved = sim.get_base_position("cube")[0]
    assert moved == pytest.approx(0.02 * 9.81 * 0.2**2 / 2, rel=0.05) if slides else abs(moved) < 1e-5


def test_bases_are_put_at_rest(sim: PyBullet) -> None:
    box(sim)
    sim.step()
    half = math.sqrt(0.5)
    sim.set_base_pose("my_box", [1.0, 1.0, 1.0], [0.0, 0.0, half, half])
    np.testing.assert_allclose(sim.get_base_position("my_box"), 1)
    np.testing.assert_allclose(sim.get_base_orientation("my_box"), [0, 0, half, half])
    np.testing.assert_allclose(sim.get_base_velocity("my_box"), 0)
    np.testing.assert_allclose(sim.get_base_rotation("my_box"), [0, 0, math.pi / 2])


@pytest.mark.parametrize(
    "angles", [(0.3, -0.7, 2.1), (0.0, 0.0, 0.0), (-3.0, 1.5, -2.0), (0.0, math.pi / 2, 0.4), (0.0, -math.pi / 2, 0.4)]
)
def test_three_numbers_are_euler_angles(sim: PyBullet, angles: tuple[float, ...]) -> None:
    box(sim)
    sim.set_base_pose("my_box", np.zeros(3), np.array(angles))
    np.testing.assert_allclose(sim.get_base_rotation("my_box"), angles, atol=1e-7)
    roll, pitch, yaw = angles
    cr, cp, cy, sr, sp, sy = (f(a) for f in (math.cos, math.sin) for a in (roll, pitch, yaw))
    third_column = [cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr]
    x, y, z, w = sim.get_base_orientation("my_box")
    np.testing.assert_allclose(
        [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], third_column, atol=1e-12
    )


def test_fixed_bodies_and_ghosts_are_put_elsewhere(sim: PyBullet) -> None:
    sim.create_table(1.0, 1.0, 0.4)
    box(sim, "ghost", mass=0.0, ghost=True)
    box(sim, "cube", half_extents=[0.02] * 3, position=[0, 0, 0.12])
    sim.set_base_pose("table", [0.0, 0.0, -0.1], IDENTITY)
    sim.set_base_pose("ghost", [1.0, 2.0, 3.0], DOWN)
    for _ in range(10):
        sim.step()
    np.testing.assert_allclose(sim.get_base_position("ghost"), [1, 2, 3])
    np.testing.assert_allclose(sim.get_base_orientation("ghost"), DOWN)
    assert sim.get_base_position("cube")[2] == pytest.approx(0.12, abs=1e-4)


def test_a_robot_may_float(sim: PyBullet) -> None:
    sim.loadURDF("free", fileName="franka_panda/panda.urdf", basePosition=[0, 0, 2.0], useFixedBase=False)
    np.testing.assert_allclose(sim.get_base_position("free"), [0, 0, 2.05])
    sim.step()
    assert sim.get_base_velocity("free")[2] == pytest.approx(-0.392, abs=2e-3)
    sim.set_base_pose("free", [0, 0, 1.0], IDENTITY)
    np.testing.assert_allclose(sim.get_base_position("free"), [0, 0, 1.0], atol=1e-12)
    np.testing.assert_allclose(sim.get_base_velocity("free"), 0, atol=1e-12)


def test_friction_may_be_set_where_nothing_is(panda: PyBullet) -> None:
    box(panda)
    panda.set_lateral_friction("my_box", 0, lateral_friction=0.5)
    panda.set_spinning_friction("my_box", 0, spinning_friction=0.5)
    panda.set_lateral_friction("my_box", -1, 0.7)
    panda.set_spinning_friction("my_box", -1, 0.01)
    panda.set_lateral_friction("panda", 11, 0.7)
    panda.set_lateral_friction("panda", 9, 0.9)
    assert panda.world.friction("my_box") == 0.7
    assert panda.world.friction("panda/panda_leftfinger") == 0.9


def test_names_must_be_known_and_new(panda: PyBullet) -> None:
    box(panda)
    with pytest.raises(KeyError):
        panda.get_base_position("nobody")
    with pytest.raises(ValueError, match="already"):
        box(panda)
    with pytest.raises(error, match="no link 12"):
        panda.get_link_position("panda", 12)
    with pytest.raises(error, match="no joint -1"):
        panda.get_joint_angle("panda", -1)
    for body, link in (("panda", -1), ("my_box", -1)):
        with pytest.raises(error, match="no joint of body"):
            panda.inverse_kinematics(body, link, [0, 0, 0], DOWN)
    with pytest.raises(error, match="2 joints, 1 target angles"):
        panda.control_joints("panda", [0, 1], [0.1], [1.0])
    with pytest.raises(error, match="no_such"):
        panda.loadURDF("other", fileName="no_such.urdf")
    with pytest.raises(TypeError, match="fixedBase"):
        panda.loadURDF("other", fileName="franka_panda/panda.urdf", fixedBase=True)
    with pytest.raises(ValueError, match="size"):
        box(panda, "flat", half_extents=[1.0, 1.0, 0.0])
    with pytest.raises(FileNotFoundError, match="plaid"):
        box(panda, "plaid", texture="plaid.png")
    with pytest.raises(ValueError, match="orientation"):
        panda.set_base_pose("my_box", [0, 0, 0], [0, 0, 0, 0])


def test_files_that_are_no_robots_are_refused(sim: PyBullet, tmp_path: Path) -> None:
    path = tmp_path / "broken.urdf"
    path.write_text("<robot><link/></robot>")
    with pytest.raises(error, match=r"broken\.urdf"):
        sim.loadURDF("robot", fileName=str(path))


def test_a_texture_is_found(sim: PyBullet, tmp_path: Path) -> None:
    box(sim, "cube", texture="colored_cube.png")
    own = tmp_path / "own.png"
    own.write_bytes(b"")
    box(sim, "other", position=[3, 0, 0], texture=str(own))
    assert sim.physics_client.bodies["other"].look.texture == own


def test_a_texture_of_ones_own_is_shown(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    sim = PyBullet(render_mode="rgb_array")
    box(sim, half_extents=[0.3] * 3, texture=str(tmp_path / "red.png"))
    picture = sim.render(60, 40)
    assert picture is not None
    red, green, blue = picture[20, 30, :3].astype(int)
    assert red > 3 * green and red > 3 * blue
    sim.close()


def test_states_are_numbered_from_the_smallest_free(sim: PyBullet) -> None:
    box(sim)
    assert [sim.save_state() for _ in range(3)] == [0, 1, 2]
    sim.remove_state(1)
    sim.remove_state(17)
    assert [sim.save_state(), sim.save_state()] == [1, 3]
    sim.remove_state(0)
    with pytest.raises(error, match="no saved state 0"):
        sim.restore_state(0)
    sim.restore_state(1)
    box(sim, "late", position=[3, 0, 0])
    with pytest.raises(error, match="before bodies were added"):
        sim.restore_state(1)


def test_a_state_brings_back_bodies_ghosts_and_motors(panda: PyBullet) -> None:
    panda.create_table(1.1, 0.7, 0.4, x_offset=0.5)
    box(panda, "cube", half_extents=[0.02] * 3, position=[0.5, 0.0, 0.3])
    box(panda, "ghost", mass=0.0, ghost=True, position=[1.0, 1.0, 1.0])
    panda.control_joints("panda", [1, 3], [0.6, -1.0], [87.0, 87.0])
    for _ in range(4):
        panda.step()
    state = panda.save_state()

    def end() -> tuple[int, list[float]]:
        for _ in range(5):
            panda.step()
        return panda.world.state_hash(), [*panda.get_base_position("ghost"), *panda.get_base_position("table")]

    first = end()
    panda.set_base_pose("ghost", [0, 0, 0], IDENTITY)
    panda.set_base_pose("table", [0, 0, -5], IDENTITY)
    panda.control_joints("panda", [1, 3], [0.0, 0.0], [5.0, 5.0])
    panda.step()
    panda.restore_state(state)
    assert end() == first


def test_what_was_before_is_forgotten(panda: PyBullet) -> None:
    """The same poses give the same bits, whatever touched, was held or driven before."""
    panda.create_table(1.1, 0.7, 0.4, x_offset=0.5)
    box(panda, "cube", half_extents=[0.02] * 3)
    arm = [0, 1, 2, 3, 4, 5, 6, 9, 10]

    def episode(targets: Any) -> int:
        panda.forget()
        panda.set_joint_angles("panda", arm, NEUTRAL)
        panda.set_base_pose("cube", [0.62, 0.0, 0.02], IDENTITY)
        for target in targets:
            panda.control_joints("panda", arm, target, [87.0] * 9)
            panda.step()
        return panda.world.state_hash()

    pressing = [(0.0, 0.9, 0.0, -1.85, 0.0, 2.26, 0.79, 0.0, 0.0)] * 10
    first = episode(pressing)
    assert panda.world.contacts()
    other = episode([(0.5, 0.9, 0.0, -1.5, 0.0, 2.26, 0.79, 0.02, 0.02)] * 7)
    assert other != first
    assert episode(pressing) == first


def test_changed_masses_outlast_what_is_forgotten(sim: PyBullet) -> None:
    box(sim)
    sim.world.set_mass("my_box", 3.0)
    sim.forget()
    assert sim.world.mass("my_box") == 3.0


def test_human_rendering_keeps_real_time() -> None:
    sim = PyBullet(render_mode="human")
    sim.place_visualizer([0, 0, 0], 1.4, 45, -30)
    assert sim.render() is None
    start = time.perf_counter()
    for _ in range(5):
        sim.step()
        sim.render()
        sim.render()
    assert 0.19 < time.perf_counter() - start < 0.5
    sim.real_time = False
    start = time.perf_counter()
    for _ in range(50):
        sim.step()
        sim.render()
    assert time.perf_counter() - start < 1.0
    sim.close()


def test_human_rendering_without_the_viewer_only_keeps_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "viser", None)
    monkeypatch.delitem(sys.modules, "manyhands.viewer.viewer", raising=False)
    monkeypatch.delitem(sys.modules, "manyhands.viewer.gate", raising=False)
    sim = PyBullet(render_mode="human")
    with pytest.warns(UserWarning, match=r"pip install viser"):
        sim.render()
    start = time.perf_counter()
    for _ in range(5):
        sim.step()
        sim.render()
    assert time.perf_counter() - start > 0.19


def test_pictures_have_the_size_that_is_asked_for(sim: PyBullet) -> None:
    picture = sim.render(84, 48, target_position=[0, 0, 0], distance=1.0, yaw=0, pitch=0, roll=0)
    assert picture is not None and picture.shape == (48, 84, 3)


def test_rendering_may_be_suspended_in_itself_and_through_errors(sim: PyBullet) -> None:
    with pytest.raises(KeyError), sim.no_rendering(), sim.no_rendering():
        sim.get_base_position("nobody")
    sim.step()


def test_the_panda_is_the_packages_own(panda: PyBullet) -> None:
    alone = mh.load_urdf(mh.asset_path("panda/panda.urdf"))[0]
    assert panda.physics_client.bodies["panda"].links == [f"panda/{link.name}" for link in alone.links[1:]]
    assert panda.physics_client.link_name("panda", 11) == "panda/panda_grasptarget"
