"""What stands still: grounds, tables, trays, a stadium, a court, a shelf."""

from __future__ import annotations

import math

import numpy as np

from robots.bullet_data.common import SCRIPT, Files, box, model, obj, place, solid
from robots.bullet_data.sdf_text import world_text
from robots.bullet_data.shapes import chamfered, loft
from robots.description import ZERO, Cylinder, Joint, Link, MeshFile, Placed, Plane, Robot, Shape, Vec3

CHECKS = {"white": "checker_blue.png", "frosted": "checker_blue.png"}


def _ground(name: str, link: str, shape: Shape, friction: float, look: str = "white") -> Robot:
    contact = {"lateral_friction": friction}
    return model(name, [solid(link, 0.0, [shape], looks=[(Plane(), look)], contact=contact)], textures=CHECKS)


def _sheet(half: float, repeat: float, library: str) -> bytes:
    """OBJ of a square sheet whose texture lies on it every two metres."""
    lines = [f"# Part of manyhands; written by {SCRIPT}.", f"mtllib {library}", "usemtl checks"]
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    lines += [f"v {half * x:g} {half * y:g} 0" for x, y in corners]
    lines += [f"vt {repeat * (x + 1) / 2:g} {repeat * (y + 1) / 2:g}" for x, y in corners]
    lines += ["vn 0 0 1", "f 1/1/1 2/2/1 3/3/1", "f 1/1/1 3/3/1 4/4/1"]
    return ("\n".join(lines) + "\n").encode()


def _grounds() -> Files:
    library = b"newmtl checks\nKd 1 1 1\nmap_Kd checker_blue.png\n"
    glass = b"newmtl checks\nKd 1 1 1\nd 0.7\nmap_Kd checker_blue.png\n"
    deep = box(200, 200, 10, (0, 0, -5))
    return {
        **place("plane.urdf", _ground("plane", "planeLink", deep, 1.0)),
        **place("plane100.urdf", _ground("floor", "floor", box(200, 200, 0.001), 0.5)),
        **place("plane_implicit.urdf", _ground("plane", "planeLink", Plane(), 0.9)),
        **place("plane_transparent.urdf", _ground("plane", "planeLink", box(30, 30, 10, (0, 0, -5)), 1.0, "frosted")),
        "plane.obj": _sheet(15, 15, "plane.mtl"),
        "plane100.obj": _sheet(100, 100, "plane.mtl"),
        "plane_transparent.obj": _sheet(15, 15, "plane_transparent.mtl"),
        "plane.mtl": library,
        "plane_transparent.mtl": glass,
    }


def _tables() -> Files:
    top = chamfered(1.5, 1.0, 0.05, 0.008)
    legs: list[tuple[Shape, str]] = [
        (box(0.07, 0.07, 0.575, (x, y, 0.2875)), "graphite") for x in (-0.65, 0.65) for y in (-0.4, 0.4)
    ]
    rails: list[tuple[Shape, str]] = [(box(1.25, 0.03, 0.06, (0, y, 0.545)), "graphite") for y in (-0.4, 0.4)]
    rails += [(box(0.03, 0.77, 0.06, (x, 0, 0.545)), "graphite") for x in (-0.65, 0.65)]
    wide = solid(
        "baseLink",
        0.0,
        [box(1.5, 1.0, 0.05, (0, 0, 0.6))],
        looks=[(Placed(MeshFile("top.obj"), (0, 0, 0.6)), "oak"), *legs, *rails],
        contact={"lateral_friction": 1.0},
    )
    square = chamfered(0.6, 0.6, 0.08, 0.010)
    posts: list[tuple[Shape, str]] = [
        (Cylinder("z", 0.0, 0.56, 0.025, (x, y, 0)), "metal") for x in (-0.25, 0.25) for y in (-0.25, 0.25)
    ]
    small = solid(
        "baseLink",
        0.0,
        [box(0.6, 0.6, 0.08, (0, 0, 0.6))],
        com=(0, 0, 0.6),
        looks=[(Placed(MeshFile("top.obj"), (0, 0, 0.6)), "walnut"), *posts],
    )
    joint = Joint("fixed", "fixed", "world", "baseLink", ZERO)
    stand = model("urdf_table", [Link("world"), small], [joint])
    return {
        **place("table/table.urdf", model("table.urdf", [wide])),
        "table/top.obj": obj(top),
        **place("table_square/table_square.urdf", stand),
        "table_square/top.obj": obj(square),
    }


def _trays() -> Files:
    lean, wall = 0.57547, 0.02
    walls: list[Shape] = [box(0.6, 0.6, 0.02, (0, 0, 0.005))]
    for sign in (1, -1):
        walls.append(Placed(box(wall, 0.6, 0.15), (0.25 * sign, 0, 0.059), (0, lean * sign, 0)))
        walls.append(Placed(box(0.6, wall, 0.15), (0, 0.25 * sign, 0.059), (-lean * sign, 0, 0)))
    shell = loft(
        [
            (0.205, 0.03, -0.005),
            (0.213, 0.035, 0.003),
            (0.292, 0.05, 0.119),
            (0.300, 0.05, 0.124),
            (0.300, 0.05, 0.128),
            (0.286, 0.045, 0.128),
            (0.203, 0.03, 0.018),
            (0.190, 0.03, 0.015),
        ]
    )
    looks: list[tuple[Shape, str]] = [(MeshFile("tray.obj"), "sky")]
    boxy = model("tabletop", [solid("base_link", 0.0, walls, looks=looks)])
    flat = model("tray", [solid("tray_base_link", 0.0, walls, looks=[(MeshFile("tray.obj"), "shell")])])
    return {
        **place("tray/traybox.urdf", boxy),
        **place("tray/tray.urdf", flat),
        "tray/tray.obj": obj(shell),
    }


def _oval(radius: float, half: float, height: float, steps: int = 12) -> list[Vec3]:
    """Outline of a running track: two half circles joined by straights along x."""
    points: list[Vec3] = []
    for side in (0, 1):
        for k in range(steps + 1):
            a = math.pi * (k / steps - 0.5 + side)
            points.append((half * (1 - 2 * side) + radius * math.cos(a), radius * math.sin(a), height))
    return points


def _flat(loops: list[tuple[list[Vec3], list[Vec3]]]) -> bytes:
    """OBJ of strips between pairs of outlines, or within an outline whose partner is a point."""
    lines = [f"# Part of manyhands; written by {SCRIPT}.", "vn 0 0 1"]
    count = 1
    for outer, inner in loops:
        n = len(outer)
        inner = inner if len(inner) == n else inner * n
        lines += ["v {:.4f} {:.4f} {:.4f}".format(*(c + 0.0 for c in p)) for p in [*outer, *inner]]
        for k in range(n):
            a, b = count + k, count + (k + 1) % n
            lines += [f"f {a}//1 {b}//1 {b + n}//1", f"f {a}//1 {b + n}//1 {a + n}//1"]
        count += 2 * n
    return ("\n".join(lines) + "\n").encode()


def _rectangle(x: float, y: float, height: float) -> list[Vec3]:
    return [(-x, -y, height), (x, -y, height), (x, y, height), (-x, y, height)]


def _stadium() -> Files:
    """A lawn, a track with its lanes, and the lines of a field. All sheets lie within 3 mm."""
    lanes = [(_oval(r + 0.06, 12.0, 0.003), _oval(r - 0.06, 12.0, 0.003)) for r in (8.0, 9.2, 10.4, 11.6, 12.8)]
    lines = [(_rectangle(x + 0.06, 6.06, 0.003), _rectangle(x - 0.06, 5.94, 0.003)) for x in (11.0,)]
    lines.append((_rectangle(0.06, 6.0, 0.003), [(0.0, 0.0, 0.003)]))
    lines.append((_oval(1.86, 0.0, 0.003), _oval(1.74, 0.0, 0.003)))
    parts = {
        "part0": _flat([(_rectangle(50, 50, 0.0), [(0.0, 0.0, 0.0)])]),
        "part1": _flat([(_oval(12.8, 12.0, 0.0015), _oval(8.0, 12.0, 0.0015))]),
        "part2": _flat([*lanes, *lines]),
    }
    folder = "roboschool/models_outdoor/stadium"
    colours = {"part0": "grass", "part1": "track", "part2": "white"}
    palette = {"grass": (0.43, 0.62, 0.38, 1.0), "track": (0.78, 0.44, 0.33, 1.0)}

    def sheet(name: str, link: str, part: str, collides: bool) -> Robot:
        look = (MeshFile(f"{folder}/{part}.obj"), colours[part])
        shapes: list[Shape] = [Plane()] if collides else []
        return model(name, [solid(link, 0.0, shapes, looks=[look])], colours=palette)

    first, last = f"{folder}/part0.obj", "part2.obj"
    track = sheet(f"{folder}/part1.obj", "link_d1", "part1", True)
    ends = [sheet(first, "link_d0", "part0", False), sheet(last, "link_d2", "part2", False)]
    plain = model("floor_obj", [solid("floor", 0.0, [Plane()], looks=[(Plane(), "white")])])
    bare = model(
        "floor_obj",
        [solid("floor", 0.0, [Plane()], looks=[(MeshFile(f"{folder}/part1.obj"), "track")])],
        colours=palette,
    )
    return {
        **{f"{folder}/{name}.obj": data for name, data in parts.items()},
        "stadium.sdf": world_text([ends[0], track, ends[1]], static=True),
        "stadium_no_collision.sdf": world_text([ends[0], bare, ends[1]], static=True),
        "plane_stadium.sdf": world_text([plain], static=True),
    }


def _court() -> Files:
    """A walled court with a gate and a lantern, where PyBullet has a temple."""
    stone: list[tuple[Shape, str]] = [(box(60, 60, 0.4, (0, 0, -0.2)), "stone")]
    stone += [(box(60, 0.8, 3, (0, s * 30, 1.5)), "cream") for s in (-1, 1)]
    stone += [(box(0.8, 60, 3, (-30, 0, 1.5)), "cream")]
    gate: list[tuple[Shape, str]] = [(Cylinder("z", 0.0, 7.0, 0.5, (26, s * 5, 0)), "red") for s in (-1, 1)]
    gate += [(box(0.9, 15, 0.8, (26, 0, 7.2)), "red"), (box(0.7, 11, 0.6, (26, 0, 5.6)), "red")]
    hall: list[tuple[Shape, str]] = [(box(16, 22, 1, (-16, 0, 0.5)), "stone"), (box(11, 17, 6, (-16, 0, 4)), "cream")]
    hall += [(box(17, 23, 0.8, (-16, 0, 7.4)), "slate"), (box(11, 17, 0.8, (-16, 0, 8.2)), "slate")]
    hall += [(box(5, 11, 0.8, (-16, 0, 9.0)), "slate")]
    looks = [*stone, *gate, *hall]
    return place("samurai.urdf", model("cube.urdf", [solid("baseLink", 0.0, [s for s, _ in looks], looks=looks)]))


def _shelf() -> Files:
    """A pod of shelves open to both sides, 0.9 m wide and 2.3 m high."""
    boards: list[Shape] = [box(0.88, 0.86, 0.03, (0, 0, z)) for z in (0.25, 0.62, 0.99, 1.36, 1.73, 2.10, 2.30)]
    boards += [box(0.03, 0.86, 2.29, (x, 0, 1.165)) for x in (-0.437, 0.437)]
    link = solid("pod_link", 0.0, boards, "cream", com=(0.0, 0.0, 1.2045))
    return {"kiva_shelf/model.sdf": world_text([model("Amazon Pod", [link])], static=True, at=(0.0, 1.0, 0.0))}


def _terrain() -> Files:
    """Rolling ground of 24 x 24 cells with z up, 40 m wide."""
    n = 25
    y, x = np.mgrid[0:n, 0:n] / (n - 1) * 2 - 1

    def hump(u: np.ndarray) -> np.ndarray:
        u = (u % 2.0) - 1
        return 1 - u * u

    z = 1.6 * hump(1.3 * x + 0.4) * hump(1.1 * y + 0.9) + 0.5 * hump(3.1 * x + 0.2) * hump(2.7 * y)
    lines = [f"# Part of manyhands; written by {SCRIPT}."]
    lines += [f"v {20 * a:.3f} {20 * b:.3f} {c:.3f}" for a, b, c in zip(x.ravel(), y.ravel(), z.ravel(), strict=True)]
    for r in range(n - 1):
        for c in range(n - 1):
            k = r * n + c + 1
            lines += [f"f {k} {k + 1} {k + n + 1}", f"f {k} {k + n + 1} {k + n}"]
    return {"terrain.obj": ("\n".join(lines) + "\n").encode()}


def files() -> Files:
    return {**_grounds(), **_tables(), **_trays(), **_stadium(), **_court(), **_shelf(), **_terrain()}
