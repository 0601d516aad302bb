"""URDF text of a robot."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from robots.description import Box, Cylinder, Joint, Link, Robot, Shape, Vec3

ROLL_TO_AXIS: dict[str, Vec3] = {"x": (0.0, math.pi / 2, 0.0), "y": (-math.pi / 2, 0.0, 0.0), "z": (0.0, 0.0, 0.0)}


def _number(value: float) -> str:
    """Shortest text that reads back as the same double, without a trailing ".0"."""
    text = repr(float(value) + 0.0)
    return text.removesuffix(".0")


def _vector(values: tuple[float, ...]) -> str:
    return " ".join(_number(v) for v in values)


def _origin(xyz: Vec3, rpy: Vec3) -> str:
    return f'<origin xyz="{_vector(xyz)}" rpy="{_vector(rpy)}"/>'


def _half_turn(xyz: Vec3, rpy: Vec3, turned: bool) -> str:
    """Origin of a shape, turned by pi about the link's z axis if asked (all turned shapes have zero roll and pitch)."""
    if not turned:
        return _origin(xyz, rpy)
    return _origin((-xyz[0], -xyz[1], xyz[2]), (rpy[0], rpy[1], math.pi))


def _placement(shape: Shape) -> tuple[Vec3, Vec3, str]:
    """Position, rpy and geometry element of a collision shape; centres rounded to 1 nm."""
    if isinstance(shape, Cylinder):
        centre = list(shape.centre)
        centre["xyz".index(shape.axis)] = 0.5 * (shape.low + shape.high)
        geometry = f'<cylinder radius="{_number(shape.radius)}" length="{_number(round(shape.high - shape.low, 9))}"/>'
        return (round(centre[0], 9), round(centre[1], 9), round(centre[2], 9)), ROLL_TO_AXIS[shape.axis], geometry
    if isinstance(shape, Box):
        middle = [round(0.5 * (a + b), 9) for a, b in zip(shape.low, shape.high, strict=True)]
        size = tuple(round(b - a, 9) for a, b in zip(shape.low, shape.high, strict=True))
        return (middle[0], middle[1], middle[2]), (0.0, 0.0, 0.0), f'<box size="{_vector(size)}"/>'
    return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), f'<mesh filename="collision/{shape.name}.obj"/>'


def _link(link: Link, parts: Mapping[str, list[str]]) -> Iterator[str]:
    yield f'  <link name="{link.name}">'
    if link.grip:
        yield "    <contact>"
        yield '      <lateral_friction value="1"/>'
        yield "    </contact>"
    ixx, iyy, izz = (_number(i) for i in link.inertia)
    yield "    <inertial>"
    yield f"      {_origin(link.com, (0.0, 0.0, 0.0))}"
    yield f'      <mass value="{_number(link.mass)}"/>'
    yield f'      <inertia ixx="{ixx}" ixy="0" ixz="0" iyy="{iyy}" iyz="0" izz="{izz}"/>'
    yield "    </inertial>"
    for material in parts.get(link.visual, []):
        yield "    <visual>"
        yield f"      {_half_turn((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), link.turned)}"
        yield f'      <geometry><mesh filename="visual/{link.visual}_{material}.obj"/></geometry>'
        yield f'      <material name="{material}"/>'
        yield "    </visual>"
    for shape in link.shapes:
        xyz, rpy, geometry = _placement(shape)
        yield "    <collision>"
        yield f"      {_half_turn(xyz, rpy, link.turned)}"
        yield f"      <geometry>{geometry}</geometry>"
        yield "    </collision>"
    yield "  </link>"


def _joint(joint: Joint) -> Iterator[str]:
    yield f'  <joint name="{joint.name}" type="{joint.kind}">'
    yield f'    <parent link="{joint.parent}"/>'
    yield f'    <child link="{joint.child}"/>'
    yield f"    {_origin(joint.xyz, joint.rpy)}"
    if joint.limits is not None:
        lower, upper, effort, velocity = (_number(v) for v in joint.limits)
        yield f'    <axis xyz="{_vector(joint.axis)}"/>'
        yield f'    <limit lower="{lower}" upper="{upper}" effort="{effort}" velocity="{velocity}"/>'
        yield '    <dynamics damping="0" friction="0"/>'
    if joint.mimic:
        yield f'    <mimic joint="{joint.mimic}" multiplier="1" offset="0"/>'
    yield "  </joint>"


def urdf_text(robot: Robot, parts: Mapping[str, list[str]]) -> str:
    """The whole file; `parts` lists the materials of each visual mesh set."""
    lines = ['<?xml version="1.0"?>', f"<!-- Written by {robot.script}: edit that, not this. -->"]
    lines.append(f'<robot name="{robot.name}">')
    for name, rgba in robot.materials.items():
        lines.append(f'  <material name="{name}"><color rgba="{_vector(rgba)}"/></material>')
    for link in robot.links:
        lines += _link(link, parts)
    for joint in robot.joints:
        lines += _joint(joint)
    return "\n".join([*lines, "</robot>"]) + "\n"
