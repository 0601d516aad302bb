"""URDF text of a robot."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from robots.description import (
    ZERO,
    Box,
    Capsule,
    Cylinder,
    Joint,
    Link,
    MeshFile,
    Placed,
    Plane,
    Rgba,
    Robot,
    Shape,
    Sphere,
    Vec3,
)

ROLL_TO_AXIS: dict[str, Vec3] = {"x": (0.0, math.pi / 2, 0.0), "y": (-math.pi / 2, 0.0, 0.0), "z": (0.0, 0.0, 0.0)}


def number(value: float) -> str:
    """Shortest text that reads back as the same double, without a trailing ".0"."""
    text = repr(float(value) + 0.0)
    return text.removesuffix(".0")


def vector(values: tuple[float, ...]) -> str:
    return " ".join(number(v) for v in values)


def _origin(xyz: Vec3, rpy: Vec3) -> str:
    return f'<origin xyz="{vector(xyz)}" rpy="{vector(rpy)}"/>'


def _half_turn(xyz: Vec3, rpy: Vec3, turned: bool) -> str:
    """Origin of a shape, turned by pi about the link's z axis if asked (all turned shapes have zero roll and pitch)."""
    if not turned:
        return _origin(xyz, rpy)
    return _origin((-xyz[0], -xyz[1], xyz[2]), (rpy[0], rpy[1], math.pi))


def placement(shape: Shape, meshes: str) -> tuple[Vec3, Vec3, str]:
    """Position, rpy and geometry element of a shape; centres rounded to 1 nm. `meshes` holds collision/."""
    if isinstance(shape, Placed):
        inner, turn, geometry = placement(shape.shape, meshes)
        if inner == ZERO and turn == ZERO:
            return shape.xyz, shape.rpy, geometry
        raise ValueError(f"{shape.shape} is to be placed from its own frame")
    if isinstance(shape, Cylinder):
        centre = list(shape.centre)
        centre["xyz".index(shape.axis)] = 0.5 * (shape.low + shape.high)
        tag = "capsule" if isinstance(shape, Capsule) else "cylinder"
        geometry = f'<{tag} radius="{number(shape.radius)}" length="{number(round(shape.high - shape.low, 9))}"/>'
        return (round(centre[0], 9), round(centre[1], 9), round(centre[2], 9)), ROLL_TO_AXIS[shape.axis], geometry
    if isinstance(shape, Box):
        middle = [round(0.5 * (a + b), 9) for a, b in zip(shape.low, shape.high, strict=True)]
        size = tuple(round(b - a, 9) for a, b in zip(shape.low, shape.high, strict=True))
        return (middle[0], middle[1], middle[2]), ZERO, f'<box size="{vector(size)}"/>'
    if isinstance(shape, Sphere):
        return shape.centre, ZERO, f'<sphere radius="{number(shape.radius)}"/>'
    if isinstance(shape, Plane):
        return ZERO, ZERO, '<plane normal="0 0 1"/>'
    if isinstance(shape, MeshFile):
        scale = "" if shape.scale == (1.0, 1.0, 1.0) else f' scale="{vector(shape.scale)}"'
        return ZERO, ZERO, f'<mesh filename="{shape.path}"{scale}/>'
    return ZERO, ZERO, f'<mesh filename="{meshes}collision/{shape.name}.obj"/>'


def _inertial(link: Link) -> Iterator[str]:
    ixx, iyy, izz, ixy, ixz, iyz = (number(i) for i in (*link.inertia, *link.products))
    yield "    <inertial>"
    yield f"      {_origin(link.com, ZERO)}"
    yield f'      <mass value="{number(link.mass)}"/>'
    yield f'      <inertia ixx="{ixx}" ixy="{ixy}" ixz="{ixz}" iyy="{iyy}" iyz="{iyz}" izz="{izz}"/>'
    yield "    </inertial>"


def _link(link: Link, parts: Mapping[str, list[str]], meshes: str) -> Iterator[str]:
    yield f'  <link name="{link.name}">'
    if link.contact:
        yield "    <contact>"
        yield from (f'      <{name} value="{number(value)}"/>' for name, value in link.contact.items())
        yield "    </contact>"
    yield from _inertial(link)
    shells = [(MeshFile(f"{meshes}visual/{link.visual}_{m}.obj"), m) for m in parts.get(link.visual, [])]
    for shape, material in [*shells, *link.looks]:
        xyz, rpy, geometry = placement(shape, meshes)
        yield "    <visual>"
        yield f"      {_half_turn(xyz, rpy, link.turned)}"
        yield f"      <geometry>{geometry}</geometry>"
        yield f'      <material name="{material}"/>'
        yield "    </visual>"
    for shape in link.shapes:
        xyz, rpy, geometry = placement(shape, meshes)
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
    if joint.kind != "fixed":
        yield f'    <axis xyz="{vector(joint.axis)}"/>'
    if joint.limits is not None:
        lower, upper, effort, velocity = (number(v) for v in joint.limits)
        yield f'    <limit lower="{lower}" upper="{upper}" effort="{effort}" velocity="{velocity}"/>'
    if joint.drive is not None:
        yield f'    <limit effort="{number(joint.drive[0])}" velocity="{number(joint.drive[1])}"/>'
    if joint.limits is not None or joint.damping or joint.friction:
        yield f'    <dynamics damping="{number(joint.damping)}" friction="{number(joint.friction)}"/>'
    if joint.mimic:
        yield f'    <mimic joint="{joint.mimic}" multiplier="{number(joint.mimic_multiplier)}" offset="0"/>'
    yield "  </joint>"


def _material(name: str, rgba: Rgba, texture: str | None) -> str:
    image = f'<texture filename="{texture}"/>' if texture else ""
    return f'  <material name="{name}"><color rgba="{vector(rgba)}"/>{image}</material>'


def urdf_text(robot: Robot, parts: Mapping[str, list[str]]) -> str:
    """The whole file; `parts` lists the materials of each visual mesh set."""
    lines = ['<?xml version="1.0"?>', f"<!-- Written by {robot.script}: edit that, not this. -->"]
    lines.append(f'<robot name="{robot.name}">')
    lines += [_material(name, rgba, robot.textures.get(name)) for name, rgba in robot.materials.items()]
    for link in robot.links:
        lines += _link(link, parts, robot.meshes)
    for joint in robot.joints:
        lines += _joint(joint)
    return "\n".join([*lines, "</robot>"]) + "\n"
