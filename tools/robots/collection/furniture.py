"""What arms work at and reach into. Fronts face -x, towards an arm at the origin; all stand on z = 0."""

from __future__ import annotations

from robots.bullet_data.common import box
from robots.collection.common import Entry, Part, link, robot
from robots.description import ZERO, Cylinder, Joint, Link, Vec3


def _wood(x: float, y: float, z: float, at: Vec3, colour: str = "oak") -> Part:
    return Part(box(x, y, z, at), "wood", colour)


def _still(name: str, about: str, parts: list[Part]) -> Entry:
    return Entry(robot(name, [link("base", parts)], []), "furniture", about)


def table() -> Entry:
    legs = [Part(box(0.05, 0.05, 0.72, (x, y, 0.36)), "profile", "slate") for x in (-0.36, 0.36) for y in (-0.56, 0.56)]
    return _still("table", "table of 1.2 m by 0.8 m, 0.75 m high", [_wood(0.8, 1.2, 0.03, (0, 0, 0.735)), *legs])


def shelf() -> Entry:
    sides = [_wood(0.30, 0.02, 1.2, (0, y, 0.6), "walnut") for y in (-0.41, 0.41)]
    boards = [_wood(0.30, 0.80, 0.02, (0, 0, z)) for z in (0.01, 0.40, 0.79, 1.19)]
    return _still(
        "shelf",
        "shelf of three boxes, 0.8 m wide and 1.2 m high",
        [*sides, *boards, _wood(0.01, 0.84, 1.2, (0.155, 0, 0.6))],
    )


def bin_() -> Entry:
    floor = Part(box(0.40, 0.30, 0.006, (0, 0, 0.003)), "plastic", "blue")
    ends = [Part(box(0.006, 0.30, 0.20, (x, 0, 0.106)), "plastic", "blue") for x in (-0.197, 0.197)]
    sides = [Part(box(0.388, 0.006, 0.20, (0, y, 0.106)), "plastic", "blue") for y in (-0.147, 0.147)]
    return _still("bin", "open box of 400 mm by 300 mm by 206 mm", [floor, *ends, *sides])


def cage() -> Entry:
    """Bars along the edges of a box, and upright ones between, but for the front."""
    deep, wide, high, radius = 0.5, 0.6, 0.6, 0.012

    def bar(axis: str, low: float, high: float, centre: Vec3) -> Part:
        return Part(Cylinder(axis, low, high, radius, centre), "aluminium", "metal")

    x, y = deep / 2, wide / 2
    corners = [bar("z", 0.0, high, (sx * x, sy * y, 0)) for sx in (-1, 1) for sy in (-1, 1)]
    rims = [bar("x", -x, x, (0, s * y, z)) for s in (-1, 1) for z in (radius, high)]
    rims += [bar("y", -y, y, (s * x, 0, z)) for s in (-1, 1) for z in (radius, high)]
    sides = [bar("z", 0.0, high, (k * deep / 4, s * y, 0)) for s in (-1, 1) for k in (-1, 0, 1)]
    back = [bar("z", 0.0, high, (x, k * wide / 5, 0)) for k in (-1.5, -0.5, 0.5, 1.5)]
    return _still(
        "cage",
        "cage of bars, open in front and above: 0.5 m deep, 0.6 m wide and high",
        [*corners, *rims, *sides, *back],
    )


def drawer_cabinet() -> Entry:
    """Three drawers between walls; each slides out by 0.3 m."""
    deep, wide, wall, front = 0.40, 0.46, 0.018, 0.22
    count, high = 3, 0.66
    body = [_wood(deep, wall, high, (0, s * (wide - wall) / 2, high / 2)) for s in (-1, 1)]
    body += [_wood(deep, wide - 2 * wall, wall, (0, 0, z)) for z in (wall / 2, high - wall / 2)]
    body.append(_wood(wall, wide - 2 * wall, high - 2 * wall, ((deep - wall) / 2, 0, high / 2)))
    inner, pitch = wide - 2 * wall - 0.008, (high - 2 * wall) / count
    drawer_high = pitch - 0.03
    drawer = [
        _wood(deep - 0.05, inner, 0.008, (0.0, 0, 0.004)),
        *(_wood(deep - 0.05, 0.010, drawer_high, (0, s * (inner - 0.010) / 2, drawer_high / 2)) for s in (-1, 1)),
        *(_wood(0.010, inner - 0.02, drawer_high, (s * (deep - 0.06) / 2, 0, drawer_high / 2)) for s in (-1, 1)),
        _wood(0.016, wide - 0.006, pitch - 0.006, (-front + 0.003, 0, drawer_high / 2), "walnut"),
        Part(Cylinder("y", -0.06, 0.06, 0.006, (-front - 0.035, 0, drawer_high / 2)), "aluminium", "metal"),
        *(
            Part(Cylinder("x", -front - 0.035, -front, 0.005, (0, s * 0.05, drawer_high / 2)), "aluminium", "metal")
            for s in (-1, 1)
        ),
    ]
    links: list[Link] = [link("base", body)]
    joints: list[Joint] = []
    home = {}
    for k in range(count):
        links.append(link(f"drawer{k + 1}", drawer))
        at: Vec3 = (-0.012, 0, round(wall + k * pitch + 0.015, 6))
        joints.append(
            Joint(
                f"drawer{k + 1}_joint",
                "prismatic",
                "base",
                f"drawer{k + 1}",
                at,
                ZERO,
                (-1, 0, 0),
                (0.0, 0.30, 40.0, 1.0),
                friction=1.0,
            )
        )
        home[f"drawer{k + 1}_joint"] = 0.0
    return Entry(
        robot("drawer_cabinet", links, joints), "furniture", "cabinet of three drawers with handles, 0.66 m high", home
    )


def entries() -> list[Entry]:
    return [table(), shelf(), bin_(), cage(), drawer_cabinet()]
