"""MJCF scenes with an arm of seven joints that pushes, strikes and throws."""

from __future__ import annotations

from robots.bullet_data.common import Files
from robots.bullet_data.mjcf_xml import (
    BLUE,
    ORANGE,
    PALE,
    SHELL,
    SLATE,
    TEAL,
    Node,
    ball,
    body,
    box,
    hinge,
    rod,
    scene,
    slide,
)

TOUCHES = {"contype": "1", "conaffinity": "1"}
MEETS, MEETS_NOT = {"contype": "1", "conaffinity": "0"}, {"contype": "0", "conaffinity": "0"}
ARM = ("shoulder_pan", "shoulder_lift", "upper_arm_roll", "elbow_flex", "forearm_roll", "wrist_flex", "wrist_roll")
FAR = "-10.3213 10.3"


def _upper_arm(ranges: tuple[str, str, str, str, str], forearm: Node, damping: str = "0") -> Node:
    """From the shoulder to the roll of the forearm, which holds `forearm`."""

    def turn(k: int, axis: str) -> Node:
        return hinge(f"{ARM[k]}_joint", axis, ranges[k], damping=damping)

    roll = body("forearm_roll_link", "0 0 0", rod("fr", "-0.1 0 0 0.1 0 0", "0.02", SLATE), turn(4, "1 0 0"), forearm)
    elbow = body("elbow_flex_link", "0.4 0 0", rod("ef", "0 -0.02 0 0 0.02 0", "0.06", SLATE), turn(3, "0 1 0"), roll)
    arm = body("upper_arm_link", "0 0 0", rod("ua", "0 0 0 0.4 0 0", "0.06", SHELL), elbow)
    twist = body("upper_arm_roll_link", "0 0 0", rod("uar", "-0.1 0 0 0.1 0 0", "0.02", SLATE), turn(2, "1 0 0"), arm)
    lift = body("shoulder_lift_link", "0.1 0 0", rod("sl", "0 -0.1 0 0 0.1 0", "0.1", BLUE), turn(1, "0 1 0"), twist)
    eyes = [ball(f"e{k}", f"{x} 0.05 0.2", "0.05", SHELL) for k, x in ((1, "-0.06"), (2, "0.06"))]
    eyes += [ball(f"e{k}p", f"{x} 0.09 0.2", "0.03", SLATE) for k, x in ((1, "-0.06"), (2, "0.06"))]
    post = rod("sp", "0 0 -0.4 0 0 0.2", "0.1", SHELL)
    return body("shoulder_pan_link", "0 -0.6 0", *eyes, post, turn(0, "0 0 1"), lift)


def _straight(*hand: Node) -> Node:
    """Forearm and wrist along x, with the hand in the last link."""
    roll = body("wrist_roll_link", "0 0 0", hinge("wrist_roll_joint", "1 0 0", "-1.5 1.5", damping="0"), *hand)
    bend = hinge("wrist_flex_joint", "0 1 0", "-1.094 0", damping="0")
    wrist = body("wrist_flex_link", "0.321 0 0", rod("wf", "0 -0.02 0 0 0.02 0", "0.01", SLATE), bend, roll)
    return body("forearm_link", "0 0 0", rod("fa", "0 0 0 0.291 0 0", "0.05", SHELL), wrist)


REACH = ("-2.2854 1.714602", "-0.5236 1.3963", "-1.5 1.7", "-2.3213 0", "-1.5 1.5")


def _slides(name: str, **more: str) -> list[Node]:
    return [slide(f"{name}_{axis}", along, FAR, **more) for axis, along in (("x", "1 0 0"), ("y", "0 1 0"))]


def _disc(name: str, size: str, rgba: str, **more: str) -> Node:
    return Node("geom", {"name": name, "type": "cylinder", "size": size, "rgba": rgba, **more})


def _table(name: str) -> Node:
    named = {"name": name} if name else {}
    return Node("geom", {**named, "type": "plane", "pos": "0 0.5 -0.325", "size": "1 1 0.1", "rgba": PALE, **TOUCHES})


def _scene(name: str, armature: str, friction: str, world: list[Node], gears: list[str]) -> bytes:
    geom = {"friction": friction, "density": "300", "margin": "0.002", "condim": "1", **MEETS_NOT}
    joint = {"armature": armature, "damping": "0"}
    motors = {f"{key}_joint": gear for key, gear in zip(ARM, gears, strict=True)}
    return scene(name, "radian", "0.01", joint, geom, world, motors, gravity="0 0 0" if name != "thrower" else "")


def _pusher() -> bytes:
    tips = body(
        "fingertip",
        "0 0 0",
        *(ball(f"tip_arm{k}", f"0.1 {y} 0", "0.01", ORANGE) for k, y in (("l", "-0.1"), ("r", "0.1"))),
    )
    fork = [rod("fork_bar", "0 -0.1 0 0 0.1 0", "0.02", ORANGE, **TOUCHES)]
    fork += [
        rod(f"fork_{k}", f"0 {y} 0 0.1 {y} 0", "0.02", ORANGE, **TOUCHES) for k, y in (("l", "-0.1"), ("r", "0.1"))
    ]
    puck = body(
        "object",
        "0.45 -0.05 -0.275",
        ball("hub", "0 0 0", "0.05", "1 1 1 0", conaffinity="0"),
        _disc("puck", "0.05 0.05", TEAL, **MEETS),
        *_slides("object", damping="0"),
    )
    goal = body(
        "target",
        "0.45 -0.05 -0.3230",
        _disc("goal", "0.08 0.001", "0.84 0.22 0.20 1", **MEETS_NOT),
        *_slides("target", damping="0"),
    )
    return _scene(
        "pusher",
        "0.04",
        ".8 .1 .1",
        [_table("table"), _upper_arm(REACH, _straight(tips, *fork)), puck, goal],
        ["2"] * 7,
    )


def _striker() -> bytes:
    bat = body("fingertip", "0 0 0", box("tip_arml", "0.017 0 0", "0.003 0.12 0.05", ORANGE, **TOUCHES))
    bar = rod("bar", "0 -0.1 0 0 0.1 0", "0.02", SLATE, **TOUCHES)
    puck = body(
        "object",
        "0 0 -0.270",
        ball("puck", "0 0 0", "0.05", TEAL, **MEETS),
        *_slides("object", armature="0.1", damping="0.5"),
    )
    boards = {"contype": "0", "conaffinity": "1"}

    def board(k: int, **turn: str) -> Node:
        return body("", "0 0 0", box(f"board{k}", "0 0.075 0.04", "0.032 0.001 0.04", SHELL, **boards), **turn)

    coaster = body("coaster", "0 0 0", _disc("coaster", "0.08 0.001", "0.84 0.22 0.20 1", **MEETS_NOT))
    goal = body(
        "target",
        "0 0 -0.3230",
        Node("freejoint", {"name": "target_free"}),
        box("goal", "0 0 0", "0.01 0.01 0.01", "1 1 1 0", **MEETS_NOT),
        board(0),
        coaster,
        board(1, axisangle="0 0 1 0.785"),
        board(2, axisangle="0 0 1 -0.785"),
    )
    return _scene(
        "striker", "0.04", "0 0 0", [_table("table"), _upper_arm(REACH, _straight(bat, bar)), puck, goal], ["3"] * 7
    )


def _thrower() -> bytes:
    """Its hand is a cup of seven fingers, each of three rods."""
    path = ["0 0.025 0", "0 0.075 0.075", "0 0.075 0.15", "0 0 0.225"]

    def finger(k: int, yaw: str) -> Node:
        rods = [rod(f"finger{k}_{j}", f"{path[j]} {path[j + 1]}", "0.005", ORANGE, **TOUCHES) for j in range(3)]
        return body("fingertip" if k == 0 else "", "0 0 0", *rods, axisangle=f"0 0 1 {yaw}")

    cup = [finger(k, yaw) for k, yaw in enumerate(("0.392", "1.57", "1.178", "0.785", "1.96", "2.355", "2.74"))]
    knuckle = rod("knuckle", "0 -0.05 0 0 0.05 0", "0.01", SLATE, **TOUCHES)
    roll = body(
        "wrist_roll_link",
        "0 0 0",
        hinge("wrist_roll_joint", "0 1 0", "0 2.25", damping="1"),
        knuckle,
        *cup,
        axisangle="0 1 0 -1.178",
    )
    bend = hinge("wrist_flex_joint", "0 0 1", "-1 1", damping="1")
    wrist = body(
        "wrist_flex_link",
        "0 0 0.321",
        rod("wf", "0 -0.02 0 0 0.02 0", "0.01", SLATE),
        bend,
        roll,
        axisangle="0 0 1 1.57",
    )
    forearm = body("forearm_link", "0 0 0", rod("fa", "0 0 0 0 0 0.291", "0.05", SHELL), wrist, axisangle="1 0 0 0.392")
    arm = _upper_arm(("-0.4854 1.214602", "-0.5236 0.7963", "-1.5 1.7", "-0.7 0.7", "-1.5 1.5"), forearm, damping="1")
    thrown = body(
        "object",
        "0.5 -0.8 0.275",
        Node("freejoint", {"name": "object_free"}),
        ball("ball", "0 0 0", "0.03", TEAL, density="25", **TOUCHES),
    )
    walls = [
        ("0 0.075 0.034", "0.075 0.001 0.03"),
        ("0 -0.075 0.034", "0.075 0.001 0.03"),
        ("0.075 0 0.034", "0.001 0.075 0.03"),
        ("-0.076 0 0.034", "0.001 0.075 0.03"),
    ]
    goal = [box("floor", "0 0 0.005", "0.075 0.075 0.001", SHELL, density="1000", **TOUCHES)]
    goal += [box(f"wall{k}", pos, size, SHELL, **MEETS) for k, (pos, size) in enumerate(walls)]
    corners = [(x, y) for x in ("0.073", "-0.073") for y in ("0.073", "-0.073")]
    for k, (x, y) in enumerate(corners):
        goal.append(rod(f"post{k}", f"{x} {y} 0.0075 {x} {y} 0.06", "0.005", SLATE, **MEETS))
    target = body("target", "0.575 0.5 -0.328", *goal, *_slides("target", damping="0"))
    return _scene("thrower", "0.75", ".8 .1 .1", [_table(""), arm, thrown, target], ["10"] * 4 + ["15"] * 3)


def files() -> Files:
    return {"mjcf/pusher.xml": _pusher(), "mjcf/striker.xml": _striker(), "mjcf/thrower.xml": _thrower()}
