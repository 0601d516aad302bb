"""Clusters, planes and boxes of points."""

import numpy as np
import pytest

from manyhands import perception

RNG = np.random.default_rng(0)


def clusters_by_definition(points: np.ndarray, reach: float, least: int) -> list[set[int]]:
    """Cores within reach of each other, with what lies within reach of them; by brute force."""
    near = np.linalg.norm(points[:, None] - points[None], axis=2) <= reach
    cores = np.flatnonzero(near.sum(1) >= least)
    groups: list[set[int]] = []
    left = set(cores.tolist())
    while left:
        front, group = [min(left)], set()
        while front:
            k = front.pop()
            group.add(k)
            left.discard(k)
            front += [j for j in np.flatnonzero(near[k]).tolist() if j in left]
        groups.append(group)
    return groups


@pytest.mark.parametrize("seed", range(20))
def test_clusters_are_those_of_the_definition(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = np.concatenate(
        [rng.normal(c, 0.05, (40, 3)) for c in rng.uniform(-1, 1, (4, 3))] + [rng.uniform(-1, 1, (30, 3))]
    )
    labels = perception.dbscan(points, 0.12, 4)
    groups = clusters_by_definition(points, 0.12, 4)
    near = np.linalg.norm(points[:, None] - points[None], axis=2) <= 0.12
    assert labels.max() + 1 == len(groups)
    for number, group in enumerate(sorted(groups, key=lambda g: labels[min(g)])):
        assert {labels[k] for k in group} == {number}
        assert all(near[k][sorted(group)].any() for k in np.flatnonzero(labels == number))
    cores = set().union(*groups)
    assert all(labels[k] == -1 for k in range(len(points)) if not near[k][sorted(cores)].any())


@pytest.mark.parametrize("seed", range(20))
def test_labels_of_dense_and_regular_clouds_are_exact(seed: int) -> None:
    """By definition: clusters by their first cores, borders in the lowest; points at exactly reach, and far away."""
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 8, (200, 3)) / 8 * [1, 1, seed % 2]
    points[::7] *= 1e15
    reach, least = 0.125 * (1 + seed % 3), 1 + seed % 11
    near = np.linalg.norm(points[:, None] - points[None], axis=2) <= reach
    expected = np.full(len(points), -1)
    for number, group in enumerate(clusters_by_definition(points, reach, least)):
        expected[near[sorted(group)].any(0) & (expected == -1)] = number
    np.testing.assert_array_equal(perception.dbscan(points, reach, least), expected)


def test_many_points_in_one_place_are_one_cluster_at_once() -> None:
    points = np.random.default_rng(0).uniform(0, 1e-4, (200_000, 3))  # 4e10 pairs
    assert not perception.dbscan(points, 0.01).any()


def test_points_that_are_nowhere_are_noise() -> None:
    points = np.zeros((5, 3))
    points[2] = np.nan
    points[3] = np.inf
    assert perception.dbscan(points, 0.1, 3).tolist() == [0, 0, -1, -1, 0]
    assert perception.dbscan(np.zeros((0, 3)), 0.1).tolist() == []
    for reach, least in ((0.0, 3), (np.nan, 3), (1.0, 0)):
        with pytest.raises(ValueError, match="expected"):
            perception.dbscan(points, reach, least)
    with pytest.raises(ValueError, match="shape"):
        perception.dbscan(np.zeros((5, 2)), 1)


def test_a_table_is_found_and_taken_away() -> None:
    normal = np.array([0.1, -0.2, 1.0]) / np.linalg.norm([0.1, -0.2, 1.0])
    flat = RNG.uniform(-0.5, 0.5, (2000, 3))
    table = flat - np.outer(flat @ normal - 0.4, normal) + RNG.normal(0, 0.002, (2000, 1)) * normal
    thing = RNG.uniform(-0.05, 0.05, (500, 3)) + normal * 0.55
    points = np.concatenate([table, thing, np.full((10, 3), np.nan)])
    plane = perception.find_plane(points, 0.01)
    assert plane is not None
    np.testing.assert_allclose(plane.normal, normal, atol=2e-3)
    assert plane.offset == pytest.approx(0.4, abs=1e-3)
    assert plane.inliers[:2000].mean() > 0.99 and not plane.inliers[2000:].any()
    again = perception.find_plane(points, 0.01)
    assert again is not None and again.offset == plane.offset, "the same seed, the same plane"
    assert perception.find_plane(points[:2]) is None
    assert perception.find_plane(RNG.uniform(-1, 1, (1000, 3)), 1e-4) is None


@pytest.mark.parametrize("upright", [True, False])
def test_a_box_gets_its_box(upright: bool) -> None:
    half, angle, centre = np.array([0.2, 0.1, 0.05]), 0.7, np.array([1.0, -2.0, 0.5])
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    corners = np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T * half
    points = np.concatenate([corners, RNG.uniform(-1, 1, (500, 3)) * half]) @ R.T + centre
    box = perception.oriented_box(points if upright else points[:8], upright=upright)
    np.testing.assert_allclose(box.position, centre, atol=1e-9)
    np.testing.assert_allclose(box.half_extents, half, atol=1e-9)
    turn = 2 * np.arctan2(box.quaternion[2], box.quaternion[3])
    assert np.sin(turn - angle) == pytest.approx(0, abs=1e-9)
    with pytest.raises(ValueError, match="finite"):
        perception.oriented_box(np.full((3, 3), np.nan))
    one = perception.oriented_box([[1, 2, 3]], upright=upright)
    np.testing.assert_allclose(one.position, [1, 2, 3])


def test_nearest_and_colours() -> None:
    index, distance = perception.nearest([[0, 0, 0], [1, 0, 0], [np.nan] * 3], [[0.9, 0, 0], [-1, 0, 0]])
    assert index.tolist() == [1, 0] and distance == pytest.approx([0.1, 1.0])
    assert perception.nearest(np.zeros((0, 3)), [[0, 0, 0]])[0].tolist() == [-1]
    picture = np.zeros((2, 2, 3), np.uint8)
    picture[0, 0], picture[0, 1], picture[1, 0] = (200, 20, 20), (90, 10, 8), (20, 200, 20)
    np.testing.assert_array_equal(perception.by_colour(picture, [1, 0.1, 0.1]), [[True, True], [False, False]])
