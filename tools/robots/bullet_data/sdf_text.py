"""SDF text of robots, as PyBullet reads it: links placed in their model's frame, axes in the child's."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

import numpy as np

from robots.bullet_data.common import SCRIPT
from robots.description import ZERO, Joint, Link, Plane, Rgba, Robot, Shape, Vec3
from robots.inertia import rotation
from robots.sdf import Array
from robots.urdf import number, placement, vector


def _rpy(turn: Array) -> Vec3:
    """Roll, pitch and yaw of a rotation matrix, multiples of 1e-9 rad."""
    pitch = math.asin(max(-1.0, min(1.0, -turn[2, 0])))
    if abs(turn[2, 0]) > 1 - 1e-12:
        roll, yaw = 0.0, math.atan2(-turn[0, 1], turn[1, 1])
    else:
        roll, yaw = math.atan2(turn[2, 1], turn[2, 2]), math.atan2(turn[1, 0], turn[0, 0])
    return round(roll, 9), round(pitch, 9), round(yaw, 9)


def _poses(robot: Robot) -> dict[str, tuple[Array, Array]]:
    """Place and rotation of every link in the model's frame, all joints at 0."""
    poses = {robot.links[0].name: (np.zeros(3), np.eye(3))}
    for joint in robot.joints:  # parents come first
        at, turn = poses[joint.parent]
        poses[joint.child] = (at + turn @ np.array(joint.xyz), turn @ rotation(joint.rpy))
    return poses


def _geometry(shape: Shape) -> tuple[Vec3, Vec3, str]:
    """Place, rpy and geometry, in elements where URDF has attributes."""
    xyz, rpy, text = placement(shape, "")
    if isinstance(shape, Plane):
        return xyz, rpy, "<plane><normal>0 0 1</normal><size>100 100</size></plane>"
    tag, _, rest = text.strip("<>/").partition(" ")
    fields = [(k, v) for k, v in re.findall(r'(\w+)="([^"]*)"', rest)]
    body = "".join(f"<{'uri' if k == 'filename' else k}>{v}</{'uri' if k == 'filename' else k}>" for k, v in fields)
    if tag == "mesh" and "scale" not in text:
        body += "<scale>1 1 1</scale>"
    return xyz, rpy, f"<{tag}>{body}</{tag}>"


def _shape(role: str, name: str, shape: Shape, rgba: Rgba | None) -> Iterator[str]:
    xyz, rpy, geometry = _geometry(shape)
    yield f'      <{role} name="{name}">'
    yield f"        <pose>{vector(xyz + rpy)}</pose>"
    yield f"        <geometry>{geometry}</geometry>"
    if rgba:
        yield f"        <material><ambient>{vector(rgba)}</ambient><diffuse>{vector(rgba)}</diffuse></material>"
    yield f"      </{role}>"


def _link(robot: Robot, link: Link, pose: tuple[Array, Array]) -> Iterator[str]:
    at = (round(pose[0][0], 9), round(pose[0][1], 9), round(pose[0][2], 9))
    ixx, iyy, izz = (number(i) for i in link.inertia)
    yield f'    <link name="{link.name}">'
    yield f"      <pose>{vector(at + _rpy(pose[1]))}</pose>"
    if link.contact:
        yield "      <contact>"
        yield from (f"        <{name}>{number(value)}</{name}>" for name, value in link.contact.items())
        yield "      </contact>"
    yield "      <inertial>"
    yield f"        <pose>{vector(link.com + ZERO)}</pose>"
    yield f"        <mass>{number(link.mass)}</mass>"
    tensor = f"<ixx>{ixx}</ixx><ixy>0</ixy><ixz>0</ixz><iyy>{iyy}</iyy><iyz>0</iyz><izz>{izz}</izz>"
    yield f"        <inertia>{tensor}</inertia>"
    yield "      </inertial>"
    for k, (shape, material) in enumerate(link.looks):
        yield from _shape("visual", f"{link.name}_visual{k}", shape, robot.materials[material])
    for k, shape in enumerate(link.shapes):
        yield from _shape("collision", f"{link.name}_collision{k}", shape, None)
    yield "    </link>"


def _joint(joint: Joint) -> Iterator[str]:
    yield f'    <joint name="{joint.name}" type="{joint.kind}">'
    yield f"      <parent>{joint.parent}</parent>"
    yield f"      <child>{joint.child}</child>"
    if joint.kind != "fixed":
        yield "      <axis>"
        yield f"        <xyz>{vector(joint.axis)}</xyz>"
        if joint.limits is not None:
            names = ("lower", "upper", "effort", "velocity")
            limits = "".join(f"<{k}>{number(v)}</{k}>" for k, v in zip(names, joint.limits, strict=True))
            yield f"        <limit>{limits}</limit>"
        damping, friction = number(joint.damping), number(joint.friction)
        yield f"        <dynamics><damping>{damping}</damping><friction>{friction}</friction></dynamics>"
        yield "      </axis>"
    yield "    </joint>"


def world_text(robots: list[Robot], *, static: bool = False, at: Vec3 = ZERO) -> bytes:
    """A world with these models, each at `at`."""
    lines = ['<?xml version="1.0"?>', f"<!-- Written by {SCRIPT}: edit that, not this. -->"]
    lines += ['<sdf version="1.6">', '<world name="default">', "  <gravity>0 0 -9.8</gravity>"]
    for robot in robots:
        poses = _poses(robot)
        lines += [f'  <model name="{robot.name}">', f"    <pose>{vector(at + ZERO)}</pose>"]
        lines += ["    <static>1</static>"] if static else []
        for link in robot.links:
            lines += _link(robot, link, poses[link.name])
        for joint in robot.joints:
            lines += _joint(joint)
        lines.append("  </model>")
    return ("\n".join([*lines, "</world>", "</sdf>"]) + "\n").encode()
