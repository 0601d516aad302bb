"""The Panda of assets/, read into a scene: its links and joints, and the boxes of its fingers."""

from functools import cache
from xml.etree import ElementTree

import numpy as np

import manyhands as mh
from benchmarks.accuracy.scene import UPRIGHT, Array, Body, Geom, Mimic, Quaternion, Servo, Triple, about

ARM = tuple(f"panda_link{k}" for k in range(1, 8))
FINGERS = ("panda_leftfinger", "panda_rightfinger")
HAND, GRASP = "panda_hand", "panda_grasptarget"
BASE: Triple = (-0.6, 0.0, 0.0)
FORCES = (87.0, 87.0, 87.0, 87.0, 12.0, 120.0, 120.0)  # [N m], panda-gym's
GRIP = 40.0  # [N] of each finger; the real hand holds 70
OPEN = 0.04  # [m] of each finger
# Springs and dampers as MuJoCo's own model of this arm has.
SERVOS = ((4500, 150), (4500, 150), (3500, 110), (3500, 110), (2000, 60), (2000, 60), (2000, 60))
LINKS = ("panda_link0", *ARM, HAND, *FINGERS)
DOWN: Quaternion = (1.0, 0.0, 0.0, 0.0)  # the gripper points down


def triple(text: str | None) -> Triple:
    """Of an attribute."""
    x, y, z = (float(word) for word in (text or "0 0 0").split())
    return (x, y, z)


def quaternion(rpy: Triple) -> Quaternion:
    """Of URDF's turns about the fixed axes x, y, z; those of this robot have one at most, to rounding."""
    turns = [k for k in range(3) if rpy[k] != 0]
    if len(turns) > 1:
        raise ValueError(f"an origin with several turns, {rpy}: read it with care")
    return about(np.eye(3)[turns[0]].tolist(), rpy[turns[0]]) if turns else UPRIGHT


def robot(friction: float, q: Array) -> Body:
    """The tree of moving links at q (9), with the hand fixed on link 7; it stands at BASE and only its pads collide."""
    root = ElementTree.parse(mh.asset_path("panda/panda.urdf")).getroot()
    links = {link.get("name"): link for link in root.findall("link")}
    joints = [joint for joint in root.findall("joint") if kid(joint) in (*LINKS, "panda_link8")]
    start = dict(zip((*ARM, *FINGERS), q, strict=True))

    def build(name: str, pos: Triple, quat: Quaternion, kind: str, axis: Triple) -> Body:
        inertial = part(links[name], "inertial")
        tensor = part(inertial, "inertia")
        return Body(
            name,
            tuple(pads(links[name], friction)) if name in FINGERS else (),
            float(part(inertial, "mass").get("value", 0)),
            pos,
            quat,
            joint=kind,
            axis=axis,
            com=triple(part(inertial, "origin").get("xyz")),
            inertia=triple(" ".join(tensor.get(key, "0") for key in ("ixx", "iyy", "izz"))),
            q=float(start.get(name, 0.0)),
            children=tuple(below(joint) for joint in joints if part(joint, "parent").get("link") == name),
        )

    def below(joint: ElementTree.Element) -> Body:
        kind = {"revolute": "hinge", "prismatic": "slide", "fixed": "fixed"}[joint.get("type", "")]
        axis = (0.0, 0.0, 1.0) if kind == "fixed" else triple(part(joint, "axis").get("xyz"))
        origin = part(joint, "origin")
        return build(kid(joint), triple(origin.get("xyz")), quaternion(triple(origin.get("rpy"))), kind, axis)

    return build("panda_link0", BASE, UPRIGHT, "fixed", (0.0, 0.0, 1.0))


def part(element: ElementTree.Element, name: str) -> ElementTree.Element:
    """A child that must be there."""
    found = element.find(name)
    if found is None:
        raise ValueError(f"no <{name}> in <{element.tag} name={element.get('name')!r}>")
    return found


def kid(joint: ElementTree.Element) -> str:
    """The child link."""
    return part(joint, "child").get("link", "")


def pads(link: ElementTree.Element, friction: float) -> list[Geom]:
    """A finger's boxes; a half turn about z leaves a box as it is."""
    out = []
    for collision in link.findall("collision"):
        sizes = triple(part(part(collision, "geometry"), "box").get("size"))
        half = (sizes[0] / 2, sizes[1] / 2, sizes[2] / 2)
        out.append(Geom("box", half, friction, pos=triple(part(collision, "origin").get("xyz"))))
    return out


def servos() -> tuple[Servo, ...]:
    """Of the arm and both fingers."""
    arm = [Servo(name, kp, kv, most) for name, (kp, kv), most in zip(ARM, SERVOS, FORCES, strict=True)]
    return (*arm, *(Servo(name, 2000.0, 50.0, GRIP) for name in FINGERS))


MIMIC = Mimic(FINGERS[1], FINGERS[0])


@cache
def model() -> mh.Model:
    """For inverse kinematics."""
    return mh.load_urdf(mh.asset_path("panda/panda.urdf"), load_meshes=False)[0]


def reach(point: Array, start: Array, tries: int = 0) -> Array:
    """Joint angles (9) that bring the grasp to a point in the world (3), the gripper pointing down, near `start`."""
    found = mh.inverse_kinematics(model(), GRASP, np.array(point) - BASE, DOWN, start=start, restarts=tries)
    if not found.success:
        raise ValueError(f"no inverse kinematics for {point}")
    return found.q
