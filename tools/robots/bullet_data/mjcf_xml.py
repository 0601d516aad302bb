"""MJCF elements, and the frame of a scene."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from robots.bullet_data.common import SCRIPT

Attributes = dict[str, str]


@dataclass
class Node:
    """An XML element."""

    tag: str
    attributes: Attributes
    children: list[Node] = field(default_factory=list)

    def lines(self, depth: int = 0) -> Iterable[str]:
        text = "".join(f' {name}="{value}"' for name, value in self.attributes.items())
        indent = "  " * depth
        if not self.children:
            yield f"{indent}<{self.tag}{text}/>"
            return
        yield f"{indent}<{self.tag}{text}>"
        for child in self.children:
            yield from child.lines(depth + 1)
        yield f"{indent}</{self.tag}>"


def body(name: str, pos: str, *children: Node, **more: str) -> Node:
    """A body; without a name if that is empty."""
    return Node("body", {**({"name": name} if name else {}), "pos": pos, **more}, list(children))


def hinge(name: str, axis: str, range_: str = "", pos: str = "0 0 0", **more: str) -> Node:
    limits = {"limited": "true", "range": range_} if range_ else {"limited": "false"}
    return Node("joint", {"name": name, "type": "hinge", "axis": axis, "pos": pos, **limits, **more})


def slide(name: str, axis: str, range_: str = "", **more: str) -> Node:
    limits = {"limited": "true", "range": range_} if range_ else {"limited": "false"}
    return Node("joint", {"name": name, "type": "slide", "axis": axis, "pos": "0 0 0", **limits, **more})


def rod(name: str, fromto: str, radius: str, rgba: str = "", **more: str) -> Node:
    colour = {"rgba": rgba} if rgba else {}
    return Node("geom", {"name": name, "type": "capsule", "fromto": fromto, "size": radius, **colour, **more})


def ball(name: str, pos: str, radius: str, rgba: str = "", **more: str) -> Node:
    colour = {"rgba": rgba} if rgba else {}
    return Node("geom", {"name": name, "type": "sphere", "pos": pos, "size": radius, **colour, **more})


def box(name: str, pos: str, size: str, rgba: str, **more: str) -> Node:
    return Node("geom", {"name": name, "type": "box", "pos": pos, "size": size, "rgba": rgba, **more})


def floor(z: str = "0", **more: str) -> Node:
    return Node("geom", {"name": "floor", "type": "plane", "pos": f"0 0 {z}", "size": "40 40 1", "rgba": PALE, **more})


def scene(
    name: str,
    angle: str,
    step: str,
    joint: Attributes,
    geom: Attributes,
    world: list[Node],
    motors: Attributes,
    gravity: str = "",
) -> bytes:
    """`motors`: gears by joints, in the order of the actuators."""
    driven = [Node("motor", {"name": key, "joint": key, "gear": gear}) for key, gear in motors.items()]
    defaults = [Node("joint", joint), Node("geom", geom), Node("motor", {"ctrllimited": "true", "ctrlrange": "-1 1"})]
    root = Node(
        "mujoco",
        {"model": name},
        [
            Node("compiler", {"angle": angle, "inertiafromgeom": "true"}),
            Node("option", {"timestep": step, **({"gravity": gravity} if gravity else {})}),
            Node("default", {}, defaults),
            Node("worldbody", {}, world),
            Node("actuator", {}, driven),
        ],
    )
    head = ['<?xml version="1.0"?>', f"<!-- Written by {SCRIPT}: edit that, not this. -->"]
    return ("\n".join([*head, *root.lines()]) + "\n").encode()


PALE, ORANGE, SHELL = "0.82 0.86 0.90 1", "0.98 0.43 0.10 1", "0.93 0.935 0.94 1"
SLATE, BLUE, TEAL, METAL = "0.30 0.33 0.37 1", "0.13 0.35 0.66 1", "0.02 0.53 0.60 1", "0.62 0.64 0.67 1"
