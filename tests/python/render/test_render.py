"""Cameras of worlds and batches, from Python."""

import math

import numpy as np
import pytest

import manyhands as mh


def table_world() -> mh.World:
    """A ball over a plane and a second one beside it, both free."""
    world = mh.World()
    world.add_plane("ground")
    world.add_sphere("ball", 0.1, position=[0, 0, 0.5])
    world.add_box("box", [0.1, 0.1, 0.1], position=[0.4, 0, 0.1])
    return world


def above(size: int = 33) -> mh.Camera:
    return mh.Camera.perspective(size, size, math.radians(40)).look_at([0, 0, 2], [0, 0, 0], up=[0, 1, 0])


def test_picture_of_a_world() -> None:
    world = table_world()
    picture = world.render(above(), normals=True)
    assert picture.colour.shape == (33, 33, 3) and picture.colour.dtype == np.uint8
    assert picture.depth.dtype == np.float32 and picture.segmentation.dtype == np.int32
    names = [link.name for link in world.model.links]
    assert names[picture.segmentation[16, 16]] == "ball"
    assert picture.depth[16, 16] == pytest.approx(1.4, abs=1e-5)
    assert picture.depth[0, 0] == pytest.approx(2.0, abs=1e-5)
    np.testing.assert_allclose(picture.normals[0, 0], [0, 0, 1], atol=1e-6)
    world.step(50)
    assert world.render(above()).depth[16, 16] == pytest.approx(1.9 - world.body_pose("ball")[0][2], abs=1e-4)


def test_points_lie_on_what_is_seen() -> None:
    world = table_world()
    picture = world.render(above(65))
    points = picture.point_cloud()
    assert points.shape == (65 * 65, 3)
    on_ball = picture.segmentation.ravel() == picture.segmentation[32, 32]
    np.testing.assert_allclose(np.linalg.norm(points[on_ball] - [0, 0, 0.5], axis=1), 0.1, atol=1e-5)
    on_ground = picture.segmentation.ravel() == picture.segmentation[0, 0]
    np.testing.assert_allclose(points[on_ground][:, 2], 0, atol=1e-5)


def test_only_what_is_wanted() -> None:
    picture = table_world().render(above(), colour=False, segmentation=False)
    assert picture.colour is None and picture.segmentation is None and picture.bodies is None
    assert picture.normals is None and picture.depth is not None
    with pytest.raises(RuntimeError, match="without depth"):
        table_world().render(above(), depth=False).point_cloud()


def test_a_robot_is_one_body_of_many_links() -> None:
    model, _ = mh.load_urdf(mh.asset_path("panda/panda.urdf"))
    camera = mh.Camera.perspective(80, 60, math.radians(50)).orbit([0.2, 0, 0.4], 1.6, 0.8, -0.3)
    picture = mh.World(model).render(camera)
    seen = set(np.unique(picture.segmentation)) - {-1}
    assert len(seen) >= 9
    assert set(np.unique(picture.bodies)) == {-1, 1}
    assert ((picture.bodies == -1) == (picture.segmentation == -1)).all()


def test_batch_is_its_worlds() -> None:
    world = table_world()
    model = world.model
    batch = mh.Batch(model, 5)
    batch.q = batch.q + np.linspace(0, 0.1, 5)[:, None] * np.eye(model.nq)[2]
    cameras = [above().look_at([0.1 * i, 0.2, 2], [0, 0, 0]) for i in range(3)]
    some = batch.render(cameras, worlds=[4, 0, 2])
    assert some.colour.shape == (3, 33, 33, 3)
    for k, i in enumerate([4, 0, 2]):
        renderer = mh.Renderer(model, 1)
        alone = renderer.render(batch.q[i].astype(np.float64), cameras[k])
        for name in ("colour", "depth", "segmentation"):
            np.testing.assert_array_equal(getattr(some, name)[k], getattr(alone, name))
    assert batch.render(above()).depth[:, 16, 16].tolist() == pytest.approx([1.4, 1.375, 1.35, 1.325, 1.3], abs=1e-5)
    with pytest.raises(KeyError, match="no world 5"):
        batch.render(above(), worlds=[5])
    with pytest.raises(ValueError, match="3 are given for 5"):
        batch.render(cameras)


def test_colours_and_looks_of_each_picture() -> None:
    model = table_world().model
    batch = mh.Batch(model, 2)
    rgba = np.ones((2, len(model.geoms), 4), np.float32)
    rgba[1, :, 1:3] = 0
    picture = batch.render(above(), rgba=rgba, look=[mh.Look(shadows=False), mh.Look(shadows=False, sun=0.2)])
    grey, red = picture.colour[:, 16, 16].astype(int)
    assert grey[0] == grey[1] == grey[2]
    assert red[0] > 3 * red[1] and red[0] < grey[0]
    np.testing.assert_array_equal(picture.depth[0], picture.depth[1])
    with pytest.raises(ValueError, match="colours"):
        batch.render(above(), rgba=rgba[:, :1])


def test_a_camera_on_a_link() -> None:
    model, _ = mh.load_urdf(mh.asset_path("panda/panda.urdf"))
    world = mh.World(model)
    world.add_plane("ground")
    wrist = mh.Camera.perspective(40, 40, math.radians(60)).look_at([0.1, 0, 0], [0.1, 0, 1], [1, 0, 0], "panda_hand")
    before = world.render(wrist).depth
    q = np.array(world.q)
    q[1] += 0.3
    world.q = q
    assert np.abs(world.render(wrist).depth - before).max() > 0.05
    with pytest.raises(KeyError, match="panda_hnad"):
        world.render(wrist.look_at([0, 0, 0], [0, 0, 1], [1, 0, 0], "panda_hnad"))


def test_marks_are_painted_over() -> None:
    world = table_world()
    mark = mh.Mark("box", [0.05, 0.05, 0.05], [0, 0, 1], rgba=(1, 0, 0, 0.5))
    plain, marked = world.render(above()), world.render(above(), marks=[mark])
    changed = (plain.colour != marked.colour).any(axis=2)
    assert changed[16, 16] and not changed[0, 0]
    np.testing.assert_array_equal(plain.depth, marked.depth)
    with pytest.raises(ValueError, match="2 sizes"):
        mh.Mark("capsule", [1.0], [0, 0, 0])


MOCAP = """
<mujoco><worldbody>
  <body name="palm" mocap="true" pos="0 0 0.1"><geom type="box" size="0.1 0.1 0.1"/>
    <body name="tip" pos="0 0 0.3"><joint axis="1 0 0"/><geom size="0.05" mass="1"/></body></body>
  <body name="other" mocap="true" pos="3 3 0"/>
</worldbody></mujoco>"""


def test_mocap_bodies_are_seen_where_they_are() -> None:
    model, _ = mh.load_mjcf_string(MOCAP)
    assert model.mocap_bodies == ["palm", "other"]
    world = mh.World(model)
    world.set_mocap("palm", [0.5, 0, 0.1])
    batch = mh.Batch(model, 2)
    batch.set_mocap("palm", [[0, 0, 0.1], [0.5, 0, 0.1]], [0, 0, 0, 1])
    there = above().look_at([0.5, 0, 2], [0.5, 0, 0], up=[0, 1, 0])
    for camera, place in ((there, 1), (above(), 0)):
        pictures = batch.render(camera).depth
        assert pictures[place, 16, 16] == pytest.approx(2 - 0.45, abs=1e-3)  # the tip, above the palm
        assert pictures[1 - place, 16, 16] > 10
        assert np.array_equal(world.render(camera).depth, pictures[1])
    mounted = mh.Camera.perspective(9, 9, 1).at([0, 0, 0.5], [1, 0, 0, 0], frame="palm")
    assert world.render(mounted).depth[4, 4] == pytest.approx(0.15, abs=1e-3)
    assert np.allclose(world.render(mounted).point_cloud().mean(axis=0)[:2], [0.5, 0], atol=1e-2)
    renderer = mh.Renderer(model, 1)
    assert np.array_equal(renderer.render(world.q, there, mocap=world.mocap).depth, world.render(there).depth)
    assert np.array_equal(renderer.render(world.q, there).depth, batch.render(there, worlds=[0]).depth[0])
    with pytest.raises(ValueError, match="mocap"):
        renderer.render(world.q, there, mocap=world.mocap[:1])
