"""World.distance, near_links and ray_cast from Python; tests/physics/collision proves the numbers."""

import numpy as np
import pytest

import manyhands as mh


def table() -> mh.World:
    """A floor and two cubes of 4 cm, one 1 cm above the other."""
    world = mh.World()
    world.add_plane("floor")
    world.add_box("low", [0.02, 0.02, 0.02], 0.1, [0, 0, 0.02])
    world.add_box("high", [0.02, 0.02, 0.02], 0.1, [0, 0, 0.07])
    return world


def test_distance_names_both_sides() -> None:
    world = table()
    d = world.distance("low", "high")
    assert d is not None
    assert (d.link_a, d.link_b) == ("low", "high")
    assert d.phi == pytest.approx(0.01, abs=1e-12)
    np.testing.assert_allclose(d.normal, [0, 0, 1], atol=1e-12)
    assert d.point_a[2] == pytest.approx(0.04) and d.point_b[2] == pytest.approx(0.05)
    assert "low" in repr(d)
    assert [(n.link_a, n.link_b) for n in world.near_links(0.005)] == [("floor", "low")]
    assert len(world.near_links(0.02)) == 2
    with pytest.raises(ValueError, match="two links"):
        world.distance("low", "low")
    with pytest.raises(KeyError, match="lower"):
        world.distance("low", "lower")


def test_a_ray_and_many() -> None:
    world = table()
    hit = world.ray_cast([0, 0, 1], [0, 0, -2])
    assert hit is not None and hit.link == "high"
    assert hit.distance == pytest.approx(0.91, abs=1e-12)
    np.testing.assert_allclose(hit.point, [0, 0, 0.09], atol=1e-12)
    np.testing.assert_allclose(hit.normal, [0, 0, 1], atol=1e-12)
    assert world.ray_cast([0, 0, 1], [0, 0, -1], 0.5) is None
    origins = np.array([[0, 0, 1], [0.5, 0, 1], [0, 0.01, 1]])
    hits = world.ray_cast(origins, [0, 0, -1])
    assert hits.link == ["high", "floor", "high"]
    np.testing.assert_allclose(hits.distance, [0.91, 1, 0.91], atol=1e-12)
    np.testing.assert_allclose(
        hits.point, origins * [1, 1, 0] + np.array([[0, 0, 0.09], [0, 0, 0], [0, 0, 0.09]]), atol=1e-12
    )
    missed = world.ray_cast(origins, [0, 0, 1])
    assert missed.link == [None] * 3 and np.isinf(missed.distance).all() and np.isnan(missed.normal).all()
    assert world.ray_cast(np.zeros((0, 3)), np.zeros((0, 3))).distance.shape == (0,)


@pytest.mark.parametrize(
    ("origin", "direction", "far", "message"),
    [
        ([0, 0], [0, 0, 1], 1.0, r"origin has shape \(2,\)"),
        ([0, 0, np.nan], [0, 0, 1], 1.0, "finite"),
        ([0, 0, 0], [0, 0, 0], 1.0, "length"),
        ([0, 0, 0], [0, 0, 1], np.nan, "max_distance"),
        (np.zeros((3, 3)), np.ones((2, 3)), 1.0, "3 origins and 2 directions"),
    ],
)
def test_rays_that_are_none(origin: object, direction: object, far: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        table().ray_cast(origin, direction, far)  # type: ignore[arg-type]
