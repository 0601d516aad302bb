"""MJCF scenes: the walkers, pendulums and the reacher that learning programs start from.

Bodies hold the same joints, sizes and densities as in PyBullet's files; where those say `coordinate="global"`, bodies
here lie at the origin and their parts where they are in the world, which every reader understands alike.
"""

from __future__ import annotations

from robots.bullet_data.common import Files
from robots.bullet_data.mjcf_xml import (
    BLUE,
    ORANGE,
    SHELL,
    SLATE,
    TEAL,
    Node,
    ball,
    body,
    floor,
    hinge,
    rod,
    scene,
    slide,
)

FREE = {"armature": "0", "damping": "0", "stiffness": "0"}


def _ant() -> bytes:
    # Name of the leg, of its foot, of the geoms; signs of x and y; range of the ankle.
    legs = [
        ("front_left_leg", "front_left_foot", "left", 1, 1, "30 100", "-1 1 0"),
        ("front_right_leg", "front_right_foot", "right", -1, 1, "-100 -30", "1 1 0"),
        ("left_back_leg", "left_back_foot", "back", -1, -1, "-100 -30", "-1 1 0"),
        ("right_back_leg", "right_back_foot", "rightback", 1, -1, "30 100", "1 1 0"),
    ]
    nodes = [ball("torso_geom", "0 0 0", "0.25", SHELL)]
    for k, (leg, foot, geom, x, y, range_, axis) in enumerate(legs, 1):
        near, far = f"{0.2 * x:g} {0.2 * y:g} 0", f"{0.4 * x:g} {0.4 * y:g} 0"
        shin = body(
            foot, near, hinge(f"ankle_{k}", axis, range_), rod(f"{geom}_ankle_geom", f"0 0 0 {far}", "0.08", SLATE)
        )
        thigh = body(
            f"aux_{k}",
            near,
            hinge(f"hip_{k}", "0 0 1", "-40 40"),
            rod(f"{geom}_leg_geom", f"0 0 0 {near}", "0.08", ORANGE),
            shin,
        )
        nodes.append(body(leg, "0 0 0", rod(f"aux_{k}_geom", f"0 0 0 {near}", "0.08", SHELL), thigh))
    motors = {f"{joint}_{k}": "150" for k in (4, 1, 2, 3) for joint in ("hip", "ankle")}
    geom = {
        "conaffinity": "0",
        "condim": "3",
        "density": "5",
        "friction": "1.5 0.1 0.1",
        "margin": "0.01",
        "rgba": SHELL,
    }
    return scene(
        "ant", "degree", "0.01", {"armature": "1", "damping": "1"}, geom, [body("torso", "0 0 0.75", *nodes)], motors
    )


def _planar(z: str, names: tuple[str, str, str], height: str = "") -> list[Node]:
    """Joints of a body that moves in the plane y = 0."""
    ref = {"ref": height} if height else {}
    return [
        slide(names[0], "1 0 0", **FREE),
        slide(names[1], "0 0 1", **ref, **FREE),
        hinge(names[2], "0 1 0", "", z, **FREE),
    ]


def _cheetah() -> bytes:
    def part(
        name: str, pos: str, spring: tuple[str, str], range_: str, at: str, turn: str, half: str, *inner: Node
    ) -> Node:
        look = ORANGE if "shin" in name else SLATE if "foot" in name else SHELL
        shape = {
            "name": name,
            "type": "capsule",
            "pos": at,
            "axisangle": f"0 1 0 {turn}",
            "size": f"0.046 {half}",
            "rgba": look,
        }
        joint = hinge(name, "0 1 0", range_, stiffness=spring[0], damping=spring[1])
        if "foot" in name:
            # MuJoCo reads the mass from the geom, Bullet from here.
            shape["mass"] = "10"
            inner = (Node("inertial", {"pos": "0 0 0", "mass": "10", "diaginertia": "0.02 0.02 0.02"}), *inner)
        return body(name, pos, joint, Node("geom", shape), *inner)

    back_foot = part("bfoot", "-.28 0 -.14", ("120", "3"), "-.4 .785", ".03 0 -.097", "-.27", ".094")
    back_shin = part("bshin", ".16 0 -.25", ("180", "4.5"), "-.785 .785", "-.14 0 -.07", "-2.03", ".15", back_foot)
    back = part("bthigh", "-.5 0 0", ("240", "6"), "-.52 1.05", ".1 0 -.13", "-3.8", ".145", back_shin)
    fore_foot = part("ffoot", ".13 0 -.18", ("60", "1.5"), "-3.1 -0.3", ".045 0 -.07", "-.6", ".07")
    fore_shin = part("fshin", "-.14 0 -.24", ("120", "3"), "-1.2 1.1", ".065 0 -.09", "-.6", ".106", fore_foot)
    fore = part("fthigh", ".5 0 0", ("180", "4.5"), "-1.5 0.8", "-.07 0 -.12", ".52", ".133", fore_shin)
    head = {
        "name": "head",
        "type": "capsule",
        "pos": ".6 0 .1",
        "axisangle": "0 1 0 .87",
        "size": "0.046 .15",
        "rgba": ORANGE,
    }
    spine = rod("torso", "-.5 0 0 .5 0 0", "0.046", SHELL)
    torso = body(
        "torso", "0 0 .7", *_planar("0 0 0", ("ignorex", "ignorez", "ignorey")), spine, Node("geom", head), back, fore
    )
    motors = {"bthigh": "120", "bshin": "90", "bfoot": "60", "fthigh": "120", "fshin": "60", "ffoot": "30"}
    geom = {"conaffinity": "0", "condim": "3", "contype": "1", "friction": "0.8 .1 .1", "rgba": SHELL}
    return scene("cheetah", "radian", "0.01", {"armature": ".1", "damping": ".01"}, geom, [torso], motors)


def _leg(suffix: str, look: str, foot: str) -> Node:
    """Thigh, leg and foot of hopper and walker, upright, in the world's coordinates."""

    def part(
        name: str, joint: str, height: str, range_: str, fromto: str, radius: str, rgba: str, *inner: Node
    ) -> Node:
        turn = hinge(joint, "0 -1 0", range_, f"0 0 {height}")
        return body(f"{name}{suffix}", "0 0 0", turn, rod(f"{name}{suffix}_geom", fromto, radius, rgba), *inner)

    sole = part("foot", f"foot{suffix}_joint", "0.1", "-45 45", foot, "0.06", SLATE)
    shin = part("leg", f"leg{suffix}_joint", "0.6", "-150 0", "0 0 0.6 0 0 0.1", "0.04", look, sole)
    return part("thigh", f"thigh{suffix}_joint", "1.05", "-150 0", "0 0 1.05 0 0 0.6", "0.05", SHELL, shin)


def _hopper() -> bytes:
    spine = rod("torso_geom", "0 0 1.45 0 0 1.05", "0.05", SHELL)
    leg = _leg("", ORANGE, "-0.13 0 0.1 0.26 0 0.1")
    torso = body("torso", "0 0 0", *_planar("0 0 0", ("ignore1", "ignore2", "ignore3")), spine, leg)
    motors = {f"{part}_joint": "200" for part in ("thigh", "leg", "foot")}
    geom = {"conaffinity": "1", "condim": "1", "contype": "1", "margin": "0.001", "friction": "0.8 .1 .1"}
    return scene("hopper", "degree", "0.002", {"armature": "1", "damping": "1"}, geom, [torso], motors)


def _walker() -> bytes:
    spine = rod("torso_geom", "0 0 1.45 0 0 1.05", "0.05", SHELL)
    legs = [_leg("", ORANGE, "0 0 0.1 0.2 0 0.1"), _leg("_left", TEAL, "0 0 0.1 0.2 0 0.1")]
    torso = body("torso", "0 0 0", *_planar("0 0 0", ("ignorex", "ignorez", "ignorey")), spine, *legs)
    motors = {f"{part}{side}_joint": "100" for side in ("", "_left") for part in ("thigh", "leg", "foot")}
    geom = {"conaffinity": "0", "condim": "3", "contype": "1", "friction": "0.8 .1 .1"}
    return scene("walker2d", "degree", "0.002", {"armature": "0.01", "damping": ".1"}, geom, [torso], motors)


def _hip(name: str, axis: str, range_: str, stiffness: str = "10", damping: str = "5", armature: str = "0.01") -> Node:
    return hinge(name, axis, range_, armature=armature, damping=damping, stiffness=stiffness)


def _human_leg(side: str, s: int, ankles: bool) -> Node:
    """`ankles`: the foot turns on two joints and has two rods; else it is a ball."""
    if ankles:
        joints = [
            hinge(f"{side}_ankle_y", "0 1 0", "-50 50", "0 0 0.08", armature="0.0008", stiffness="4"),
            hinge(f"{side}_ankle_x", "1 0 0.5", "-50 50", "0 0 0.04", armature="0.0006", stiffness="1"),
        ]
        outer = rod(f"{side}_foot_cap1", f"-.07 {s * 0.02:g} 0 0.14 {s * 0.04:g} 0", "0.027", SLATE)
        inner = rod(f"{side}_foot_cap2", f"-.07 0 0 0.14 {-s * 0.02:g} 0", "0.027", SLATE)
        foot = body(f"{side}_foot", "0 0 -0.39", *joints, outer, inner)
    else:
        foot = body(f"{side}_foot", "0 0 -0.45", ball(f"{side}_foot", "0 0 0.1", "0.075", SLATE))
    knee = hinge(f"{side}_knee", "0 -1 0", "-160 -2", "0 0 .02", armature="0.006", stiffness="1")
    shin = body(
        f"{side}_shin", f"0 {-s * 0.01:g} -0.403", knee, rod(f"{side}_shin1", "0 0 0 0 0 -.3", "0.049", BLUE), foot
    )
    # The first of the two models allows its right hip ten degrees less.
    swing = "-110 20" if ankles and side == "right" else "-120 20"
    joints = [
        _hip(f"{side}_hip_x", f"{-s} 0 0", "-25 5"),
        _hip(f"{side}_hip_z", f"0 0 {-s}", "-60 35"),
        _hip(f"{side}_hip_y", "0 1 0", swing, stiffness="20"),
    ]
    thigh = rod(f"{side}_thigh1", f"0 0 0 0 {-s * 0.01:g} -.34", "0.06", BLUE)
    return body(f"{side}_thigh", f"0 {s * 0.1:g} -0.04", *joints, thigh, shin)


def _human_arm(side: str, s: int) -> Node:
    wide, narrow = ("-60 85", "-60 85") if s > 0 else ("-85 60", "-85 60")
    fore = f"0.01 {-s * 0.01:g} 0.01 .17 {-s * 0.17:g} .17"
    elbow = hinge(f"{side}_elbow", f"0 -1 {-s}", "-90 50", armature="0.0028")
    lower = body(
        f"{side}_lower_arm",
        f".18 {s * 0.18:g} -.18",
        elbow,
        rod(f"{side}_larm", fore, "0.031", SHELL),
        ball(f"{side}_hand", f".18 {-s * 0.18:g} .18", "0.04", SLATE),
    )
    first = hinge(f"{side}_shoulder1", f"2 {-s} 1", wide, armature="0.0068", stiffness="1")
    second = hinge(f"{side}_shoulder2", f"0 {s} 1", narrow, armature="0.0051", stiffness="1")
    upper = rod(f"{side}_uarm1", f"0 0 0 .16 {s * 0.16:g} -.16", "0.04", ORANGE)
    return body(f"{side}_upper_arm", f"0 {s * 0.17:g} 0.06", first, second, upper, lower)


def _human(ankles: bool, ground: bool) -> bytes:
    pelvis = body(
        "pelvis",
        "0 0 -0.165",
        hinge("abdomen_x", "1 0 0", "-35 35", "0 0 0.1", armature="0.02", damping="5", stiffness="10"),
        rod("butt", "-.02 -.07 0 -.02 .07 0", "0.09", BLUE),
        _human_leg("right", -1, ankles),
        _human_leg("left", 1, ankles),
    )
    waist = body(
        "lwaist",
        "-.01 0 -0.260",
        rod("lwaist", "0 -.06 0 0 .06 0", "0.06", SHELL),
        hinge("abdomen_z", "0 0 1", "-45 45", "0 0 0.065", armature="0.02", damping="5", stiffness="20"),
        hinge("abdomen_y", "0 1 0", "-75 30", "0 0 0.065", armature="0.02", damping="5", stiffness="10"),
        pelvis,
    )
    for node in (waist, pelvis):
        node.attributes["quat"] = "1 0 -0.002 0"
    torso = body(
        "torso",
        "0 0 1.4",
        rod("torso1", "0 -.07 0 0 .07 0", "0.07", ORANGE),
        ball("head", "0 0 .19", ".09", SHELL),
        rod("uwaist", "-.01 -.06 -.12 -.01 .06 -.12", "0.06", SHELL),
        waist,
        _human_arm("right", -1),
        _human_arm("left", 1),
    )
    gears = {"abdomen_y": "100", "abdomen_z": "100", "abdomen_x": "100"}
    for side in ("right", "left"):
        gears |= {f"{side}_hip_x": "100", f"{side}_hip_z": "100", f"{side}_hip_y": "300", f"{side}_knee": "200"}
        if ankles:
            gears |= {f"{side}_ankle_y": "100", f"{side}_ankle_x": "100"}
    for side in ("right", "left"):
        gears |= {f"{side}_shoulder1": "25", f"{side}_shoulder2": "25", f"{side}_elbow": "25"}
    geom = {"conaffinity": "1", "condim": "3", "contype": "1", "friction": "0.8 0.1 0.1", "margin": "0.001"}
    joint = {"armature": "0" if ankles else "1", "damping": "1"}
    world = [*([floor()] if ground else []), torso]
    return scene("humanoid", "degree", "0.002" if ankles else "0.003", joint, geom, world, gears)


RAIL = {"name": "rail", "type": "capsule", "pos": "0 0 0", "quat": "0.707 0 0.707 0", "size": "0.02 1", "rgba": SLATE}
CART = {"name": "cart", "type": "capsule", "pos": "0 0 0", "quat": "0.707 0 0.707 0", "size": "0.1 0.1", "rgba": BLUE}


def _pendulum() -> bytes:
    pole = body("pole", "0 0 0", hinge("hinge", "0 1 0"), rod("cpole", "0 0 0 0.001 0 0.6", "0.049", ORANGE))
    cart = body("cart", "0 0 0", slide("slider", "1 0 0", "-1 1"), Node("geom", CART), pole)
    geom = {"contype": "0", "friction": "1 0.1 0.1"}
    world = [Node("geom", RAIL), cart]
    return scene(
        "inverted pendulum", "degree", "0.02", {"armature": "0", "damping": "1"}, geom, world, {"slider": "100"}
    )


def _double_pendulum() -> bytes:
    tip = body("pole2", "0 0 0.6", hinge("hinge2", "0 1 0"), rod("cpole2", "0 0 0 0 0 0.6", "0.045", SHELL))
    pole = body("pole", "0 0 0", hinge("hinge", "0 1 0"), rod("cpole", "0 0 0 0 0 0.6", "0.045", ORANGE), tip)
    cart = body("cart", "0 0 0", slide("slider", "1 0 0", "-1 1"), Node("geom", CART), pole)
    geom = {"contype": "0", "friction": "1 0.1 0.1"}
    world = [floor("-3"), Node("geom", RAIL), cart]
    return scene("cartpole", "degree", "0.01", {"damping": "0.05"}, geom, world, {"slider": "500"})


def _reacher() -> bytes:
    corners = {
        "S": "-.3 -.3 .01 .3 -.3 .01",
        "E": ".3 -.3 .01 .3 .3 .01",
        "N": "-.3 .3 .01 .3 .3 .01",
        "W": "-.3 -.3 .01 -.3 .3 .01",
    }
    ground = floor(conaffinity="0", contype="0")
    ground.attributes |= {"name": "ground", "size": "1 1 10"}
    sides = [rod(f"side{side}", fromto, ".02", SLATE, conaffinity="0") for side, fromto in corners.items()]
    stem = {
        "name": "root",
        "type": "cylinder",
        "fromto": "0 0 0 0 0 0.02",
        "size": ".011",
        "rgba": SLATE,
        "conaffinity": "0",
        "contype": "0",
    }
    finger = body("fingertip", "0.11 0 0", ball("fingertip", "0 0 0", ".01", TEAL, contype="0"))
    second = body(
        "body1", "0.1 0 0", hinge("joint1", "0 0 1", "-3 3"), rod("link1", "0 0 0 0.1 0 0", ".01", ORANGE), finger
    )
    first = body("body0", "0 0 .01", hinge("joint0", "0 0 1"), rod("link0", "0 0 0 0.1 0 0", ".01", BLUE), second)
    still = {"armature": "0", "damping": "0", "stiffness": "0"}
    spot = ball("target", "0 0 0", ".009", "0.84 0.22 0.20 1", conaffinity="0", contype="0")
    slides = [slide(f"target_{axis}", along, "-.27 .27", **still) for axis, along in (("x", "1 0 0"), ("y", "0 1 0"))]
    world = [ground, *sides, Node("geom", stem), first, body("target", "0 0 .01", *slides, spot)]
    geom = {"contype": "0", "friction": "1 0.1 0.1"}
    return scene(
        "reacher", "radian", "0.01", {"armature": "1", "damping": "1"}, geom, world, {"joint0": "200", "joint1": "200"}
    )


def _swimmer() -> bytes:
    back = body("back", "-1 0 0", rod("back", "0 0 0 -1 0 0", "0.1", SLATE), hinge("rot3", "0 0 1", "-100 100"))
    mid = body("mid", "0.5 0 0", rod("mid", "0 0 0 -1 0 0", "0.1", SHELL), hinge("rot2", "0 0 1", "-100 100"), back)
    swims = [slide("slider1", "1 0 0"), slide("slider2", "0 1 0"), hinge("rot", "0 0 1")]
    torso = body("torso", "0 0 0", rod("torso", "1.5 0 0 0.5 0 0", "0.1", ORANGE), *swims, mid)
    world = [floor("-0.1", condim="3"), torso]
    geom = {"conaffinity": "1", "condim": "1", "contype": "1"}
    return scene("swimmer", "degree", "0.01", {"armature": "0.1"}, geom, world, {"rot2": "150", "rot3": "150"})


def _ground() -> bytes:
    return scene("ground_plane", "degree", "0.002", {}, {"friction": "0.8 0.1 0.1"}, [floor()], {})


def files() -> Files:
    made = {
        "ant": _ant(),
        "half_cheetah": _cheetah(),
        "hopper": _hopper(),
        "walker2d": _walker(),
        "humanoid": _human(ankles=True, ground=True),
        "humanoid_symmetric": _human(ankles=False, ground=False),
        "humanoid_symmetric_no_ground": _human(ankles=False, ground=False),
        "inverted_pendulum": _pendulum(),
        "inverted_double_pendulum": _double_pendulum(),
        "reacher": _reacher(),
        "swimmer": _swimmer(),
        "ground_plane": _ground(),
    }
    return {f"mjcf/{name}.xml": data for name, data in made.items()}
