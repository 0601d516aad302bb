"""Contacts of bodies at rest, distances, rays, boxes and filters."""

import numpy as np
import pytest
from bodies import add_box, place, random_chain

from benchmarks.bullet.beside import Beside

seeds = pytest.mark.parametrize("seed", range(4))


def scene(both: Beside, rng: np.random.Generator) -> list[int]:
    """A box, a ball and a can on the ground, after a second of rest."""
    both.setGravity(0, 0, -9.81)
    both.loadURDF("plane.urdf")
    shapes = [
        both.createCollisionShape(both.GEOM_BOX, halfExtents=[0.1] * 3),
        both.createCollisionShape(both.GEOM_SPHERE, radius=0.1),
        both.createCollisionShape(both.GEOM_CYLINDER, radius=0.1, height=0.2),
    ]
    turns = [[0, 0, np.sin(a), np.cos(a)] for a in rng.uniform(-1, 1, 3)]
    bodies = [
        both.createMultiBody(rng.uniform(0.5, 2), shape, -1, [0.5 * i, 0, 0.11], turns[i])
        for i, shape in enumerate(shapes)
    ]
    both.step(240)
    return bodies


def weight(contacts: tuple[tuple[object, ...], ...]) -> float:
    return float(sum(contact[9] for contact in contacts))


def touching(contacts: tuple[tuple[object, ...], ...]) -> set[object]:
    """Which links touch, in either order: that is Bullet's algorithms' own."""
    return {frozenset([(c[1], c[3]), (c[2], c[4])]) for c in contacts}


def outline(contacts: tuple[tuple[object, ...], ...]) -> list[object]:
    """Flags, bodies, links, the normal's height and the distance; whichever points were chosen."""
    return sorted({(*c[:5], round(c[7][2], 2), round(c[8], 2) + 0.0) for c in contacts})


@seeds
def test_things_at_rest(both: Beside, rng: np.random.Generator) -> None:
    for body in scene(both, rng):
        both.getBasePositionAndOrientation(body, within=2e-3)
        both.getContactPoints(body, view=weight, within=2e-3)
        both.getContactPoints(bodyA=body, view=outline)
        both.getContactPoints(bodyB=body, view=touching)
        both.getContactPoints(body, 0, linkIndexA=-1, linkIndexB=-1, view=outline)
        both.getContactPoints(body, linkIndexA=0)
    both.getContactPoints(view=touching)
    both.getContactPoints(99)


@seeds
def test_a_contact_has_all_its_entries(both: Beside, rng: np.random.Generator) -> None:
    """Of the ball, which touches in one point."""
    ball = scene(both, rng)[1]
    both.getContactPoints(ball, 0, within=5e-3)


def slide(contacts: tuple[tuple[object, ...], ...]) -> list[float]:
    """The friction of all contacts together."""
    return np.sum([np.multiply(c[10], c[11]) + np.multiply(c[12], c[13]) for c in contacts], axis=0).tolist()


@seeds
def test_a_thing_slides_as_far(both: Beside, rng: np.random.Generator) -> None:
    """Along its edges: askew, small differences of where it touches turn it."""
    box = scene(both, rng)[0]
    both.resetBasePositionAndOrientation(box, [0, -1, 0.1], [0, 0, 0, 1])
    both.step(60)
    along = [[1, 0, 0], [-1, 0, 0], [0, -1, 0]][rng.integers(3)]
    both.resetBaseVelocity(box, [rng.uniform(1, 2) * x for x in along])
    both.step(30)
    both.getContactPoints(box, 0, view=slide, within=0.3)
    both.step(30)
    both.getBasePositionAndOrientation(box, view=lambda X: X[0], within=1e-2)
    both.getBaseVelocity(box, view=lambda V: V[0], within=5e-2)


@seeds
def test_friction_of_bodies_counts(both: Beside, rng: np.random.Generator) -> None:
    box = scene(both, rng)[0]
    both.changeDynamics(box, -1, lateralFriction=rng.uniform(0.2, 1))
    both.changeDynamics(0, -1, lateralFriction=rng.uniform(0.4, 1))
    both.resetBaseVelocity(box, [0, 2, 0])
    both.step(60)
    both.getBasePositionAndOrientation(box, view=lambda X: X[0], within=3e-2)


def pairs(contacts: tuple[tuple[object, ...], ...]) -> set[object]:
    return {c[1:5] for c in contacts}


@seeds
def test_collisions_without_a_step(both: Beside, rng: np.random.Generator) -> None:
    a, b = add_box(both, [0, 0, 0]), add_box(both, [0.15, 0.02, 0.03])
    both.performCollisionDetection()
    both.getContactPoints(a, b, view=pairs)
    both.resetBasePositionAndOrientation(b, [1, 0, 0], [0, 0, 0, 1])
    both.performCollisionDetection()
    both.getContactPoints(a, b, view=pairs)


@seeds
def test_filters(both: Beside, rng: np.random.Generator) -> None:
    bodies = [add_box(both, [0.15 * i, 0, 0]) for i in range(4)]
    for _ in range(6):
        a, b = (int(x) for x in rng.choice(4, 2, replace=False))
        both.setCollisionFilterPair(a, b, -1, -1, enableCollision=int(rng.integers(2)))
        both.performCollisionDetection()
        both.getContactPoints(view=lambda c: {tuple(sorted(one[1:3])) for one in c})
    both.setCollisionFilterGroupMask(bodies[1], -1, collisionFilterGroup=0, collisionFilterMask=0)
    both.performCollisionDetection()
    both.getContactPoints(bodies[1], view=lambda c: {one[1:3] for one in c if 0 in one[1:3]})
    both.setPhysicsEngineParameter(collisionFilterMode=0)
    both.setCollisionFilterGroupMask(bodies[2], -1, 4, 1)
    both.performCollisionDetection()
    both.getNumBodies()


@seeds
def test_rays(both: Beside, rng: np.random.Generator) -> None:
    """Well within bodies: hulls that have a margin and hulls that have none end at other places."""
    scene(both, rng)
    middles = np.array([[0.5 * (i % 4), 0, 0.1] for i in range(40)])  # of the bodies, and beside them
    starts = middles + rng.uniform([-0.2, -0.2, 0.6], [0.2, 0.2, 1], (40, 3))
    ends = 2 * (middles + rng.uniform(-0.04, 0.04, (40, 3))) - starts
    for start, end in zip(starts[:20], ends[:20], strict=True):
        both.rayTest(start.tolist(), end.tolist(), within=2e-2)
        both.rayTest(rayFromPosition=start, rayToPosition=end, collisionFilterMask=2, within=2e-2)
    both.rayTestBatch(starts.tolist(), ends.tolist(), within=2e-2)
    both.rayTestBatch(rayFromPositions=starts, rayToPositions=ends, numThreads=0, fractionEpsilon=0, within=2e-2)
    both.rayTestBatch(starts.tolist(), ends.tolist(), collisionFilterMask=1, within=2e-2)
    both.rayTest([0, 0, 5], [0, 0, 4])


@seeds
def test_rays_of_a_parent(both: Beside, rng: np.random.Generator) -> None:
    arm = both.loadURDF("kuka_iiwa/model.urdf", *place(rng), useFixedBase=True)
    add_box(both, [0, 0, 3], half=2.0, mass=0)
    starts, ends = rng.uniform(-0.1, 0.1, (8, 3)), rng.uniform([-4, -4, -1], [4, 4, 7], (8, 3))
    for link in (-1, 3):
        both.rayTestBatch(
            starts.tolist(),
            ends.tolist(),
            parentObjectUniqueId=arm,
            parentLinkIndex=link,
            collisionFilterMask=-1,
            view=lambda hits: [(hit[0] == 1) for hit in hits],
        )


@seeds
def test_rays_pass_through(both: Beside, rng: np.random.Generator) -> None:
    """The real module's order of hits is that of its tree: all hits are compared."""
    ball = both.createCollisionShape(both.GEOM_SPHERE, radius=0.1)
    for x in rng.permutation(4).tolist():
        both.createMultiBody(1, ball, -1, [x + 1, 0, 0])
    ray = ([[0, 0.02, 0]], [[8, 0.02, 0]])
    found = [[], []]
    for number in range(5):
        for hits, batch in zip(
            found, both.on_each(lambda m, n=number: m.rayTestBatch(*ray, reportHitNumber=n)), strict=True
        ):
            hits.append((round(batch[0][2], 4), batch[0][0]))
        both.rayTestBatch(*ray, reportHitNumber=number, view=len)
        both.rayTest(ray[0][0], ray[1][0], reportHitNumber=number, view=len)
    assert sorted(found[0]) == sorted(found[1])


@seeds
def test_distances(both: Beside, rng: np.random.Generator) -> None:
    a, b = random_chain(both, rng, 2), random_chain(both, rng, 2)
    both.resetBasePositionAndOrientation(b, [3, 0.5, 0.2], place(rng)[1])
    links = [(i, k) for i in range(-1, 2) for k in range(-1, 2)]
    for i, k in links:
        both.getClosestPoints(a, b, 5, linkIndexA=i, linkIndexB=k, within=5e-3, view=gaps)
    both.getClosestPoints(bodyA=a, bodyB=b, distance=10, within=5e-3, view=lambda c: sorted(gaps(c)))
    both.getClosestPoints(a, b, 0.01)
    both.getClosestPoints(a, 99, 1)
    both.getClosestPoints(a, b, -1)


def gaps(contacts: tuple[tuple[object, ...], ...]) -> list[object]:
    return [(*c[:5], c[8]) for c in contacts]


@seeds
def test_distances_of_balls(both: Beside, rng: np.random.Generator) -> None:
    """Every entry, where the nearest points are the only ones."""
    ball = both.createCollisionShape(both.GEOM_SPHERE, radius=0.1)
    a, b = both.createMultiBody(1, ball, -1, place(rng)[0]), both.createMultiBody(1, ball, -1, [3, 0, 0])
    both.getClosestPoints(a, b, 6, within=1e-5)


@seeds
def test_distances_of_shapes(both: Beside, rng: np.random.Generator) -> None:
    ball = both.createCollisionShape(both.GEOM_SPHERE, radius=0.1)
    box = both.createCollisionShape(both.GEOM_BOX, halfExtents=[0.1, 0.2, 0.3])
    body = both.createMultiBody(1, ball, -1, [0, 0, 0])
    position, turn = place(rng)
    position[0] += 2
    both.getClosestPoints(
        -1, -1, 9, collisionShapeA=ball, collisionShapeB=ball, collisionShapePositionB=position, within=1e-5, view=ends
    )
    options = {"collisionShapePositionB": position, "collisionShapeOrientationB": turn}
    both.getClosestPoints(body, -1, 9, collisionShapeB=box, **options, within=5e-3, view=ends)
    both.getClosestPoints(
        -1,
        body,
        9,
        collisionShapeA=box,
        collisionShapePositionA=position,
        collisionShapeOrientationA=turn,
        within=5e-3,
        view=ends,
    )
    both.getClosestPoints(-1, -1, 0.1, collisionShapeA=ball, collisionShapeB=box, **options)


def ends(contacts: tuple[tuple[object, ...], ...]) -> list[object]:
    """All but the links, of which a shape has none."""
    return [(c[0], c[1], c[2], *c[5:9]) for c in contacts]


@seeds
def test_overlaps(both: Beside, rng: np.random.Generator) -> None:
    for _ in range(12):
        add_box(both, rng.uniform(-2, 2, 3).tolist())
    both.performCollisionDetection()
    for _ in range(10):
        low = rng.uniform(-2, 1, 3)
        high = low + rng.uniform(0.5, 2, 3)
        both.getOverlappingObjects(low.tolist(), aabbMax=high.tolist(), view=lambda found: found and set(found))
    both.getOverlappingObjects([9, 9, 9], [10, 10, 10])


@pytest.mark.parametrize(
    "call",
    [
        ("rayTest", [0, 0, 0]),
        ("rayTestBatch", [[0, 0, 0]], [[0, 0, 0], [1, 0, 0]]),
        ("getContactPoints", "a"),
        ("getClosestPoints", 0, 1),
        ("getClosestPoints", 0, 1, "near"),
        ("setCollisionFilterPair", 0, 1, -1),
        ("setCollisionFilterGroupMask", 0, -1),
        ("getOverlappingObjects", [0, 0, 0]),
    ],
    ids=str,
)
def test_wrong_questions(both: Beside, call: tuple[object, ...]) -> None:
    add_box(both, [0, 0, 1])
    both.refuses(*call)
