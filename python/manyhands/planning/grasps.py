"""Where a gripper of two parallel jaws can take hold of things, and how well."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model, World
from manyhands._core import planning as _core
from manyhands.arguments import bounded, finite_row, finite_rows, instance, number, real_array, whole_number
from manyhands.collision import Shape
from manyhands.planning.scene import names, state_of

Array = NDArray[np.float64]

_LARGEST_SEED = 2**63 - 1
_MOST_SAMPLES = 1_000_000
_MOST_APPROACHES = 10_000


@dataclass(frozen=True)
class ParallelGripper:
    """Two jaws that slide along y of a frame G between their pads; z points away from the palm. Jaws and palm are
    boxes. As it is, it holds `robots.load("parallel")`, whose "tool" is G. All in metres. Raises ValueError unless all
    are above 0."""

    opening: float = 0.08
    """between the pads, at most"""
    depth: float = 0.048
    """from G back to the palm"""
    reach: float = 0.0145
    """from G to the tips"""
    width: float = 0.022
    """of a jaw along x, and of the round pad that touches"""
    thickness: float = 0.022
    """of a jaw along y"""
    palm: tuple[float, float, float] = (0.05, 0.15, 0.056)
    """the size of the box behind the jaws"""

    def __post_init__(self) -> None:
        _gripper(self)


class Grasps(NamedTuple):
    """n ways to take hold of something, the best first."""

    position: Array
    """(n, 3) of the gripper's frame G [m]"""
    quaternion: Array
    """(n, 4) xyzw of G"""
    width: Array
    """(n,) between the contacts [m]"""
    quality: Array
    """(n,) the epsilon metric, 0 to 1: the largest wrench in any direction that friction balances, where the normal
    forces sum up to 1 and moments are divided by the radius of a ball about the centre of mass that holds the object"""
    margin: Array
    """(n,) by which the worse contact lies within its friction cone [rad]"""
    points: Array
    """(n, 2, 3) where the jaws touch [m]"""
    normals: Array
    """(n, 2, 3) of the surface there, unit, outwards"""

    def only(self, chosen: ArrayLike) -> "Grasps":
        """Those at indices, or where a mask (n,) is true. Raises ValueError on anything else."""
        picked, n = real_array("chosen", chosen), len(self.width)
        is_mask = picked.dtype.kind == "b" and picked.shape == (n,)
        if not is_mask and not (
            picked.size == 0 or (picked.dtype.kind in "iu" and -n <= picked.min() <= picked.max() < n)
        ):
            raise ValueError(f"chosen is {chosen}; expected a mask ({n},), or indices below {n}")
        return Grasps(*(rows[picked if picked.size else []] for rows in self))


def grasps(
    shape: Shape, gripper: ParallelGripper | None = None, *, com: ArrayLike = (0.0, 0.0, 0.0), **options: Any
) -> Grasps:
    """Antipodal grasps of a shape, in its own frame. com: its centre of mass (3,) there [m]. options: as `grasps_in`.

    The shape is a solid, or a closed mesh. Raises ValueError on planes and height fields, and as `grasps_in` does.
    """
    if not isinstance(shape, Shape):
        raise ValueError(f"shape is {shape!r}; expected one of manyhands.collision")
    centre = _three("com", com)
    return Grasps(*_core.grasps_of_shape(shape, centre, _gripper(gripper), _settings(**options)))


def grasps_in(
    scene: World | Model,
    link: str,
    gripper: ParallelGripper | None = None,
    *,
    obstacles: Iterable[str] = (),
    q: ArrayLike | None = None,
    **options: Any,
) -> Grasps:
    """Antipodal grasps of a link where it is, in the world: the line through both contacts lies within both friction
    cones (Nguyen 1988). Open jaws and the palm touch neither the link nor the obstacles.

    scene: a world, or a model with its configuration q (nq,). obstacles: a link's name, or several, as the table's.

    Options: friction of the pads, 0.5. samples, 100: points of the surface that are tried. approaches, 8: directions
    around each pair of contacts. approach (3,), (0, 0, -1): how the gripper's z should point; tilt, pi: how far it may
    point elsewhere [rad]. clearance, 0.005: of each jaw from its contact before it closes [m]. seed, 0: the same seed
    gives the same grasps. Quality by Ferrari and Canny (1992), of soft fingers, friction along 8 edges; of equal ones
    those nearer to the centre of mass come first, then those nearer to `approach`.

    Raises ValueError on a link without shapes and on numbers that make no sense, KeyError on unknown links.
    """
    model, now, mocap = state_of(scene, q)
    found: Any = _core.grasps_of_link(
        model, now, mocap, link, names("obstacles", obstacles), _gripper(gripper), _settings(**options)
    )
    return Grasps(*found)


def epsilon_quality(
    points: ArrayLike,
    normals: ArrayLike,
    *,
    friction: ArrayLike = 0.5,
    torsion: ArrayLike = 0.0,
    about: ArrayLike = (0.0, 0.0, 0.0),
    length: float = 1.0,
    edges: int = 8,
) -> float:
    """How well contacts hold: the largest wrench, in any direction, that they can balance with normal forces that sum
    up to 1; 0 where one direction is free (Ferrari, Canny: Planning optimal grasps, 1992).

    points (m, 3) [m]; normals (m, 3) into the object, the way fingers push. friction: 1 or (m,). torsion: 1 or (m,)
    [m], moment about the normal per normal force of a soft finger. Moments are about `about` (3,), divided by `length`
    [m]. edges: directions in which friction is exact; between them it counts less. Exact for these, by the convex hull.
    """
    p, n = finite_rows("points", points, 3), finite_rows("normals", normals, 3)
    if p.ndim != 2 or n.shape != p.shape:
        raise ValueError(f"points have shape {p.shape} and normals {n.shape}; expected (m, 3) of both")
    lengths = np.linalg.norm(n, axis=1, keepdims=True)
    if not (lengths > 0).all():
        raise ValueError("a normal is 0; expected directions")
    return _core.epsilon_quality(
        np.ascontiguousarray(p),
        np.ascontiguousarray(n / lengths),
        bounded("friction", friction, len(p), least=0),
        bounded("torsion", torsion, len(p), least=0),
        _three("about", about),
        number("length", length, above=0),
        whole_number("edges", edges, 3, 1000),
    )


def _settings(
    *,
    friction: float = 0.5,
    samples: int = 100,
    approaches: int = 8,
    approach: ArrayLike = (0.0, 0.0, -1.0),
    tilt: float = math.pi,
    clearance: float = 0.005,
    seed: int = 0,
) -> Any:
    return _core.GraspSettings(
        number("friction", friction),
        whole_number("samples", samples, 1, _MOST_SAMPLES),
        whole_number("approaches", approaches, 1, _MOST_APPROACHES),
        _three("approach", approach),
        number("tilt", tilt, infinite=True),
        number("clearance", clearance),
        whole_number("seed", seed, 0, _LARGEST_SEED),
    )


def _gripper(gripper: ParallelGripper | None) -> Any:
    given = ParallelGripper() if gripper is None else instance("gripper", gripper, ParallelGripper)
    lengths = [number(name, getattr(given, name)) for name in ("opening", "depth", "reach", "width", "thickness")]
    return _core.Gripper(*lengths, _three("the gripper's palm", given.palm))


def _three(name: str, values: ArrayLike) -> tuple[float, float, float]:
    x, y, z = finite_row(name, values, 3).tolist()
    return x, y, z
