"""Shapes and bodies that programs make, with every option, and what is told of shapes."""

import numpy as np
import pytest
from bodies import add_box, place, random_chain

from benchmarks.bullet.beside import DATA, Beside

seeds = pytest.mark.parametrize("seed", range(5))
TETRAHEDRON = [[0, 0, 0], [0.2, 0, 0], [0, 0.3, 0], [0, 0, 0.4]]
FACES = [0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2]


def tell(both: Beside, body: int) -> None:
    """All that is told of a body that a program made."""
    both.getBodyInfo(body)
    both.getBasePositionAndOrientation(body)
    both.getVisualShapeData(body)
    for link in range(-1, both.getNumJoints(body)):
        both.getDynamicsInfo(body, link, within=1e-5)
        both.getCollisionShapeData(body, link, within=1e-5)
        if link >= 0:
            both.getJointInfo(body, link)
            both.getLinkState(body, link)


@seeds
@pytest.mark.parametrize("framed", [False, True])
@pytest.mark.parametrize("kind", ["SPHERE", "BOX", "CAPSULE", "CYLINDER"])
def test_a_solid(both: Beside, rng: np.random.Generator, kind: str, framed: bool) -> None:
    r, h = rng.uniform(0.05, 0.3, 2).tolist()
    half = rng.uniform(0.05, 0.3, 3).tolist()
    sizes = {"radius": r, "height": h, "halfExtents": half}
    seen = {"radius": r, "length": h, "halfExtents": half}
    if framed:
        position, turn = place(rng, 0.2)
        sizes |= {"collisionFramePosition": position, "collisionFrameOrientation": turn}
        seen |= {"visualFramePosition": position, "visualFrameOrientation": turn}
    shape = both.createCollisionShape(getattr(both, f"GEOM_{kind}"), **sizes)
    visual = both.createVisualShape(getattr(both, f"GEOM_{kind}"), rgbaColor=rng.uniform(size=4).tolist(), **seen)
    for mass in (0, rng.uniform(0.1, 3)):
        tell(both, both.createMultiBody(mass, shape, visual, *place(rng)))
        tell(both, both.createMultiBody(mass, shape))
        tell(both, both.createMultiBody(mass, -1, visual))


@seeds
def test_meshes(both: Beside, rng: np.random.Generator) -> None:
    scale = rng.uniform(0.5, 2, 3).tolist()
    shapes = [
        both.createCollisionShape(both.GEOM_MESH, fileName="duck_vhacd.obj", meshScale=scale),
        both.createCollisionShape(both.GEOM_MESH, vertices=TETRAHEDRON, meshScale=scale),
        both.createCollisionShape(both.GEOM_MESH, fileName="cube.obj"),
    ]
    visual = both.createVisualShape(both.GEOM_MESH, fileName="duck.obj", meshScale=scale)
    for shape in shapes:
        body = both.createMultiBody(rng.uniform(0.5, 2), shape, visual, *place(rng))
        both.getDynamicsInfo(body, -1, within=1e-4)
        both.getVisualShapeData(body)


def test_ground(both: Beside) -> None:
    plane = both.createCollisionShape(both.GEOM_PLANE, planeNormal=[0, 0, 1])
    mesh = both.createCollisionShape(both.GEOM_MESH, vertices=TETRAHEDRON, indices=FACES)
    file = both.createCollisionShape(both.GEOM_MESH, fileName="cube.obj", flags=both.GEOM_FORCE_CONCAVE_TRIMESH)
    heights = [0.1 * ((i * 7) % 5) for i in range(16)]
    field = both.createCollisionShape(
        both.GEOM_HEIGHTFIELD,
        meshScale=[0.5, 0.5, 1],
        heightfieldTextureScaling=3,
        heightfieldData=heights,
        numHeightfieldRows=4,
        numHeightfieldColumns=4,
    )
    for i, shape in enumerate((plane, mesh, file, field)):
        both.createMultiBody(0, shape, -1, [10 * i, 0, 0])
        both.getDynamicsInfo(i, -1, view=lambda info: info[:11])
    for x in (10.03, 20.1):
        both.rayTest([x, 0.05, 3], [x, 0.05, -3], within=1e-4)


@seeds
def test_what_is_only_seen(both: Beside, rng: np.random.Generator) -> None:
    plane = both.createVisualShape(both.GEOM_PLANE, planeNormal=[0, 0, 1], specularColor=[0.1, 0.1, 0.1])
    triangles = both.createVisualShape(
        both.GEOM_MESH,
        vertices=TETRAHEDRON,
        indices=FACES,
        normals=TETRAHEDRON,
        uvs=[[0, 0], [1, 0], [0, 1], [1, 1]],
        meshScale=rng.uniform(0.5, 2, 3).tolist(),
    )
    missing = both.createVisualShape(both.GEOM_MESH, fileName="missing.obj")
    for shape in (plane, triangles, missing):
        both.createMultiBody(1, baseVisualShapeIndex=shape)
    both.getNumBodies()


@seeds
def test_several_shapes_in_one(both: Beside, rng: np.random.Generator) -> None:
    kinds = [both.GEOM_BOX, both.GEOM_SPHERE, both.GEOM_CYLINDER, both.GEOM_CAPSULE]
    lists = {
        "radii": rng.uniform(0.05, 0.2, 4).tolist(),
        "halfExtents": rng.uniform(0.05, 0.2, (4, 3)).tolist(),
        "lengths": rng.uniform(0.1, 0.3, 4).tolist(),
    }
    frames = [place(rng, 0.3) for _ in range(4)]
    positions, turns = [f[0] for f in frames], [f[1] for f in frames]
    shape = both.createCollisionShapeArray(
        kinds, **lists, collisionFramePositions=positions, collisionFrameOrientations=turns
    )
    visual = both.createVisualShapeArray(
        kinds,
        **lists,
        rgbaColors=rng.uniform(size=(4, 4)).tolist(),
        visualFramePositions=positions,
        visualFrameOrientations=turns,
    )
    body = both.createMultiBody(1, shape, visual, *place(rng))
    both.getVisualShapeData(body)
    both.getCollisionShapeData(body, -1, view=lambda shapes: shapes[0], within=1e-5)  # Bullet's others hold garbage
    both.getDynamicsInfo(body, -1, within=1e-5)


@pytest.mark.parametrize("seed", range(12))
def test_a_tree(both: Beside, rng: np.random.Generator) -> None:
    tell(both, random_chain(both, rng, int(rng.integers(1, 7)), flags=int(rng.choice([0, 8, 8 | 32]))))


def test_batches(both: Beside) -> None:
    shape = both.createCollisionShape(both.GEOM_SPHERE, radius=0.1)
    for body in both.createMultiBody(1, shape, batchPositions=[[0, 0, i] for i in range(5)]):
        both.getBasePositionAndOrientation(body)
    both.removeCollisionShape(shape)
    both.getCollisionShapeData(0, -1)
    both.createMultiBody(1, 99, 98)
    both.getCollisionShapeData(5, -1)


@pytest.mark.parametrize(
    "call",
    [
        ("createCollisionShape", 3),
        ("createCollisionShape", 5, {"fileName": "missing.obj"}),
        ("createCollisionShape", 99),
        ("createCollisionShape", "box"),
        ("createCollisionShape", 3, {"nonsense": 1}),
        ("createVisualShape", "box"),
        ("createMultiBody", {"linkMasses": [1], "linkPositions": [[0, 0, 0]]}),
        ("createMultiBody", "heavy"),
        ("getCollisionShapeData", 9, 0),
        ("getCollisionShapeData", 0, "a"),
        ("getVisualShapeData", "a"),
    ],
    ids=str,
)
def test_wrong_shapes(both: Beside, call: tuple[object, ...]) -> None:
    add_box(both, [0, 0, 1])
    options = call[-1] if isinstance(call[-1], dict) else {}
    both.refuses(*(x for x in call if not isinstance(x, dict)), **options)


def without_textures(shapes: tuple[tuple[object, ...], ...]) -> list[object]:
    """Without a window the real module tells -1 of all textures."""
    return [(*shape[:8], len(shape)) for shape in shapes]


@seeds
def test_looks(both: Beside, rng: np.random.Generator) -> None:
    body = random_chain(both, rng, 3)
    texture = both.loadTexture(f"{DATA}/checker_blue.png")
    both.changeVisualShape(body, -1, rgbaColor=rng.uniform(size=4).tolist())
    both.changeVisualShape(body, 1, shapeIndex=0, rgbaColor=[1, 0, 0, 0.5], specularColor=[0.3, 0.3, 0.3])
    both.changeVisualShape(objectUniqueId=body, linkIndex=2, textureUniqueId=texture)
    both.getVisualShapeData(body)
    both.getVisualShapeData(body, flags=both.VISUAL_SHAPE_DATA_TEXTURE_UNIQUE_IDS, view=without_textures)
    both.changeVisualShape(body, 2, textureUniqueId=-1, flags=both.VISUAL_SHAPE_DOUBLE_SIDED)
    both.changeVisualShape(99, 2, rgbaColor=[1, 0, 0, 1])
    both.changeVisualShape(body, 99, rgbaColor=[1, 0, 0, 1])
    both.resetVisualShapeData(body, 0, rgbaColor=[0, 1, 0, 1])
    both.getVisualShapeData(body, flags=both.VISUAL_SHAPE_DATA_TEXTURE_UNIQUE_IDS, view=without_textures)
    both.getVisualShapeData(99)
    both.changeTexture(texture, [255, 0, 0] * 4, 2, 2)
    both.getNumBodies()
    both.refuses("loadTexture", "missing.png")
