"""Visual shapes of an arm of the LBR iiwa's proportions: white shells, graphite joints, orange lines.

As our Panda's: neighbouring links meet in discs about the joint axis, with a core of the parent inside.
"""

from __future__ import annotations

from robots.description import Parts, Vec3
from robots.mesh import Mesh, band, disc, from_field, join, lathe
from robots.sdf import Field, cone, cut, cylinder, plate, quadrant, union

R, ELBOW, CELL = 0.066, 0.072, 0.0138


def _ring(axis: str, at: float, radius: float, centre: Vec3 = (0.0, 0.0, 0.0)) -> Mesh:
    low, high, inner = at - 0.0018, at + 0.0018, radius - 0.010
    return lathe(axis, [(inner, low), (radius, low), (radius, high), (inner, high)], centre, 28)


def base() -> Parts:
    foot = plate((-0.136, -0.104, 0.001), (0.104, 0.104, 0.032), 0.06, 0.009)
    column = cylinder("z", 0.001, 0.150, R + 0.004, 0.017)
    socket = cone((-0.10, 0.0, 0.040), (-0.02, 0.0, 0.075), 0.034, 0.05)
    body = cut(union(foot, column, socket, blend=0.035), quadrant("-z", 0.0008, "-z", 0.0008), blend=0.006)
    shell = from_field(body, (-0.15, -0.12, -0.01), (0.12, 0.12, 0.16), CELL)
    core = disc("z", 0.140, 0.172, R - 0.006, 0.003, (0.0, 0.0, 0.0), 28)
    return {"shell": shell, "graphite": core, "accent": _ring("z", 0.1545, R - 0.002)}


def _elbow_caps(axis: str, sign: float, at: Vec3, reach: float) -> tuple[Mesh, Mesh]:
    """Core through the joint's plane and the disc at the shell's end; the orange line around the joint."""
    i = "xyz".index(axis)
    core = disc(axis, -0.012, 0.012, ELBOW - 0.007, 0.003, at, 28)
    low, high = sorted((sign * (reach - 0.012) + at[i], sign * (reach + 0.0045) + at[i]))
    cap = disc(axis, low, high, ELBOW - 0.022, 0.0015, at, 24)
    return join([core, cap]), _ring(axis, at[i], ELBOW - 0.004, at)


def riser(height: float, side: float, bottom: float = 0.006) -> Parts:
    """A tube along z that ends in the half of an elbow about y, on the side `side` of its plane."""
    at = (0.0, 0.0, height)
    tube = cylinder("z", bottom, height - 0.02, R, 0.017)
    low, high = sorted((side * 0.004, side * 0.082))
    elbow = cylinder("y", low, high, ELBOW, 0.020, at)
    lean = cone((0.0, 0.0, height - 0.10), (0.0, side * 0.014, height - 0.03), 0.060, 0.054)
    notch = quadrant("y" if side < 0 else "-y", side * 0.003, "z", height - ELBOW - 0.010)
    field = cut(union(tube, elbow, lean, blend=0.03), notch, blend=0.016)
    shell = from_field(field, (-0.09, -0.10, -0.01), (0.09, 0.10, height + 0.09), CELL)
    dark, line = _elbow_caps("y", side, at, 0.082)
    return {"shell": shell, "graphite": dark, "accent": line}


def crank(length: float, side: float, radius: float = R) -> Parts:
    """The other half of an elbow about z, at the origin on the side `side`, and a tube from it along y."""
    tube = cylinder("y", 0.02, length - 0.006, radius, 0.017)
    low, high = sorted((side * 0.004, side * 0.082))
    elbow = cylinder("z", low, high, ELBOW, 0.020)
    lean = cone((0.0, 0.10, 0.0), (0.0, 0.03, side * 0.014), 0.060, 0.054)
    notch = quadrant("z" if side < 0 else "-z", side * 0.003, "-y", ELBOW + 0.010)
    field = cut(union(tube, elbow, lean, blend=0.03), notch, blend=0.016)
    shell = from_field(field, (-0.09, -0.09, -0.10), (0.09, length + 0.01, 0.10), CELL)
    cap_low, cap_high = sorted((side * 0.070, side * 0.0865))
    cap = disc("z", cap_low, cap_high, ELBOW - 0.022, 0.0015, (0.0, 0.0, 0.0), 24)
    collar = disc("y", length - 0.016, length + 0.016, radius - 0.006, 0.003, (0.0, 0.0, 0.0), 28)
    return {"shell": shell, "graphite": join([cap, collar]), "accent": _ring("y", length, radius - 0.002)}


def forearm() -> Parts:
    """Tapers from the tube and passes the wrist on one side, as far as its axis."""
    tube = cylinder("z", 0.006, 0.09, R, 0.017)
    taper = cone((0.0, 0.0, 0.07), (0.0, 0.050, 0.165), 0.060, 0.040)
    arm = cone((0.0, 0.058, 0.155), (0.0, 0.066, 0.2155), 0.030, 0.028)
    hinge = cylinder("y", 0.056, 0.096, 0.052, 0.014, (0.0, 0.0, 0.2155))
    swing = cylinder("y", -0.3, 0.054, 0.090, 0.01, (0.0, 0.0, 0.2155))
    field: Field = cut(union(tube, taper, arm, hinge, blend=0.030), swing, blend=0.030)
    shell = from_field(field, (-0.09, -0.09, -0.01), (0.09, 0.12, 0.29), 0.013)
    at = (0.0, 0.0, 0.2155)
    core = disc("y", 0.040, 0.066, 0.046, 0.003, at, 24)
    cap = disc("y", 0.088, 0.1035, 0.032, 0.0015, at, 24)
    return {"shell": shell, "graphite": join([core, cap]), "accent": _ring("y", 0.055, 0.0485, at)}


def wrist() -> Parts:
    """The barrel about the sixth axis and the head over the flange."""
    barrel = cylinder("z", -0.053, 0.060, 0.056, 0.022)
    head = cylinder("y", -0.01, 0.050, 0.050, 0.015)
    shell = from_field(union(barrel, head, blend=0.02), (-0.08, -0.08, -0.08), (0.08, 0.08, 0.08), CELL)
    cap = disc("z", 0.052, 0.0622, 0.034, 0.0015, (0.0, 0.0, 0.0), 24)
    collar = disc("y", 0.040, 0.0605, 0.042, 0.003, (0.0, 0.0, 0.0), 24)
    return {"shell": shell, "graphite": join([cap, collar])}


def flange() -> Parts:
    plate_ = disc("z", -0.018, 0.030, 0.046, 0.008, (0.0, 0.0, 0.0), 32)
    mount = disc("z", 0.026, 0.045, 0.0315, 0.0015, (0.0, 0.0, 0.0), 24)
    return {"shell": plate_, "graphite": mount, "accent": band("z", 0.030, 0.0325, 0.033, 0.041, (0.0, 0.0, 0.0))}
