"""What the families share: materials, links that weigh what they are made of, and entries of the catalogue."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from robots.bullet_data.common import COLOURS
from robots.description import ZERO, Joint, Link, Robot, Shape
from robots.inertia import mass_properties

SCRIPT = "tools/make_robots.py"
DENSITIES = {  # kg/m^3 of the whole volume, hollows included
    "drive": 1700.0,  # motor, gear and brake in an aluminium housing
    "tube": 950.0,  # aluminium, its wall a tenth of its radius: 2700 (1 - 0.8^2)
    "servo": 1500.0,  # a hobby servo in plastic
    "print": 500.0,  # printed plastic, two fifths filled
    "plastic": 1200.0,
    "rubber": 1100.0,
    "aluminium": 2700.0,
    "profile": 900.0,  # extruded aluminium, a third of it metal
    "steel": 7850.0,
    "wood": 700.0,
}


@dataclass(frozen=True)
class Part:
    """A shape, what it is made of, and its colour. `seen_only`: it has no mass and touches nothing."""

    shape: Shape
    made_of: str
    colour: str
    seen_only: bool = False


@dataclass(frozen=True)
class Entry:
    """A robot and what the catalogue says of it. Names are those of its links and joints."""

    robot: Robot
    kind: str  # "arm", "gripper" or "furniture"
    about: str
    home: Mapping[str, float] = field(default_factory=dict)  # position of each joint that no other drives
    flange: str = ""  # where a gripper goes, z outwards
    tool: str = ""  # of a gripper or an arm with one: where it grips, z outwards
    closed: Mapping[str, float] = field(default_factory=dict)  # of a gripper's joint; its home is open
    width: tuple[float, float] = (0.0, 0.0)  # of a gripper, between its fingers at the tool, closed and open [m]
    payload: float = 0.0  # kg, at the flange or between the fingers

    def catalogue(self) -> dict[str, object]:
        """What is written down of it: all that is said."""
        said = {
            "kind": self.kind,
            "about": self.about,
            "home": dict(self.home),
            "flange": self.flange,
            "tool": self.tool,
            "closed": dict(self.closed),
            "width": list(self.width) if any(self.width) else [],
            "payload": self.payload,
        }
        return {key: value for key, value in said.items() if value}


def link(name: str, parts: list[Part], *, friction: float | None = None) -> Link:
    """A link that collides as it looks; a frame without mass if it has no parts."""
    if not parts:
        return Link(name)
    solid = [part for part in parts if not part.seen_only]
    mass, com, moments, products = mass_properties([(part.shape, DENSITIES[part.made_of]) for part in solid])
    return Link(
        name,
        mass,
        com,
        moments,
        [part.shape for part in solid],
        looks=[(part.shape, part.colour) for part in parts],
        contact={} if friction is None else {"lateral_friction": friction},
        products=products,
    )


def frame(
    name: str, parent: str, xyz: tuple[float, float, float], rpy: tuple[float, float, float] = ZERO
) -> tuple[Link, Joint]:
    """A link without mass, and the joint that fixes it."""
    return Link(name), Joint(f"{name}_joint", "fixed", parent, name, xyz, rpy)


def robot(name: str, links: list[Link], joints: list[Joint]) -> Robot:
    """With the colours that it uses."""
    used = dict.fromkeys(colour for made in links for _, colour in made.looks)
    return Robot(name, SCRIPT, {colour: COLOURS[colour] for colour in used}, links, joints)
