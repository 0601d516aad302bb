"""What is picked up and thrown: cubes, balls, bricks, a mug, a duck, a teddy."""

from __future__ import annotations

import itertools
import math

from robots.bullet_data.common import Files, box, model, obj, place, prop, solid
from robots.bullet_data.shapes import chamfered, ellipsoid, shifted, upright_to_y
from robots.description import Capsule, Cylinder, Joint, Link, MeshFile, Placed, Rgba, Robot, Shape, Sphere
from robots.mesh import Mesh, disc, from_field, join, lathe
from robots.sdf import cone, union

GRIP = {"lateral_friction": 1.0}
ROLLS = {"rolling_friction": 0.03, "spinning_friction": 0.03}
ROLLS_LITTLE = {"rolling_friction": 0.001, "spinning_friction": 0.001}
ZERO = (0.0, 0.0, 0.0)


def _cube(name: str, size: float, mass: float, look: str) -> Robot:
    seen = [(MeshFile("cube.obj", (size, size, size)), look)]
    return prop(name, box(size, size, size), mass, looks=seen, contact=GRIP)


def _sliding_cube() -> Robot:
    """A cube that slides along all axes and turns about y."""
    links = [Link("world")]
    links += [Link(f"{a}_prismatic", 0.01, ZERO, (6.667e-9, 6.667e-9, 6.667e-9)) for a in "xyz"]
    links.append(solid("baseLink", 0.1, [box(1, 1, 1)], looks=[(MeshFile("cube.obj"), "sky")], contact=GRIP))
    steps = [("x_to_world", "world", "x_prismatic"), ("y_to_x", "x_prismatic", "y_prismatic")]
    steps.append(("z_to_y", "y_prismatic", "z_prismatic"))
    axes = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
    joints = [
        Joint(name, "prismatic", parent, child, ZERO, axis=axis, limits=(1.0, -1.0, 0.0, 1000.0))
        for (name, parent, child), axis in zip(steps, axes, strict=True)
    ]
    turn = Joint("cube_to_z", "continuous", "z_prismatic", "baseLink", ZERO, axis=axes[1], limits=(1.0, -1.0, 0.0, 1e3))
    return model("cube", links, [*joints, turn])


def _cubes() -> Files:
    turning = solid("baseLink", 1.0, [box(1, 1, 1)], looks=[(MeshFile("cube.obj"), "yellow")], contact=GRIP)
    joint = Joint("joint_baseLink_world", "continuous", "world", "baseLink", ZERO, axis=(0.0, 0.0, 1.0))
    joint = Joint(**{**joint.__dict__, "damping": 1.0, "friction": 0.0001})
    corners: list[Shape] = [Sphere(0.1, (x, y, z)) for x in (-0.4, 0.4) for y in (-0.4, 0.4) for z in (-0.4, 0.4)]
    dice = solid("baseLink", 10.0, corners, "slate", looks=[(MeshFile("cube.obj", (0.86, 0.86, 0.86)), "cream")])
    block = prop("block_2", box(0.1, 0.018, 0.018), 0.02, "green", base="block_2_base_link")
    stone = prop(
        "cube", box(1, 1, 1), 1.0, contact=GRIP, looks=[(box(1, 1, 1), "marble")], textures={"marble": "marble.png"}
    )
    return {
        "cube.obj": obj(chamfered(1, 1, 1, 0.04)),
        **place("cube.urdf", _cube("cube", 1.0, 1.0, "sky")),
        **place("cube_small.urdf", _cube("cube.urdf", 0.05, 0.1, "accent")),
        **place("cube_collisionfilter.urdf", _cube("cube", 1.0, 1.0, "teal")),
        **place("cube_no_rotation.urdf", _sliding_cube()),
        **place("cube_rotate.urdf", model("cube", [Link("world"), turning], [joint])),
        **place("sphere8cube.urdf", model("urdf_robot", [dice])),
        **place("block.urdf", block),
        **place("marble_cube.urdf", stone),
    }


def _ball(
    radius: float, mass: float, look: str, base: str, contact: dict[str, float], colours: dict[str, Rgba]
) -> Robot:
    textures = {"white": "ball.png"} if look == "white" else {}
    return prop(
        "urdf_robot", Sphere(radius), mass, look, base=base, contact=contact, textures=textures, colours=colours
    )


def _balls() -> Files:
    red: dict[str, Rgba] = {"red": (1.0, 0.2, 0.2, 1.0)}
    ghost = model("urdf_robot", [solid("baseLink", 0.0, [], looks=[(Sphere(0.5), "red")])], colours=red)
    glass: dict[str, Rgba] = {"glass": (1.0, 0.0, 0.0, 0.5)}
    bouncing = {**ROLLS_LITTLE, "restitution": 0.5}
    white: dict[str, Rgba] = {}
    # Patches of a football: one at each corner of an icosahedron.
    golden = (1 + math.sqrt(5)) / 2
    at = [(a, b * golden, 0.0) for a in (-1, 1) for b in (-1, 1)]
    at = at + [(z, x, y) for x, y, z in at] + [(y, z, x) for x, y, z in at]
    reach = 0.1 / math.sqrt(1 + golden * golden)
    patches = [(Sphere(0.408, (x * reach, y * reach, z * reach)), "graphite") for x, y, z in at]
    football = prop("urdf_robot", Sphere(0.5), 10.0, "shell", contact=ROLLS, looks=patches)
    return {
        **place("sphere2.urdf", _ball(0.5, 10.0, "white", "baseLink", ROLLS, white)),
        **place("sphere2_rolling_friction.urdf", _ball(0.5, 10.0, "white", "baseLink", ROLLS, white)),
        **place("sphere_with_restitution.urdf", _ball(0.5, 10.0, "white", "baseLink", bouncing, white)),
        **place("sphere_small.urdf", _ball(0.03, 0.1, "accent", "base_link", ROLLS_LITTLE, white)),
        **place("sphere_1cm.urdf", _ball(0.005, 0.1, "teal", "base_link", ROLLS_LITTLE, white)),
        **place("sphere2red.urdf", _ball(0.5, 10.0, "red", "baseLink", ROLLS, red)),
        **place("sphere2red_nocol.urdf", ghost),
        **place("sphere_transparent.urdf", _ball(0.5, 10.0, "glass", "baseLink", ROLLS, glass)),
        **place("soccerball.urdf", football),
        "sphere_smooth.obj": obj(ellipsoid(ZERO, (1, 1, 1), 10, 16)),
        "textured_sphere_smooth.obj": obj(ellipsoid(ZERO, (1, 1, 1), 10, 16)),
        "soccerball.obj": obj(ellipsoid(ZERO, (0.5, 0.5, 0.5), 10, 16)),
    }


def _bricks() -> Files:
    studs = [disc("z", 0.0, 0.0028, 0.005, 0.0006, (x, y, 0.0), 14) for x in (-0.008, 0.008) for y in (-0.008, 0.008)]
    studs = [shifted(stud, 0.0085) for stud in studs]
    body = shifted(chamfered(0.0318, 0.0318, 0.0202, 0.0007), -0.0015)
    lego = prop(
        "cube.urdf",
        box(0.032, 0.032, 0.023),
        0.1,
        base="legobrick",
        looks=[(MeshFile("lego.obj"), "yellow")],
        contact=GRIP,
    )
    jenga = prop("jenga.urdf", box(0.15, 0.05, 0.03), 0.05, looks=[(MeshFile("jenga.obj"), "oak")])
    tile: list[tuple[Shape, str]] = [
        (Cylinder("x", -0.0034, 0.0034, 0.0018, (0.0, y, z)), "graphite") for y, z in _pips(0.0072)
    ]
    tile.append((box(0.0066, 0.021, 0.0008), "graphite"))
    domino = prop("cube", box(0.00635, 0.0254, 0.0508), 0.025, looks=[(MeshFile("domino.obj"), "shell"), *tile])
    return {
        "lego/lego.obj": obj(join([body, *studs]), digits=5),
        **place("lego/lego.urdf", lego),
        "jenga/jenga.obj": obj(chamfered(0.15, 0.05, 0.03, 0.002)),
        **place("jenga/jenga.urdf", jenga),
        "domino/domino.obj": obj(chamfered(0.00635, 0.0254, 0.0508, 0.001), digits=5),
        **place("domino/domino.urdf", domino),
    }


def _pips(step: float) -> list[tuple[float, float]]:
    """Five above, two below."""
    five = [(a * step, 0.0127 + b * step) for a in (-1, 1) for b in (-1, 1)] + [(0.0, 0.0127)]
    return [*five, (-step, -0.0127 - step), (step, -0.0127 + step)]


def _mug() -> Files:
    """A mug of 8.8 cm by 10.3 cm with a handle on +y: hollow, of staves and boxes."""
    outer, inner, low, high = 0.044, 0.0395, 0.0, 0.100
    profile = [(0.0, low), (0.038, low), (0.0425, 0.004), (outer, 0.010), (outer, high - 0.001)]
    profile += [(0.0425, high + 0.003), (inner, high), (inner, 0.010), (0.034, 0.006), (0.0, 0.006)]
    bowl = lathe("z", profile, ZERO, 30)
    path = [
        (0.040, 0.080),
        (0.058, 0.083),
        (0.072, 0.074),
        (0.0775, 0.055),
        (0.073, 0.036),
        (0.058, 0.024),
        (0.040, 0.022),
    ]
    limbs = [cone((0, a[0], a[1]), (0, b[0], b[1]), 0.0060, 0.0060) for a, b in itertools.pairwise(path)]
    handle = from_field(union(*limbs, blend=0.006), (-0.01, 0.03, 0.01), (0.01, 0.09, 0.095), 0.0042)
    width = 2 * 0.0418 * math.tan(math.pi / 16) + 0.002
    staves: list[Shape] = []
    for k in range(16):
        a = 2 * math.pi * k / 16
        at = (round(0.0418 * math.cos(a), 6), round(0.0418 * math.sin(a), 6), 0.05)
        staves.append(Placed(box(0.0044, round(width, 6), 0.10), at, (0.0, 0.0, round(a, 9))))
    floor = Cylinder("z", 0.0, 0.006, 0.042)
    grip: list[Shape] = [box(0.012, 0.030, 0.012, (0, 0.055, z)) for z in (0.024, 0.081)]
    grip.append(box(0.012, 0.012, 0.05, (0, 0.0765, 0.0525)))
    shapes = [floor, *staves, *grip]

    def mug(mesh: str) -> Robot:
        seen: list[tuple[Shape, str]] = [(MeshFile(mesh), "red")]
        return model("mug", [solid("base_link", 1.0, shapes, looks=seen, com=ZERO, contact=GRIP)])

    return {
        "objects/mug.obj": obj(join([bowl, handle])),
        **place("objects/mug.urdf", mug("mug.obj")),
        **place("urdf/mug.urdf", mug("../objects/mug.obj")),
    }


# The duck stands with y up, as the file that it stands in for; units are twentieths of a metre.
def _duck() -> Files:
    body = [((-0.15, 0.52, 0.0), (0.78, 0.50, 0.60)), ((-0.72, 0.78, 0.0), (0.28, 0.30, 0.30))]
    wings = [((-0.15, 0.60, s * 0.50), (0.46, 0.26, 0.16)) for s in (-1, 1)]
    head = ((0.18, 1.30, 0.0), (0.44, 0.42, 0.42))
    beak = ((0.58, 1.22, 0.0), (0.22, 0.09, 0.22))
    blobs = [_ellipsoid_field(*e) for e in (*body, *wings, head)]
    neck = cone((0.0, 0.75, 0.0), (0.16, 1.15, 0.0), 0.36, 0.32)
    whole = union(*blobs, neck, blend=0.22)
    duck = from_field(whole, (-1.1, -0.05, -0.72), (0.9, 1.8, 0.72), 0.108)
    bill = ellipsoid(beak[0], beak[1], 6, 12)
    eyes = [ellipsoid((0.46, 1.44, s * 0.29), (0.075, 0.085, 0.06), 5, 10) for s in (-1, 1)]
    k = 0.05
    scale = (k, k, k)
    looks: list[tuple[Shape, str]] = [
        (MeshFile("duck.obj", scale), "yellow"),
        (MeshFile("duck_bill.obj", scale), "accent"),
        (MeshFile("duck_eyes.obj", scale), "graphite"),
    ]
    shapes: list[Shape] = [
        Capsule("x", -0.020, 0.006, 0.0275, (0.0, 0.0275, 0.0)),
        Sphere(0.0215, (0.009, 0.065, 0.0)),
        Sphere(0.014, (-0.037, 0.038, 0.0)),
        Capsule("x", 0.026, 0.034, 0.005, (0.0, 0.061, 0.0)),
    ]
    link = solid("baseLink", 0.1, shapes, looks=looks, com=(0.0, 0.02, 0.0), contact=GRIP)
    hulls = [ellipsoid(*e, 6, 10) for e in (*body, head, beak)]
    return {
        "duck.obj": obj(join([duck, bill]), digits=3),
        "duck_bill.obj": obj(_grown(bill, 0.008), digits=3),
        "duck_eyes.obj": obj(join(eyes), digits=3),
        "duck_vhacd.obj": obj(*hulls, digits=3),
        **place("duck_vhacd.urdf", model("cube.urdf", [link])),
    }


def _grown(mesh: Mesh, by: float) -> Mesh:
    """A smooth mesh with its vertices moved outwards."""
    vertices = mesh.vertices.copy()
    vertices[mesh.faces.ravel()] += by * mesh.normals[mesh.normal_faces.ravel()]
    return Mesh(vertices, mesh.faces, mesh.normals, mesh.normal_faces)


def _ellipsoid_field(centre: tuple[float, float, float], radii: tuple[float, float, float]):
    """Distance to an ellipsoid, right near its surface."""

    def field(x, y, z):
        p = [(c - m) / r for c, m, r in zip((x, y, z), centre, radii, strict=True)]
        q = [a / r for a, r in zip(p, radii, strict=True)]
        k0 = (p[0] ** 2 + p[1] ** 2 + p[2] ** 2) ** 0.5
        k1 = (q[0] ** 2 + q[1] ** 2 + q[2] ** 2) ** 0.5
        return k0 * (k0 - 1) / (k1 + 1e-12)

    return field


def _teddy() -> Files:
    """A bear that sits, with y up and about 0.85 by 1.0 by 0.7 in the file's units, as PyBullet's."""
    fur = {
        "body": ((0.68, 0.50, 0.26), (0.22, 0.28, 0.19)),
        "head": ((0.68, 0.91, 0.30), (0.19, 0.17, 0.17)),
        "ear_left": ((0.52, 1.07, 0.28), (0.075, 0.075, 0.045)),
        "ear_right": ((0.84, 1.07, 0.28), (0.075, 0.075, 0.045)),
        "arm_left": ((0.42, 0.60, 0.34), (0.12, 0.085, 0.10)),
        "arm_right": ((0.94, 0.60, 0.34), (0.12, 0.085, 0.10)),
        "leg_left": ((0.50, 0.27, 0.42), (0.11, 0.105, 0.22)),
        "leg_right": ((0.86, 0.27, 0.42), (0.11, 0.105, 0.22)),
    }
    hulls = [ellipsoid(*e, 7, 12) for e in fur.values()]
    paws = [((x, 0.27, 0.60), (0.075, 0.075, 0.055)) for x in (0.50, 0.86)]
    details = {
        "cream": [ellipsoid((0.68, 0.86, 0.445), (0.085, 0.07, 0.065), 6, 12), *(ellipsoid(*p, 6, 12) for p in paws)],
        "graphite": [
            ellipsoid((0.68, 0.885, 0.505), (0.028, 0.022, 0.018), 5, 8),
            *(ellipsoid((0.68 + s * 0.085, 0.965, 0.44), (0.022, 0.026, 0.018), 5, 8) for s in (-1, 1)),
        ],
    }
    files: Files = {"teddy2_VHACD_CHs.obj": obj(*hulls, digits=3)}
    files |= {f"teddy_{material}.obj": obj(join(meshes), digits=3) for material, meshes in details.items()}
    for path, k in (("teddy_vhacd.urdf", 0.1), ("teddy_large.urdf", 3.0)):
        looks: list[tuple[Shape, str]] = [(MeshFile("teddy2_VHACD_CHs.obj", (k, k, k)), "fur")]
        looks += [(MeshFile(f"teddy_{material}.obj", (k, k, k)), material) for material in details]
        shapes: list[Shape] = [_capsule(centre, radii, k) for centre, radii in fur.values()]
        link = solid("baseLink", 0.1, shapes, looks=looks, com=(0.07, 0.05, 0.03))
        files |= place(path, model("cube.urdf", [link]))
    return files


def _capsule(centre: tuple[float, float, float], radii: tuple[float, float, float], scale: float) -> Shape:
    """The capsule along an ellipsoid's longest axis that is about as thick."""
    longest = max(range(3), key=lambda i: radii[i])
    others = [radii[i] for i in range(3) if i != longest]
    radius = round(scale * min(math.sqrt(others[0] * others[1]), radii[longest]), 6)
    half = round(scale * radii[longest] - radius, 6)
    x, y, z = (round(scale * c, 6) for c in centre)
    if half < 1e-6:
        return Sphere(radius, (x, y, z))
    along = (x, y, z)[longest]
    return Capsule("xyz"[longest], round(along - half, 6), round(along + half, 6), radius, (x, y, z))


def _toys() -> Files:
    """A torus, a stone, a rabbit's worth of triangles, and an open box."""
    turn = [(1.0 + 0.4 * math.cos(a), 0.4 * math.sin(a)) for a in (2 * math.pi * k / 10 for k in range(10))]
    rock = from_field(
        union(
            _ellipsoid_field((0, 0, 0), (0.5, 0.4, 0.3)), _ellipsoid_field((0.2, 0.1, 0.1), (0.3, 0.35, 0.3)), blend=0.1
        ),
        (-0.6, -0.5, -0.4),
        (0.6, 0.6, 0.5),
        0.14,
    )
    wall, size, high = 0.01, 0.20, 0.10
    walls: list[Shape] = [box(size, size, wall, (0, 0, wall / 2))]
    walls += [box(wall, size, high, (s * (size - wall) / 2, 0, high / 2)) for s in (-1, 1)]
    walls += [box(size - 2 * wall, wall, high, (0, s * (size - wall) / 2, high / 2)) for s in (-1, 1)]
    return {
        "torus/torus_textured.obj": obj(lathe("z", turn, ZERO, 24)),
        "cloth_z_up.obj": _cloth(),
        "stone.obj": obj(rock),
        "bunny.obj": obj(upright_to_y(_rabbit())),
        **place("toys/concave_box.urdf", model("concave_box", [solid("base_link", 0.2, walls, "oak")])),
    }


def _cloth(n: int = 12) -> bytes:
    """A square sheet of 2 m by 2 m in z = 0, of n x n cells."""
    lines = ["# Part of manyhands."]
    lines += [f"v {2 * c / n - 1:.4f} {2 * r / n - 1:.4f} 0" for r in range(n + 1) for c in range(n + 1)]
    for k in (r * (n + 1) + c + 1 for r in range(n) for c in range(n)):
        lines += [f"f {k} {k + 1} {k + n + 2}", f"f {k} {k + n + 2} {k + n + 1}"]
    return ("\n".join(lines) + "\n").encode()


def _rabbit() -> Mesh:
    """A sitting rabbit with z up, about 1.5 high."""
    blobs = [((0.0, 0.0, 0.42), (0.45, 0.36, 0.42)), ((0.34, 0.0, 0.86), (0.26, 0.22, 0.23))]
    blobs += [((-0.44, 0.0, 0.30), (0.12, 0.12, 0.12))]
    blobs += [((0.12, s * 0.26, 0.14), (0.30, 0.11, 0.13)) for s in (-1, 1)]
    ears = [cone((0.28, s * 0.09, 1.0), (0.14, s * 0.2, 1.42), 0.09, 0.08) for s in (-1, 1)]
    whole = union(*(_ellipsoid_field(*b) for b in blobs), *ears, blend=0.12)
    return from_field(whole, (-0.7, -0.5, -0.05), (0.7, 0.5, 1.6), 0.095)


def files() -> Files:
    return {**_cubes(), **_balls(), **_bricks(), **_mug(), **_duck(), **_teddy(), **_toys()}
