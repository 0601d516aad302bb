"""Grasps: they hold in physics, their qualities balance wrenches, and nothing is in the hand's way."""

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray

import manyhands as mh
from manyhands import collision, planning
from manyhands import kinematics as kin

Array = NDArray[np.float64]
GRIPPER = planning.ParallelGripper()
BOX_TRIANGLES = (
    (0, 1, 2),
    (1, 3, 2),
    (4, 6, 5),
    (5, 6, 7),
    (0, 4, 1),
    (1, 4, 5),
    (2, 3, 6),
    (3, 7, 6),
    (0, 2, 4),
    (2, 6, 4),
    (1, 5, 3),
    (3, 5, 7),
)
HEXAGON = np.array([(0.025 * np.cos(a), 0.025 * np.sin(a), z) for a in np.arange(6) * np.pi / 3 for z in (-0.04, 0.06)])


def world_with(kind: str) -> mh.World:
    """One object, "it", that floats where there is no gravity; friction as the grasps take it."""
    world = mh.World()
    world.gravity = (0, 0, 0)
    turned = [0.18257419, 0.36514837, 0.54772256, 0.73029674]
    if kind == "box":
        world.add_box("it", [0.02, 0.03, 0.06], 0.1, [0.1, 0.2, 0.3], turned)
    elif kind == "cylinder":
        world.add_cylinder("it", 0.03, 0.12, 0.1, [0.1, 0.2, 0.3], turned)
    else:
        world.add_mesh("it", HEXAGON, 0.1, [0.1, 0.2, 0.3], turned)
    return world


def poses(found: planning.Grasps) -> Array:
    return kin.matrix(found.position, found.quaternion)


@pytest.mark.parametrize("kind", ["box", "cylinder", "prism"])
def test_what_is_grasped_stays_wherever_gravity_pulls(kind: str) -> None:
    found = planning.grasps_in(world_with(kind), "it", samples=60, friction=0.5)
    assert len(found.width) > 50
    chosen = [0, 1, 2, *np.random.default_rng(0).choice(len(found.width), 4, replace=False)]
    tool = np.eye(4)
    tool[2, 3] = 0.118  # of the gripper's base
    for X_WG in poses(found.only(chosen)):
        world = world_with(kind)
        world.add(mh.robots.load("parallel"), *kin.pose(X_WG @ np.linalg.inv(tool)), name="hand")
        np.testing.assert_allclose(world.body_pose("hand/tool")[0], X_WG[:3, 3], atol=1e-6)
        world.move({"hand/jaw_joint": 0.04})
        world.step(500)
        start = world.body_pose("it")[0]
        assert {c.link_a for c in world.contacts()} | {c.link_b for c in world.contacts()} == {
            "it",
            "hand/left_jaw",
            "hand/right_jaw",
        }
        # Without weight all pressure may be at a pad's corner: the first pull turns the object until it spreads.
        world.gravity = (9.81, 0, 0)
        world.step(250)
        held = world.body_pose("it")[0]
        assert np.abs(held - start).max() < 5e-3
        for pull in (*np.eye(3), *-np.eye(3)):
            world.gravity = 9.81 * pull
            world.step(250)
        assert np.abs(world.body_pose("it")[0] - held).max() < 2e-4


def test_the_gripper_that_ships_fits_into_its_boxes() -> None:
    """Every corner of the model's shapes lies in one of the boxes, with open jaws; or at the flange."""
    model = mh.robots.load("parallel")
    world = mh.World(model)
    X_GW = np.linalg.inv(kin.matrix(*world.body_pose("tool")))
    g = GRIPPER
    jaw = np.array([[-g.width / 2, g.opening / 2, -g.depth], [g.width / 2, g.opening / 2 + g.thickness, g.reach]])
    palm = np.array([[-g.palm[0] / 2, -g.palm[1] / 2, -g.depth - g.palm[2]], [g.palm[0] / 2, g.palm[1] / 2, -g.depth]])
    other = jaw * [1, -1, 1]
    for geom in model.geoms:
        if geom.is_visual:
            continue
        half = geom.size if geom.shape == "box" else [geom.size[0], geom.size[0], geom.size[1]]
        X = (
            X_GW
            @ kin.matrix(*world.body_pose(model.links[geom.link].name))
            @ kin.matrix(geom.position, geom.quaternion)
        )
        corners = (X @ np.vstack([np.array(np.meshgrid(*([-h, h] for h in half))).reshape(3, 8), np.ones(8)]))[:3].T
        boxes = [np.sort(box, axis=0) for box in (jaw, other, palm)]
        is_flange = corners[:, 2].max() < -g.depth - g.palm[2] + 1e-3
        assert is_flange or any(((box[0] - 1e-3 < corners) & (corners < box[1] + 1e-3)).all() for box in boxes), (
            corners.min(0),
            corners.max(0),
        )


def test_quality_is_what_friction_can_balance() -> None:
    """h(w) = max over primitive wrenches of w . wrench: epsilon is its least value over unit w, so no w lies below, and
    steps downhill from random ones reach it."""
    rng = np.random.default_rng(4)
    found = planning.grasps(collision.Convex(HEXAGON), com=(0, 0, 0.01), samples=20, approaches=1, friction=0.6)
    radius = float(np.linalg.norm(HEXAGON - [0, 0, 0.01], axis=1).max())
    torsion = 0.6 * GRIPPER.width / 3
    for points, normals, quality in zip(found.points[:5], found.normals[:5], found.quality[:5], strict=True):
        options = {"friction": 0.6, "torsion": torsion, "about": (0, 0, 0.01), "length": radius}
        assert planning.epsilon_quality(points, -normals, **options) == pytest.approx(quality, abs=1e-12)
        exact = planning.epsilon_quality(points, -normals, **options, edges=16)
        assert quality <= exact * (1 + 1e-9)
        wrenches = primitive_wrenches(points - [0, 0, 0.01], -normals, 0.6, torsion, radius)
        w = rng.normal(size=(400, 6))
        w /= np.linalg.norm(w, axis=1, keepdims=True)
        for step in 0.3 * 0.97 ** np.arange(400):
            steepest = wrenches[(w @ wrenches.T).argmax(1)]
            w -= step * steepest / np.linalg.norm(steepest, axis=1, keepdims=True)
            w /= np.linalg.norm(w, axis=1, keepdims=True)
        least = (w @ wrenches.T).max(1).min()
        assert quality * 0.9 < least < exact * 1.1  # their edges lie elsewhere


def primitive_wrenches(points: Array, normals: Array, friction: float, torsion: float, length: float) -> Array:
    """(m, 6), of 64 edges and both turns of each contact."""
    rows = []
    for p, n in zip(points, normals, strict=True):
        a = np.cross(n, [1.0, 0, 0] if abs(n[0]) < 0.5 else [0, 1.0, 0])
        a /= np.linalg.norm(a)
        b = np.cross(n, a)
        for angle in np.arange(8) * np.pi / 4:
            f = n + friction * (np.cos(angle) * a + np.sin(angle) * b)
            rows.append([*f, *np.cross(p, f) / length])
        rows += [[*n, *((np.cross(p, n) + sign * torsion * n) / length)] for sign in (-1, 1)]
    return np.array(rows)


def test_grasps_of_a_shape_are_those_of_a_link_of_it() -> None:
    world = world_with("box")
    there = planning.grasps_in(world, "it", seed=3, approach=(1, 0, 0))
    X = kin.matrix(*world.body_pose("it"))
    shape = planning.grasps(collision.Box([0.02, 0.03, 0.06]), seed=3, approach=X[:3, :3].T @ [1, 0, 0])
    assert there.quality.max() == pytest.approx(shape.quality.max(), abs=1e-3)
    best = (X @ poses(shape))[0]
    assert np.abs(best[:3, 3] - there.position[0]).max() < 0.01


def test_a_table_takes_away_what_comes_from_below() -> None:
    world = mh.World()
    world.add_box("it", [0.02, 0.02, 0.02], 0.1, [0, 0, 0.02])
    world.add_plane("table")
    free, clear = planning.grasps_in(world, "it"), planning.grasps_in(world, "it", obstacles=["table"])
    assert (poses(free)[:, 2, 2] > 0.5).any()
    assert not (poses(clear)[:, 2, 2] > 0.5).any() and len(clear.width) > 20
    down = clear.only(poses(clear)[:, 2, 2] < -0.99)
    assert 0 < len(down.width) < len(clear.width)
    model = planning.grasps_in(world.model, "it", q=world.q, obstacles="table")
    np.testing.assert_array_equal(model.position, clear.position)


def test_hollow_things_are_held_by_their_wall_or_across() -> None:
    """A frame of four bars, 60 mm wide, as triangles: by one bar, or by two with nothing between."""
    bar, outside = 0.008, 0.03
    vertices, triangles = [], []
    for sign in (-1, 1):
        for half, at in (((outside, bar / 2, 0.01), (0, 1)), ((bar / 2, outside - bar, 0.01), (1, 0))):
            centre = np.array([*at, 0]) * sign * (outside - bar / 2)
            first = len(vertices)
            vertices += [centre + np.array(c) * half for c in itertools.product((-1, 1), repeat=3)]
            triangles += [[first + k for k in triangle] for triangle in BOX_TRIANGLES]
    found = planning.grasps(collision.Mesh(np.array(vertices), np.array(triangles)), samples=300)
    widths = set(found.width.round(6))
    assert {bar, 2 * outside} <= widths <= {bar, 0.02, 2 * outside}
    wall, across = (found.only(np.isclose(found.width, w, atol=1e-6)) for w in (bar, 2 * outside))
    assert np.abs(wall.position[:, :2]).max(1).min() > outside - bar
    assert across.quality.max() > wall.quality.max()


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"friction": 0.0}, "friction is 0"),
        ({"friction": np.nan}, "friction is"),
        ({"samples": 0}, "samples is 0"),
        ({"approach": (0, 0, 0)}, "approach"),
        ({"approach": (0, 0)}, "approach has shape"),
        ({"tilt": -1.0}, "tilt is -1"),
        ({"clearance": np.inf}, "clearance"),
        ({"seed": -1}, "seed is -1"),
        ({"com": (0, np.nan, 0)}, "com must be finite"),
    ],
)
def test_what_makes_no_sense_is_refused(options: dict[str, object], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        planning.grasps(collision.Sphere(0.03), **options)  # type: ignore[arg-type]


def test_a_gripper_has_lengths() -> None:
    with pytest.raises(ValueError, match="opening is -1"):
        planning.ParallelGripper(opening=-1.0)
    with pytest.raises(ValueError, match="palm's size is -1"):
        planning.ParallelGripper(palm=(1, 1, -1))


def test_links_and_shapes_that_cannot_be_held() -> None:
    world = mh.World()
    world.add_plane("table")
    with pytest.raises(ValueError, match="plane"):
        planning.grasps_in(world, "table")
    with pytest.raises(ValueError, match="plane"):
        planning.grasps(collision.Plane())
    with pytest.raises(KeyError, match="nothing"):
        planning.grasps_in(world, "nothing")
    world.add(mh.robots.load("parallel"), name="hand")
    with pytest.raises(ValueError, match="no shape"):
        planning.grasps_in(world, "hand/tool")
    assert len(planning.grasps(collision.Sphere(0.05)).width) == 0
    with pytest.raises(ValueError, match="normals"):
        planning.epsilon_quality(np.zeros((2, 3)), np.zeros((3, 3)))
    with pytest.raises(ValueError, match="torsion"):
        planning.epsilon_quality(np.zeros((2, 3)), np.ones((2, 3)), torsion=[1.0, -1.0])


def test_whatever_is_asked_the_answer_is_finite() -> None:
    rng = np.random.default_rng(0)
    for k in range(60):
        size = 10.0 ** rng.uniform(-4, 2)
        shapes = (
            collision.Box(size * rng.uniform(0.01, 1, 3)),
            collision.Convex(size * rng.normal(size=(rng.integers(4, 30), 3)) * 10.0 ** rng.uniform(-4, 0, 3)),
            collision.Mesh(size * rng.normal(size=(12, 3)), np.array([rng.permutation(12)[:3] for _ in range(20)])),
            collision.Capsule(size * rng.uniform(0.01, 1), size * rng.uniform(0.01, 5)),
        )
        gripper = planning.ParallelGripper(opening=10.0 ** rng.uniform(-2, 1))
        options = {"friction": 10.0 ** rng.uniform(-3, 1), "samples": 10, "clearance": 0.0, "seed": k}
        found = planning.grasps(shapes[k % 4], gripper, com=size * rng.normal(size=3), **options)
        assert all(np.isfinite(rows).all() for rows in found), k
        assert (found.margin >= 0).all() and (found.quality >= 0).all() and (found.width > 0).all(), k
