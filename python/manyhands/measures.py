"""What is measured of a world over and over: for plots on a page, and for recordings."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from manyhands._core import Joint, Model, World

Array = NDArray[np.float64]


class Joints(NamedTuple):
    """The joints of one degree of freedom."""

    names: list[str]
    iq: list[int]
    iv: list[int]
    in_degrees: Array
    """(k) what makes degrees of the radians of joints that turn; 1 of those that slide."""


def joints_of(model: Model) -> Joints:
    """In the model's order."""
    found = [joint for joint in model.joints if joint.nv == 1]
    in_degrees = np.array([1.0 if joint.type == "prismatic" else np.degrees(1.0) for joint in found])
    return Joints([j.name for j in found], [j.iq for j in found], [j.iv for j in found], in_degrees)


def joint_forces(world: World) -> Array:
    """What drives the joints of one degree of freedom (k) [N m or N]: the part of their wrenches along their axes in
    the last step. NaN before a step, and where a closed loop leaves it open."""
    model = world.model
    return np.array([_force(world, model, joint) for joint in model.joints if joint.nv == 1])


def _force(world: World, model: Model, joint: Joint) -> float:
    try:
        wrench = world.joint_wrench(joint.name)
    except RuntimeError:
        return np.nan
    # The axis is the same in the frame of the joint and in that of its child, which turns about it.
    _, quaternion = world.body_pose(model.links[joint.child].name)
    axis = rotate(quaternion, joint.axis)
    part = wrench[3:] if joint.type == "prismatic" else wrench[:3]
    return float(part @ axis)


def contact_forces(world: World) -> dict[str, float]:
    """The sum of the normal forces on each link that was touched in the last step [N], by name."""
    forces: dict[str, float] = {}
    for contact in world.contacts():
        for link in (contact.link_a, contact.link_b):
            forces[link] = forces.get(link, 0.0) + contact.normal_force
    return forces


def rotate(quaternion: Array, vector: Array) -> Array:
    """A vector (3) turned by a quaternion xyzw (4), or by many (n, 4)."""
    axis, w = quaternion[..., :3], quaternion[..., 3:]
    across = 2 * np.cross(axis, vector)
    return vector + w * across + np.cross(axis, across)


_HANDS = ("grasptarget", "tcp", "tool", "end_effector", "ee_link", "hand", "gripper", "cup")


def hand_of(model: Model) -> str | None:
    """The link that a person would call the hand: by its name, else the one after the most joints; None without."""
    links = [link.name for link in model.links]
    depth = {name: len(chain(model, name)) for name in links}
    for word in _HANDS:  # in a link's own name: what carries it may be called a gripper, too
        if found := [name for name in links if word in name.rpartition("/")[2].lower() and depth[name] > 1]:
            return found[0]
    deepest = max(links, key=lambda name: depth[name])
    return deepest if depth[deepest] > 1 else None


def chain(model: Model, link: str) -> list[str]:
    """The joints that move a link, from the world on; empty if one of them has several degrees of freedom."""
    links, joints = model.links, model.joints
    at = next(i for i, each in enumerate(links) if each.name == link)
    found: list[str] = []
    while links[at].parent >= 0:
        if links[at].joint >= 0:
            joint = joints[links[at].joint]
            if joint.nv > 1:
                return []
            if joint.nv == 1:
                found.insert(0, joint.name)
        at = links[at].parent
    return found
