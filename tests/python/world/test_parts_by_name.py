"""Colours of bodies, joints moved by name, links held together."""

import math

import numpy as np
import pytest

import manyhands as mh


def arm() -> mh.World:
    return mh.World.from_file(mh.asset_path("panda/panda.urdf"))


def colour_of(world: mh.World, name: str) -> list[float]:
    return next(list(geom.rgba) for geom in world.model.geoms if geom.name == name)


def test_bodies_have_the_colour_that_they_are_given() -> None:
    world = mh.World()
    world.add_box("a", [1, 1, 1], colour=[1, 0.5, 0])
    world.add_sphere("b", 1, position=[5, 0, 0], colour=(0, 0, 1, 0.5))
    world.add_cylinder("c", 1, 1, position=[10, 0, 0], colour=[0, 1, 0])
    world.add_capsule("d", 1, 1, position=[15, 0, 0], colour=[0, 1, 1])
    world.add_mesh("e", np.eye(4, 3), position=[20, 0, 0], colour=[1, 1, 1])
    world.add_plane("f", position=[0, 0, -3], colour=[0.25, 0.25, 0.25])
    assert [colour_of(world, name) for name in "abcdef"] == [
        [1, 0.5, 0, 1], [0, 0, 1, 0.5], [0, 1, 0, 1], [0, 1, 1, 1], [1, 1, 1, 1], [0.25, 0.25, 0.25, 1]
    ]  # fmt: skip


def test_bodies_without_one_differ() -> None:
    world = mh.World()
    for k in range(6):
        world.add_box(f"{k}", [0.1, 0.1, 0.1], position=[k, 0, 0])
    assert len({tuple(colour_of(world, f"{k}")) for k in range(6)}) == 6


@pytest.mark.parametrize("colour", [[1, 0], [0, 0, 2], [0, 0, -0.1], [0, 0, math.nan], [1, 1, 1, 1, 1]])
def test_what_is_no_colour_is_refused(colour: list[float]) -> None:
    world = mh.World()
    with pytest.raises(ValueError, match="body 'a': a colour is red, green, blue"):
        world.add_box("a", [1, 1, 1], colour=colour)
    assert world.names == []


def test_joints_move_by_name() -> None:
    world = arm()
    world.gravity = [0, 0, 0]
    world.move({"panda_joint1": 0.3, "panda_joint4": -0.5})
    world.step(1000)
    q = {joint.name: world.q[joint.iq] for joint in world.model.joints if joint.nv}
    assert abs(q["panda_joint1"] - 0.3) < 1e-6
    assert abs(q["panda_joint4"] + 0.5) < 1e-6


def test_others_keep_their_motors() -> None:
    by_name, all_at_once = arm(), arm()
    forces = [joint.effort for joint in by_name.model.joints if joint.nv]
    all_at_once.set_motors(target_q=0.0, max_force=forces)
    by_name.set_motors(target_q=0.0, max_force=forces)
    by_name.move({"panda_joint2": 0.0})
    by_name.step(100)
    all_at_once.step(100)
    assert by_name.q.tobytes() == all_at_once.q.tobytes()


def test_a_move_that_is_refused_changes_nothing() -> None:
    world = arm()
    world.add_box("cube", [0.1, 0.1, 0.1], position=[1, 0, 0])
    floating = next(joint.name for joint in world.model.joints if joint.type == "floating")
    before = world.snapshot()
    with pytest.raises(KeyError, match="joint9"):
        world.move({"panda_joint1": 0.3, "panda_joint9": 0.1})
    with pytest.raises(ValueError, match="degrees of freedom"):
        world.move({"panda_joint1": 0.3, floating: 0.1})
    with pytest.raises(ValueError, match="finite"):
        world.move({"panda_joint1": math.nan})
    with pytest.raises(ValueError, match=r"'panda_joint2' is to go to 9.*, beyond its limits"):
        world.move({"panda_joint1": 0.3, "panda_joint2": 9.0})
    with pytest.raises(ValueError, match="negative"):
        world.move({"panda_joint1": 0.1}, max_force=-1)
    assert world.snapshot() == before


def test_a_joint_without_effort_asks_for_a_force() -> None:
    builder = mh.ModelBuilder("slide")
    builder.add_link("cart", mass=1, inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    builder.add_joint("rail", "prismatic", "world", "cart", axis=[1, 0, 0])
    world = mh.World(builder.build())
    with pytest.raises(ValueError, match="give max_force"):
        world.move({"rail": 0.1})
    world.move({"rail": 0.1}, max_force=100)
    world.step(500)
    assert abs(world.q[0] - 0.1) < 1e-6


def test_welded_links_move_as_one() -> None:
    world = mh.World()
    world.add_box("a", [0.1, 0.1, 0.1], mass=1, position=[0, 0, 1])
    world.add_box("b", [0.1, 0.1, 0.1], mass=3, position=[0.5, 0, 1])
    world.gravity = [0, 0, 0]
    name = world.weld("a", "b")
    world.set_body_velocity("a", [0, 0, 0], [0, 1, 0])
    world.step(500)
    (p_a, q_a), (p_b, _) = world.body_pose("a"), world.body_pose("b")
    assert abs(np.linalg.norm(p_b - p_a) - 0.5) < 1e-6
    assert abs(q_a[2]) > 0.01  # pushed off their common centre, they turn
    assert abs((p_a[1] + 3 * p_b[1]) / 4 - 0.25) < 1e-6  # the centre keeps a quarter of the speed
    world.unweld(name)
    world.set_body_velocity("b", [0, 0, 0], [0, 0, 5])
    world.step(100)
    assert np.linalg.norm(world.body_pose("b")[0] - world.body_pose("a")[0]) > 0.6


def test_a_weld_to_the_world_holds_against_gravity() -> None:
    world = mh.World()
    world.add_box("a", [0.1, 0.1, 0.1], mass=2, position=[0, 0, 1], quaternion=[0, 0, math.sin(0.2), math.cos(0.2)])
    world.weld("a")
    world.step(500)
    position, quaternion = world.body_pose("a")
    assert np.abs(position - [0, 0, 1]).max() < 1e-6
    assert abs(quaternion[2] - math.sin(0.2)) < 1e-6


def test_welds_that_cannot_be_are_refused() -> None:
    world = mh.World()
    world.add_box("a", [0.1, 0.1, 0.1])
    with pytest.raises(ValueError, match="to itself"):
        world.weld("a", "a")
    with pytest.raises(KeyError, match="nobody"):
        world.weld("a", "nobody")
    with pytest.raises(KeyError, match="no weld"):
        world.unweld("a")
    world.weld("a")
    with pytest.raises(ValueError, match="already"):
        world.weld("a")


@pytest.mark.parametrize("thing", [arm().model, arm()], ids=["model", "world"])
def test_notebooks_show_a_picture(thing: object) -> None:
    html = thing._repr_html_()  # type: ignore[attr-defined]
    assert html.startswith('<img src="data:image/png;base64,')
    assert "Panda" in html or "panda" in html


def test_what_a_notebook_shows_fills_its_picture() -> None:
    from manyhands.notebook import portrait

    world = mh.World()
    world.add_box("small", [0.01, 0.01, 0.01], position=[5, 5, 5], colour=[1, 0, 0])
    colour = portrait(world).colour.astype(int)
    red = (colour[..., 0] > 2 * colour[..., 1]).mean()
    assert 0.03 < red < 0.6


def test_a_picture_is_a_png() -> None:
    from io import BytesIO

    from PIL import Image

    world = mh.World()
    world.add_sphere("ball", 0.1)
    picture = world.render(mh.Camera.perspective(31, 17, 0.8).orbit([0, 0, 0], 1, 0.5, -0.3))
    shown = np.asarray(Image.open(BytesIO(picture._repr_png_())))  # type: ignore[attr-defined]
    assert np.array_equal(shown, picture.colour)
