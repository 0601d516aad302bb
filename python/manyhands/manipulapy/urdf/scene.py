"""Several robots in one world."""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands import kinematics
from manyhands._core import World
from manyhands.manipulapy.urdf.tree import URDF
from manyhands.manipulapy.utils import euler_to_rotation_matrix

Array = NDArray[np.float64]
Configuration: TypeAlias = "ArrayLike | Mapping[str, float]"

__all__ = ["RobotInstance", "Scene"]


@dataclass
class RobotInstance:
    """A robot in a scene. base_transform: (4, 4) of its root in the world; namespace: before the names of its parts."""

    name: str
    urdf: URDF
    base_transform: Array = field(default_factory=lambda: np.eye(4))
    namespace: str = ""

    def __post_init__(self) -> None:
        self.base_transform = _rigid(self.base_transform)

    @property
    def prefixed_link_names(self) -> list[str]:
        return [self._prefixed(link.name) for link in self.urdf.links]

    @property
    def prefixed_joint_names(self) -> list[str]:
        return [self._prefixed(joint.name) for joint in self.urdf.joints]

    def _prefixed(self, name: str) -> str:
        return f"{self.namespace}/{name}" if self.namespace else name


class Scene:
    """Robots by name. Angles are given for each: in order or by joint, 0 for a robot that is left out. Unknown robots
    raise ValueError."""

    def __init__(self, name: str = "scene") -> None:
        self.name = name
        self._robots: dict[str, RobotInstance] = {}

    @classmethod
    def from_urdfs(
        cls,
        urdfs: "Mapping[str, str | PathLike[str] | URDF]",
        base_transforms: Mapping[str, ArrayLike] | None = None,
        name: str = "scene",
    ) -> "Scene":
        """Of robots or their files, each at its base transform (4, 4) or at the origin."""
        scene = cls(name)
        for robot, urdf in urdfs.items():
            loaded = urdf if isinstance(urdf, URDF) else URDF.load(urdf)
            scene.add_robot(robot, loaded, (base_transforms or {}).get(robot))
        return scene

    def add_robot(
        self,
        name: str,
        urdf: URDF,
        base_transform: ArrayLike | None = None,
        base_xyz: ArrayLike | None = None,
        base_rpy: ArrayLike | None = None,
        namespace: str | None = None,
    ) -> "Scene":
        """Adds one whose root is at a pose (4, 4), else at a position (3,) [m] with roll, pitch and yaw [rad]; the
        namespace is its name by default. Raises ValueError on a name that is taken."""
        if name in self._robots:
            raise ValueError(f"there is a robot {name!r} already")
        base = _base(base_transform, base_xyz, base_rpy)
        self._robots[name] = RobotInstance(name, urdf, base, namespace or name)
        return self

    def remove_robot(self, name: str) -> "Scene":
        self.get_robot(name)
        del self._robots[name]
        return self

    def get_robot(self, name: str) -> RobotInstance:
        if name not in self._robots:
            raise ValueError(f"there is no robot {name!r}; there are {', '.join(self._robots) or 'none'}")
        return self._robots[name]

    @property
    def robots(self) -> dict[str, RobotInstance]:
        """All, by name; a copy."""
        return dict(self._robots)

    @property
    def robot_names(self) -> list[str]:
        return list(self._robots)

    def set_base_transform(
        self,
        name: str,
        base_transform: ArrayLike | None = None,
        base_xyz: ArrayLike | None = None,
        base_rpy: ArrayLike | None = None,
    ) -> "Scene":
        """Puts a robot elsewhere, as `add_robot` does."""
        self.get_robot(name).base_transform = _base(base_transform, base_xyz, base_rpy)
        return self

    # ---- where things are --------------------------------------------------------------------------------------

    def world_link_fk(
        self, configurations: Mapping[str, Configuration], links: Mapping[str, list[str]] | None = None
    ) -> dict[str, dict[str, Array]]:
        """{robot: {link: pose (4, 4) in the world}} of the robots that are named, and of each the links that are."""
        found: dict[str, dict[str, Array]] = {}
        for name, angles in configurations.items():
            robot = self.get_robot(name)
            poses = robot.urdf.link_fk(angles, links=(links or {}).get(name), use_names=True)
            found[name] = {link: robot.base_transform @ pose for link, pose in poses.items()}
        return found

    def world_end_effector_fk(self, configurations: Mapping[str, Configuration]) -> dict[str, Array]:
        """{robot: pose (4, 4) of its end effector in the world}."""
        tips = {name: self.get_robot(name).urdf.end_effector_link for name in configurations}
        poses = self.world_link_fk(configurations, {name: [tip] for name, tip in tips.items()})
        return {name: poses[name][tip] for name, tip in tips.items()}

    def get_all_collision_geometry(
        self, configurations: Mapping[str, Configuration] | None = None
    ) -> list[dict[str, Any]]:
        """{"robot", "link", "geometry", "transform"} of every shape that touches: a `Geom` of manyhands, and its pose
        (4, 4) in the world."""
        return self._shapes(configurations, visual=False)

    def get_all_visual_geometry(
        self, configurations: Mapping[str, Configuration] | None = None
    ) -> list[dict[str, Any]]:
        """The same of every shape that is seen only."""
        return self._shapes(configurations, visual=True)

    def _shapes(self, configurations: Mapping[str, Configuration] | None, visual: bool) -> list[dict[str, Any]]:
        poses = self.world_link_fk(self._all(configurations))
        found: list[dict[str, Any]] = []
        for name, robot in self._robots.items():
            model = robot.urdf.model
            for geom in model.geoms:
                if geom.is_visual == visual:
                    link = model.links[geom.link].name
                    T = poses[name][link] @ kinematics.matrix(geom.position, geom.quaternion)
                    found.append({"robot": name, "link": link, "geometry": geom, "transform": T})
        return found

    def check_inter_robot_collision(
        self, configurations: Mapping[str, Configuration]
    ) -> list[tuple[str, str, str, str]]:
        """(robot, link, other robot, its link) of all that touch, by the engine's exact shapes. Links of one robot do
        not count."""
        for name in configurations:
            self.get_robot(name)
        world, links = self._world(configurations)
        found: list[tuple[str, str, str, str]] = []
        for one, other in itertools.combinations(self._robots, 2):
            for a, b in itertools.product(links[one], links[other]):
                distance = world.distance(f"{one}/{a}", f"{other}/{b}")
                if distance is not None and distance.phi < 0:
                    found.append((one, a, other, b))
        return found

    def _world(self, configurations: Mapping[str, Configuration]) -> tuple[World, dict[str, list[str]]]:
        """All robots at their angles, and the links of each that have shapes."""
        world, links = World(), dict[str, list[str]]()
        for name, robot in self._robots.items():
            world.add(robot.urdf.model, *kinematics.pose(robot.base_transform), name=name)
        q = world.q.copy()
        for name, angles in self._all(configurations).items():
            urdf = self._robots[name].urdf
            at = [world.model.joint(f"{name}/{joint}").iq for joint in urdf.actuated_joint_names]
            q[at] = urdf.configuration(angles)[[joint.iq for joint in urdf.actuated_joints]]
            touching = {geom.link for geom in urdf.model.geoms if not geom.is_visual}
            links[name] = [urdf.model.links[k].name for k in sorted(touching)]
        world.q = q
        return world, links

    def _all(self, configurations: Mapping[str, Configuration] | None) -> dict[str, Any]:
        given = configurations or {}
        return {name: given.get(name, np.zeros(robot.urdf.num_dofs)) for name, robot in self._robots.items()}

    def __repr__(self) -> str:
        return f"Scene({self.name!r}, robots={self.robot_names})"


def _base(transform: ArrayLike | None, xyz: ArrayLike | None, rpy: ArrayLike | None) -> Array:
    if transform is not None:
        return _rigid(transform)
    T = np.eye(4)
    T[:3, 3] = 0.0 if xyz is None else np.asarray(xyz, np.float64)
    T[:3, :3] = euler_to_rotation_matrix(np.zeros(3) if rpy is None else np.degrees(rpy))
    return T


def _rigid(transform: ArrayLike) -> Array:
    return kinematics.matrix(*kinematics.pose(transform))
