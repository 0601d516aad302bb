"""Visual shapes of every link of the Panda, in its link frame: soft white shells, graphite joints, orange lines.

Neighbouring links meet in surfaces of revolution about the joint axis, with a graphite core of the parent inside, so
that no joint angle opens a gap.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from robots.description import Parts, Vec3
from robots.mesh import Mesh, band, disc, from_field, join, prism
from robots.sdf import box, cone, cut, cylinder, plate, quadrant, union

R = 0.056  # radius of the arm's tubes and of the large elbows
CELL = 0.0082  # spacing of the surface nets


def _collar(z: float) -> Mesh:
    """Graphite core around the z axis where two tubes meet at height z."""
    return disc("z", z - 0.016, z + 0.016, R - 0.005, 0.003, (0.0, 0.0, 0.0))


def _inlay(axis: str, sign: float, face: float, radius: float, at: Vec3 = (0.0, 0.0, 0.0)) -> Mesh:
    """Graphite ring let into an end face at height `face`, standing 2 mm proud."""
    low, high = sorted((sign * (face - 0.012), sign * (face + 0.002)))
    return band(axis, low, high, radius - 0.008, radius, at, 0.0008)


def _elbow(axis: str, sign: float, radius: float, cap: float, at: Vec3 = (0.0, 0.0, 0.0)) -> tuple[Mesh, Mesh]:
    """Graphite core and end inlay, and the accent line, of an elbow on the side `sign` of its joint plane."""
    core = disc(axis, -0.012, 0.012, radius - 0.006, 0.003, at)
    line = band(axis, -0.0016, 0.0016, radius - 0.012, radius - 0.0035, at)
    return join([core, _inlay(axis, sign, cap, radius - 0.020, at)]), line


def base() -> Parts:
    """A foot with four bolts, a connector box behind, and the column of the first joint."""
    foot = plate((-0.150, -0.092, 0.001), (0.070, 0.092, 0.030), 0.045, 0.009)
    column = cylinder("z", 0.001, 0.134, R + 0.004, 0.012)
    connector = box((-0.142, -0.050, 0.008), (0.0, 0.050, 0.084), 0.022)
    body = cut(union(foot, column, connector, blend=0.035), quadrant("-z", 0.0008, "-z", 0.0008), blend=0.006)
    shell = from_field(body, (-0.16, -0.1, -0.01), (0.08, 0.1, 0.15), CELL)
    bolts = [
        disc("z", 0.026, 0.0325, 0.0075, 0.0015, (x, y, 0.0), 16) for x in (-0.122, 0.042) for y in (-0.066, 0.066)
    ]
    panel = disc("x", -0.1435, -0.135, 0.021, 0.0015, (0.0, 0.0, 0.050))
    ring = band("z", 0.1375, 0.1405, R - 0.010, R - 0.0025, (0.0, 0.0, 0.0))
    return {"shell": shell, "graphite": join([_collar(0.139), panel, *bolts]), "accent": ring}


def link1() -> Parts:
    """A tube that leans over to its half of the shoulder, cut away where link 2 swings."""
    tube = cylinder("z", -0.187, -0.02, R, 0.012)
    elbow = cylinder("y", -0.125, -0.004, R, 0.016)
    notch = quadrant("y", -0.003, "z", -0.067)
    field = cut(union(tube, elbow, blend=0.03), notch, blend=0.016)
    shell = from_field(field, (-0.06, -0.14, -0.2), (0.06, 0.06, 0.06), CELL)
    core, line = _elbow("y", -1.0, R, 0.125)
    return {"shell": shell, "graphite": core, "accent": line}


def link2() -> Parts:
    """The other half of the shoulder, and the tube up to the third joint."""
    tube = cylinder("y", -0.187, -0.02, R, 0.012)
    elbow = cylinder("z", 0.004, 0.126, R, 0.016)
    notch = quadrant("-z", 0.003, "y", -0.067)
    field = cut(union(tube, elbow, blend=0.03), notch, blend=0.016)
    shell = from_field(field, (-0.06, -0.2, -0.06), (0.06, 0.06, 0.14), CELL)
    core, _ = _elbow("z", 1.0, R, 0.126)
    collar = disc("y", -0.207, -0.175, R - 0.005, 0.003, (0.0, 0.0, 0.0))
    return {"shell": shell, "graphite": join([core, collar])}


def link3() -> Parts:
    """From the tube forward and sideways to the elbow; a well in it takes the other half."""
    axis = (0.0825, 0.0, 0.0)
    tube = cylinder("z", -0.117, -0.02, R, 0.012)
    elbow = cylinder("y", 0.004, 0.107, R, 0.016, axis)
    arm = cone((0.006, 0.006, -0.056), (0.0825, 0.052, -0.002), 0.047, 0.047)
    notch = quadrant("-y", 0.003, "z", -0.056)
    well = cylinder("y", -0.2, 0.003, R + 0.008, 0.004, axis)
    field = cut(union(tube, elbow, arm, blend=0.030), notch, well, blend=0.016)
    shell = from_field(field, (-0.07, -0.06, -0.13), (0.15, 0.12, 0.07), CELL)
    core, line = _elbow("y", 1.0, R, 0.107, axis)
    return {"shell": shell, "graphite": core, "accent": line}


def link4() -> Parts:
    """Link 3 turned over: from the elbow back to the tube that carries the forearm."""
    tube = cylinder("y", 0.02, 0.115, R, 0.012, (-0.0825, 0.0, 0.0))
    elbow = cylinder("z", 0.004, 0.107, R, 0.016)
    arm = cone((-0.0765, 0.054, 0.006), (0.0, 0.000, 0.052), 0.047, 0.047)
    notch = quadrant("-z", 0.003, "-y", 0.054)
    well = cylinder("z", -0.2, 0.003, R + 0.008, 0.004)
    field = cut(union(tube, elbow, arm, blend=0.030), notch, well, blend=0.016)
    shell = from_field(field, (-0.15, -0.07, -0.06), (0.07, 0.13, 0.12), CELL)
    core, _ = _elbow("z", 1.0, R, 0.107)
    collar = disc("y", 0.103, 0.135, R - 0.005, 0.003, (-0.0825, 0.0, 0.0))
    return {"shell": shell, "graphite": join([core, collar])}


def link5() -> Parts:
    """The forearm, which slips past the swing of link 6 on one side."""
    tube = cylinder("z", -0.261, -0.19, R, 0.012)
    forearm = cone((0.0, 0.006, -0.195), (0.0, 0.080, -0.080), 0.0485, 0.038)
    wrist = cylinder("y", 0.047, 0.127, 0.050, 0.015)
    neck = cone((0.0, 0.080, -0.080), (0.0, 0.084, 0.0), 0.038, 0.030)
    swing = cylinder("y", -0.3, 0.045, 0.150, 0.01)
    field = cut(union(tube, forearm, neck, wrist, blend=0.025), swing, blend=0.05)
    shell = from_field(field, (-0.06, -0.06, -0.28), (0.06, 0.14, 0.06), CELL)
    at = (0.0, 0.044, 0.0)
    core, line = _elbow("y", 1.0, 0.050, 0.083, at)
    return {"shell": shell, "graphite": core, "accent": line}


def link6() -> Parts:
    """Two crossing barrels: the wrist and the head above the flange."""
    wrist = cylinder("z", -0.041, 0.053, 0.050, 0.015)
    head = cylinder("y", -0.045, 0.078, 0.046, 0.015, (0.088, 0.0, 0.0))
    bridge = cone((0.0, 0.0, 0.003), (0.088, 0.014, 0.002), 0.038, 0.036)
    shell = from_field(union(wrist, head, bridge, blend=0.022), (-0.06, -0.06, -0.06), (0.15, 0.09, 0.07), CELL)
    caps = [
        _inlay("z", 1.0, 0.053, 0.030),
        _inlay("y", 1.0, 0.078, 0.027, (0.088, 0.0, 0.0)),
        disc("y", -0.066, -0.035, 0.040, 0.003, (0.088, 0.0, 0.0)),
    ]
    return {"shell": shell, "graphite": join(caps)}


def link7() -> Parts:
    """The flange, with a lobe that holds a button."""
    flange = cylinder("z", 0.053, 0.094, 0.0435, 0.010)
    lobe = cylinder("z", 0.060, 0.094, 0.034, 0.010, (0.044, 0.044, 0.0))
    shell = from_field(union(flange, lobe, blend=0.04), (-0.05, -0.05, 0.04), (0.09, 0.09, 0.1), 0.005)
    mount = disc("z", 0.088, 0.110, 0.0355, 0.0015, (0.0, 0.0, 0.0))
    button = disc("z", 0.088, 0.0965, 0.016, 0.0015, (0.046, 0.046, 0.0))
    light = band("z", 0.0968, 0.0990, 0.030, 0.0385, (0.0, 0.0, 0.0))
    return {"shell": shell, "graphite": join([mount, button]), "accent": light}


def hand() -> Parts:
    """The palm: a bevelled bar with a rail for the fingers."""
    body = box((-0.031, -0.100, 0.018), (0.031, 0.100, 0.063), 0.012)
    neck = cylinder("z", 0.0005, 0.045, 0.0365, 0.008)
    shell = from_field(union(body, neck, blend=0.030), (-0.05, -0.11, -0.01), (0.05, 0.11, 0.07), 0.0058)
    rail = prism(_rounded(-0.079, 0.040, 0.079, 0.0645, 0.006), 0.0125, 0.0015)
    ends = [disc("y", s * 0.1006 - 0.004, s * 0.1006 + 0.0004, 0.0085, 0.001, (0.0, 0.0, 0.040)) for s in (-1, 1)]
    return {"shell": shell, "graphite": rail, "accent": join(ends)}


def _rounded(y0: float, z0: float, y1: float, z1: float, radius: float) -> list[tuple[float, float]]:
    """Rectangle with rounded corners as a counter-clockwise outline."""
    centres = (
        (y1 - radius, z1 - radius),
        (y0 + radius, z1 - radius),
        (y0 + radius, z0 + radius),
        (y1 - radius, z0 + radius),
    )
    outline = []
    for quarter, (y, z) in enumerate(centres):
        for step in range(5):
            a = math.radians(90 * quarter + 22.5 * step)
            outline.append((y + radius * math.cos(a), z + radius * math.sin(a)))
    return outline


def finger() -> Parts:
    """Left finger: a carriage in the hand's rail, a slim blade, and a pad whose face lies in the plane y = 0."""
    blade = [(0.0264, 0.0), (0.0264, 0.0185), (0.0255, 0.0215), (0.0150, 0.0425), (0.0135, 0.0520), (0.0122, 0.0538)]
    blade += [(0.0030, 0.0538), (0.0030, 0.0340), (0.0050, 0.0290), (0.0060, 0.0180), (0.0060, 0.0)]
    pad = [(0.0045, 0.0352), (0.0045, 0.0536), (0.0006, 0.0536), (0.0, 0.0530), (0.0, 0.0358), (0.0006, 0.0352)]
    return {"metal": prism(blade, 0.0100, 0.0012), "graphite": prism(pad, 0.0092, 0.0006)}


SHELLS: dict[str, Callable[[], Parts]] = {
    "link0": base,
    "link1": link1,
    "link2": link2,
    "link3": link3,
    "link4": link4,
    "link5": link5,
    "link6": link6,
    "link7": link7,
    "hand": hand,
    "finger": finger,
}
