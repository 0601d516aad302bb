"""Potential fields that lead to a goal, and a robot's collisions with itself."""

import itertools
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import World
from manyhands._core import planning as _planning
from manyhands.manipulapy.urdf import URDF

Array = NDArray[np.float64]

__all__ = ["CollisionChecker", "PotentialField", "build_link_adjacency"]

_TOUCHING = 1e-6  # [m]: closed fingers touch, and do not collide
_REPULSION = 40.0  # ManipulaPy's potential is 20 gain (1 / d - 1 / d0)²; ours a half gain


class PotentialField:
    """In a space of any dimension k: a goal pulls with half the attractive gain times the squared distance; obstacles
    nearer than influence_distance push with 20 times the repulsive gain times (1 / d - 1 / influence_distance)²."""

    def __init__(
        self, attractive_gain: float = 1.0, repulsive_gain: float = 100.0, influence_distance: float = 0.5
    ) -> None:
        self.attractive_gain, self.repulsive_gain = attractive_gain, repulsive_gain
        self.influence_distance = influence_distance

    def _field(self, q: ArrayLike, goal: ArrayLike, obstacles: Any) -> Any:
        at = np.asarray(q, np.float64).ravel()
        rows = np.asarray([] if obstacles is None else obstacles, np.float64).reshape(-1, len(at))
        gains = self.attractive_gain, _REPULSION * self.repulsive_gain, self.influence_distance
        return _planning.potential_field(*gains, at, np.asarray(goal, np.float64).ravel(), rows)

    def compute_attractive_potential(self, q: ArrayLike, q_goal: ArrayLike) -> float:
        return self._field(q, q_goal, None)[0]

    def compute_repulsive_potential(self, q: ArrayLike, obstacles: ArrayLike | None) -> float:
        """Of obstacles (m, k); 0 without any."""
        return self._field(q, q, obstacles)[1]

    def compute_gradient(self, q: ArrayLike, q_goal: ArrayLike, obstacles: ArrayLike | None) -> Array:
        """(k,) of the sum. On an obstacle itself it is bounded, along the first axis."""
        return self._field(q, q_goal, obstacles)[2]


def build_link_adjacency(urdf: URDF, exclude_grandparents: bool = True) -> set[frozenset[str]]:
    """The pairs of links that a joint joins, and those with one link between."""
    parent = {urdf._child(joint): urdf._parent(joint) for joint in urdf.joints}
    pairs = {frozenset(pair) for pair in parent.items()}
    if exclude_grandparents:
        pairs |= {frozenset((child, parent[above])) for child, above in parent.items() if above in parent}
    return pairs


class CollisionChecker:
    """Whether a robot touches itself: the shapes of its description, primitives and convex hulls of meshes, as the
    engine sees them. Links that are joined by a joint, or with one link between, do not count."""

    def __init__(self, urdf_path: str, backend: str = "builtin", load_meshes: bool = True) -> None:
        self.robot = URDF.load(urdf_path, load_meshes=load_meshes, backend=backend)
        self.excluded = build_link_adjacency(self.robot)
        self._world = World(self.robot.model)
        pairs = itertools.combinations(sorted(self.convex_hulls), 2)
        self._pairs = [pair for pair in pairs if frozenset(pair) not in self.excluded]

    @property
    def convex_hulls(self) -> dict[str, list[str]]:
        """The shapes of each link that has any, by their kinds."""
        found: dict[str, list[str]] = {}
        for geom in self.robot.model.geoms:
            if not geom.is_visual:
                found.setdefault(self.robot.model.links[geom.link].name, []).append(geom.shape)
        return found

    def check_collision(self, thetalist: "ArrayLike | Mapping[str, float]") -> bool:
        """Whether two links that are not neighbours touch at these angles, in order or by name."""
        self._world.q = self.robot.configuration(thetalist)
        distances = (self._world.distance(*pair) for pair in self._pairs)
        return any(found is not None and found.phi < -_TOUCHING for found in distances)
