"""Visual shapes of every link of the six-axis arm, in its link frame: light tubes between barrels with teal caps.

Links lie side by side along their joint axes: a graphite core of the parent fills the gap between two barrels, so that
no joint angle opens it.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from robots.description import ZERO, Parts, Vec3
from robots.mesh import Mesh, band, disc, from_field, join, prism
from robots.sdf import Field, box, cone, cut, cylinder, plate, quadrant, union

CELL = 0.0080  # spacing of the surface nets
FLAT = 0.0004  # ends are cut this far beyond their faces


def _cap(axis: str, sign: float, face: float, radius: float, at: Vec3 = ZERO) -> tuple[Mesh, Mesh]:
    """Graphite disc let into a barrel's end at height `face`, and the teal plate on it."""

    def low_high(inner: float, outer: float) -> tuple[float, float]:
        low, high = sorted((sign * (face + inner), sign * (face + outer)))
        return low, high

    rim = band(axis, *low_high(-0.014, 0.0012), radius - 0.019, radius - 0.011, at)
    return rim, disc(axis, *low_high(-0.014, 0.0022), radius - 0.0185, 0.0012, at)


def _faced(body: Field, *faces: tuple[str, float]) -> Field:
    """`body` cut off flat at its end faces, beyond which blending may have pushed it ("-y": the lower end of y)."""
    sides = []
    for axis, face in faces:
        height = face - FLAT if axis[0] == "-" else face + FLAT
        sides.append(quadrant(axis, height, axis, height))
    return cut(body, *sides, blend=0.003)


def _core(axis: str, middle: float, radius: float, at: Vec3 = ZERO) -> Mesh:
    """What is seen in the gap between two barrels of this radius."""
    return disc(axis, middle - 0.016, middle + 0.016, radius - 0.005, 0.003, at)


def base() -> Parts:
    """A round foot with four bolts, the plug of the cable behind, and the column of the first joint."""
    foot = cylinder("z", 0.0008, 0.022, 0.092, 0.007)
    column = cylinder("z", 0.0008, 0.0895, 0.064, 0.010)
    plug = box((-0.086, -0.024, 0.010), (0.0, 0.024, 0.058), 0.010)
    shell = from_field(union(foot, column, plug, blend=0.030), (-0.1, -0.1, -0.01), (0.1, 0.1, 0.1), CELL)
    spots = [(0.0775 * math.cos(a), 0.0775 * math.sin(a), 0.0) for a in (math.radians(45 + 90 * k) for k in range(4))]
    bolts = [disc("z", 0.016, 0.0255, 0.0068, 0.0015, at, 16) for at in spots]
    socket = disc("x", -0.0885, -0.080, 0.015, 0.0015, (0.0, 0.0, 0.034))
    ring = band("z", 0.0895, 0.0925, 0.050, 0.0605, ZERO)
    return {"shell": shell, "graphite": join([_core("z", 0.092, 0.062), socket, *bolts]), "accent": ring}


def link1() -> Parts:
    """The shoulder: a short column under a barrel across."""
    column = cylinder("z", -0.0675, 0.0, 0.062, 0.010)
    barrel = cylinder("y", -0.067, 0.062, 0.062, 0.014)
    body = _faced(union(column, barrel, blend=0.022), ("y", 0.062), ("-y", -0.067), ("-z", -0.0675))
    shell = from_field(body, (-0.07, -0.075, -0.075), (0.07, 0.07, 0.07), CELL)
    rim, plate_ = _cap("y", 1.0, 0.062, 0.062)
    return {"shell": shell, "graphite": join([rim, _core("y", -0.069, 0.060)]), "accent": plate_}


def _limb(
    near: tuple[float, float, float], far: tuple[float, float, float], tube: tuple[float, float, float], length: float
) -> Mesh:
    """Two barrels about z, each (low, high, radius), at x = 0 and x = -length, and a tube (height, radii) between."""
    first = cylinder("z", *near, 0.014)
    second = cylinder("z", *far, 0.013, (-length, 0.0, 0.0))
    z, wide, slim = tube
    limb = cone((-0.02, 0.0, z), (0.02 - length, 0.0, z), wide, slim)
    low = (-length - far[2] - 0.01, -near[2] - 0.01, min(near[0], far[0], z - wide) - 0.01)
    high = (near[2] + 0.01, near[2] + 0.01, max(near[1], far[1], z + wide) + 0.01)
    body = union(first, limb, second, blend=0.026)
    # As `_faced`, each barrel in its half.
    ends = [quadrant("-z", near[0] - FLAT, "x", -length / 2), quadrant("z", near[1] + FLAT, "x", -length / 2)]
    ends += [quadrant("-z", far[0] - FLAT, "-x", -length / 2), quadrant("z", far[1] + FLAT, "-x", -length / 2)]
    return from_field(cut(body, *ends, blend=0.003), low, high, CELL)


def _seam(x: float, z: float, radius: float) -> Mesh:
    """Thin graphite line around a tube."""
    return band("x", x - 0.0016, x + 0.0016, radius - 0.008, radius + 0.0004, (0.0, 0.0, z))


def link2() -> Parts:
    """The upper arm, beside shoulder and elbow."""
    elbow = (-0.425, 0.0, 0.0)
    shell = _limb((0.0715, 0.2, 0.060), (0.0745, 0.192, 0.054), (0.1375, 0.051, 0.045), 0.425)
    rims, plates = zip(_cap("z", 1.0, 0.2, 0.060), _cap("z", 1.0, 0.192, 0.054, elbow), strict=True)
    seams = [_seam(-0.115, 0.1375, 0.0496), _seam(-0.325, 0.1375, 0.0462)]
    graphite = join([*rims, *seams, _core("z", 0.072, 0.052, elbow)])
    return {"shell": shell, "graphite": graphite, "accent": join(list(plates))}


def link3() -> Parts:
    """The forearm, on the inner side of the upper arm."""
    wrist = (-0.3922, 0.0, 0.0)
    shell = _limb((-0.052, 0.0695, 0.052), (-0.046, 0.0715, 0.0435), (0.008, 0.043, 0.037), 0.3922)
    rims, plates = zip(_cap("z", -1.0, 0.052, 0.052), _cap("z", -1.0, 0.046, 0.0435, wrist), strict=True)
    seams = [_seam(-0.100, 0.008, 0.0417), _seam(-0.305, 0.008, 0.0382)]
    graphite = join([*rims, *seams, _core("z", 0.073, 0.0435, wrist)])
    return {"shell": shell, "graphite": graphite, "accent": join(list(plates))}


def _wrist(low: float, across: tuple[str, float]) -> Mesh:
    """A barrel about z from `low`, and half a one to y = across[1] on the side across[0] ("y" or "-y")."""
    end = across[1]
    y = (min(end, 0.0), max(end, 0.0))
    body = union(cylinder("z", low, 0.046, 0.043, 0.012), cylinder("y", *y, 0.043, 0.010), blend=0.014)
    corners = (-0.05, min(end, -0.043) - 0.01, low - 0.01), (0.05, max(end, 0.043) + 0.01, 0.055)
    return from_field(_faced(body, ("-z", low), ("z", 0.046), across), *corners, 0.0066)


def link4() -> Parts:
    """First wrist: turns about the forearm's barrel, carries the second across."""
    rim, plate_ = _cap("z", 1.0, 0.046, 0.043)
    core = _core("y", -0.057, 0.043)
    return {"shell": _wrist(-0.0585, ("-y", -0.0560)), "graphite": join([rim, core]), "accent": plate_}


def link5() -> Parts:
    """Second wrist, above the flange."""
    rim, plate_ = _cap("z", 1.0, 0.046, 0.043)
    core = _core("y", 0.0550, 0.042)
    return {"shell": _wrist(-0.0415, ("y", 0.0540)), "graphite": join([rim, core]), "accent": plate_}


def link6() -> Parts:
    """The flange."""
    ring = from_field(cylinder("z", -0.0435, -0.010, 0.040, 0.006), (-0.05, -0.05, -0.05), (0.05, 0.05, 0.0), 0.006)
    light = band("z", -0.0100, -0.0078, 0.028, 0.0370, ZERO)
    return {"shell": ring, "metal": disc("z", -0.020, 0.0, 0.0350, 0.0015, ZERO), "accent": light}


def hand() -> Parts:
    """The gripper's body, flaring from the flange to the rail of the fingers."""
    neck = cylinder("z", 0.0012, 0.040, 0.0375, 0.006)
    body = plate((-0.034, -0.076, 0.026), (0.034, 0.076, 0.072), 0.016, 0.008)
    flared = _faced(union(neck, body, blend=0.040), ("x", 0.0345), ("-x", -0.0345), ("z", 0.072), ("-z", 0.0012))
    shell = from_field(flared, (-0.05, -0.085, -0.01), (0.05, 0.085, 0.09), 0.0058)
    rail = prism([(-0.067, 0.062), (0.067, 0.062), (0.067, 0.0790), (-0.067, 0.0790)], 0.0140, 0.0015)
    badge = [disc("x", s * 0.0325 - 0.003, s * 0.0325 + 0.003, 0.011, 0.0012, (0.0, 0.0, 0.050)) for s in (-1, 1)]
    return {"graphite": shell, "metal": rail, "accent": join(badge)}


def finger() -> Parts:
    """Left finger: a carriage on the rail, a slim blade, and a pad whose face lies in the plane y = 0."""
    blade = [(0.0260, 0.0), (0.0260, 0.0170), (0.0250, 0.0200), (0.0155, 0.0400), (0.0140, 0.0580), (0.0122, 0.0600)]
    blade += [(0.0030, 0.0600), (0.0030, 0.0340), (0.0050, 0.0290), (0.0060, 0.0180), (0.0060, 0.0)]
    pad = [(0.0045, 0.0352), (0.0045, 0.0598), (0.0006, 0.0598), (0.0, 0.0592), (0.0, 0.0358), (0.0006, 0.0352)]
    return {"metal": prism(blade, 0.0104, 0.0012), "graphite": prism(pad, 0.0096, 0.0006)}


SHELLS: dict[str, Callable[[], Parts]] = {
    "link0": base,
    "link1": link1,
    "link2": link2,
    "link3": link3,
    "link4": link4,
    "link5": link5,
    "link6": link6,
    "hand": hand,
    "finger": finger,
}
