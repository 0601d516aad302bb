"""Distances and manifolds against Coal, and against proofs that need no other program.

What phi must be: apart, it is bounded on both sides, -h(n) <= phi <= |p_A - p_B|, by any unit vector n, here our own
normal, and by any points of the two shapes, here our own, with h(n) = s_A(n) + s_B(-n). In penetration phi is the
largest of all -h(n): our normal proves it from below; nothing proves it from above, but whoever finds a larger -h(n)
proves us wrong. Coal's normals are such attempts, and no one of them may succeed. Coal's own depths are not minimal in
up to a tenth of the overlaps in which a cylinder takes part, which our normals then prove; so agreement of the values
is asked of nearly all pairs, and the proof of every one.

5,000 pairs of every combination; MANYHANDS_COAL_PAIRS=100000 for more.
"""

import os
from itertools import combinations_with_replacement

import numpy as np
import pytest
from coal_pairs import Array, Hulls, Pairs, random_pairs

from manyhands import collision

COUNT = int(os.environ.get("MANYHANDS_COAL_PAIRS", "5000"))
PIECE = 5000
MANIFOLDS = 400  # of each piece: they are asked for one by one
SOLIDS = ["sphere", "capsule", "cylinder", "box", "convex"]
COMBINATIONS = [*combinations_with_replacement(SOLIDS, 2), *((solid, "plane") for solid in SOLIDS)]

# Relative to the sizes of both shapes, whose centres are within 1 m or so of the origin.
ROUNDING = 1e-8  # flat faces: a polytope ends at one of them
CURVED = 1e-6  # the normal of an iteration on a curved surface; phi, an extremum, has its square
AGREEMENT = 1e-6
BOX_FACE_BIAS = 2e-4  # of the thinnest half extent: a face is preferred to crossed edges that are hardly shallower
FLOAT = 1e-5  # 2^-24, for each of some dozens of roundings


def pieces(type_a: str, type_b: str) -> list[Pairs]:
    rng = np.random.default_rng(COMBINATIONS.index((type_a, type_b)))
    hulls = Hulls(rng)
    return [random_pairs(rng, type_a, type_b, min(PIECE, COUNT - i), hulls) for i in range(0, COUNT, PIECE)]


def our_distances(pairs: Pairs) -> collision.Distance:
    a, b = pairs.a, pairs.b
    shapes_a, shapes_b = ([side.ours(i) for i in range(len(side.p))] for side in (a, b))
    return collision.signed_distance(shapes_a, (a.p, a.quaternion), shapes_b, (b.p, b.quaternion))


def require_below(what: str, values: Array, limit: Array | float, pairs: Pairs) -> None:
    """values <= limit for each pair; else says which one fails the most, so that it can be made again."""
    excess = np.where(np.isnan(values), np.inf, values - limit)
    i = int(np.argmax(excess))
    assert excess[i] <= 0, f"{what}: {values[i]:.3e} in\n{pairs.describe(i)}"


@pytest.mark.parametrize(("type_a", "type_b"), COMBINATIONS)
def test_distances_prove_themselves_and_agree_with_coal(type_a: str, type_b: str) -> None:
    curved = type_b != "plane" and "cylinder" in (type_a, type_b)
    agreeing, total, overlapping = 0, 0, 0
    for pairs in pieces(type_a, type_b):
        ours = our_distances(pairs)
        phi, size = ours.phi, pairs.scale() + 1e-3
        tolerance = (CURVED if curved else ROUNDING) * size
        require_below("normal not of length 1", np.abs(np.linalg.norm(ours.normal, axis=1) - 1), 1e-12, pairs)
        gap = np.linalg.norm(ours.point_a + phi[:, None] * ours.normal - ours.point_b, axis=1)
        require_below("points not along the normal", gap, 1e-12, pairs)
        # A point of a depth is off by the angle of its normal, which for curved shapes is the root of what phi is off.
        reach = np.where(phi < 0, np.sqrt(tolerance * size) if curved else tolerance, tolerance)
        require_below("point_a outside a", pairs.a.outside(ours.point_a), reach, pairs)
        require_below("point_b outside b", pairs.b.outside(ours.point_b), reach, pairs)
        require_below("not what its normal proves", np.abs(phi - pairs.lower_bound(ours.normal)), tolerance, pairs)

        theirs, normal = pairs.coal_distances()
        length = np.linalg.norm(normal, axis=1)
        sound = np.isfinite(theirs) & (np.abs(length - 1) < 1e-6)
        n = np.where(sound[:, None], normal / np.where(sound, length, 1)[:, None], ours.normal)
        require_below("refuted by Coal's normal", pairs.lower_bound(n) - phi, ROUNDING * size, pairs)
        agreeing += np.count_nonzero(sound & (np.abs(theirs - phi) <= AGREEMENT * size))
        overlapping += np.count_nonzero(phi < 0)
        total += len(phi)
    assert overlapping > 0.15 * total
    # Coal sinks a few cylinders deeper than need be, and stops early at a few capsules that are nearly parallel.
    assert agreeing >= (0.95 if "cylinder" in (type_a, type_b) else 0.999) * total


@pytest.mark.parametrize(("type_a", "type_b"), COMBINATIONS)
def test_manifolds_are_sound_and_as_deep_as_the_shapes(type_a: str, type_b: str) -> None:
    margin = 0.001
    touching = 0
    for pairs in pieces(type_a, type_b):
        phi, a, b = our_distances(pairs).phi, pairs.a, pairs.b
        thinnest = np.minimum(a.size.min(axis=1), b.size.min(axis=1))
        bias = BOX_FACE_BIAS * thinnest if type_a == type_b == "box" else np.zeros_like(phi)
        for i in range(min(MANIFOLDS, len(phi))):
            where = pairs.describe(i)
            size = pairs.scale()[i] + 1e-3
            pose_a, pose_b = (a.p[i], a.quaternion[i]), (b.p[i], b.quaternion[i])
            found = collision.contact_points(a.ours(i), pose_a, b.ours(i), pose_b, margin)
            mirror = collision.contact_points(b.ours(i), pose_b, a.ours(i), pose_a, margin)
            single = collision.contact_points(a.ours(i), pose_a, b.ours(i), pose_b, margin, dtype=np.float32)
            if abs(phi[i] - margin) < FLOAT * size + bias[i]:
                continue
            if phi[i] > margin:
                assert len(found.points) == len(mirror.points) == len(single.points) == 0, where
                continue
            touching += 1
            assert 1 <= len(found.points) <= 4, where
            n = found.normal[0]
            assert (found.normal == n).all() and abs(np.linalg.norm(n) - 1) < 1e-12, where
            tolerance = CURVED * size + bias[i]
            assert abs(found.distances.min() - phi[i]) <= tolerance, (found, phi[i], where)
            assert abs(mirror.distances.min() - phi[i]) <= tolerance, (mirror, phi[i], where)
            assert abs(single.distances.min() - phi[i]) <= tolerance + FLOAT * (size + 1), (single, phi[i], where)
            # From a point, the surfaces are half its distance away along the normal: at the deepest one, but for others
            # of nearly its depth; elsewhere, but for the curvature beyond flat features and sides not quite square to
            # the normal.
            half = 0.5 * found.distances[:, None] * n
            off = np.maximum(a.row(i).outside(found.points - half), b.row(i).outside(found.points + half))
            assert off[found.distances.argmin()] <= 1e-3 * size, (found, where)
            assert off.max() <= 0.1 * size, (found, where)
    assert touching > 0.15 * min(MANIFOLDS, COUNT)
