"""What the names of a simulation stand for: robots from files, and single shapes."""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from manyhands import rotations
from manyhands._core import Model, ModelBuilder, asset_path, load_urdf
from manyhands.rotations import Array

ShapeName = Literal["box", "cylinder", "sphere"]

_ASSETS = {"franka_panda/panda.urdf": "panda/panda.urdf"}
_FRICTION = 0.5


@dataclass
class Look:
    """What a shape looks like: colour (r, g, b, a) in [0, 1], specular colour (r, g, b), a texture's path."""

    rgba: tuple[float, ...] = (1.0, 1.0, 1.0, 1.0)
    specular: tuple[float, ...] = (0.0, 0.0, 0.0)
    texture: Path | None = None


@dataclass
class Pose:
    """Of a link's frame in the world: position (3) [m], quaternion (4)."""

    position: Array
    quaternion: Array


@dataclass
class Body:
    """Index 0 of the lists is the base, PyBullet's link -1; index i + 1 its link i."""

    links: list[str]
    """Their names in the world."""
    coms: list[Array]
    """Centres of mass in the links' frames [m]."""
    joints: list[str | None]
    """Names in the world of the joints that move each link on its parent; None where it is fixed, and of the base."""
    pose: Pose | None
    """Of the base, if it does not move by itself."""
    in_world: bool = True
    """False of ghosts without mass: they only have a pose."""
    model: Model | None = None
    """Of the robot alone, its base fixed."""
    shape: tuple[ShapeName, tuple[float, ...]] | None = None
    """A single shape and its sizes, as ModelBuilder takes them."""
    look: Look = field(default_factory=Look)

    @property
    def is_free_shape(self) -> bool:
        """Whether it is a single shape that moves by itself."""
        return self.shape is not None and self.pose is None

    def __deepcopy__(self, memo: dict[int, Any]) -> "Body":
        """Only `pose` ever changes, and that by another."""
        return copy(self)


def find_urdf(file_name: str) -> Path:
    """A robot's file: in the working folder, or among those that ship with the package.

    Raises FileNotFoundError. "franka_panda/panda.urdf", as PyBullet's data calls it, is the package's own Panda.
    """
    path = Path(file_name)
    if path.is_file():
        return path
    try:
        return asset_path(_ASSETS.get(path.as_posix(), path))
    except (FileNotFoundError, RuntimeError) as reason:
        raise FileNotFoundError(f"there is no robot {file_name!r}, neither here nor in the package") from reason


def load_robot(path: Path, fixed_base: bool) -> Model:
    """The model of a URDF file; models of unchanged files are shared. Raises FileNotFoundError, UrdfError."""
    path = path.resolve()
    return _load_robot(path, path.stat().st_mtime_ns, fixed_base)


@lru_cache(maxsize=16)
def _load_robot(path: Path, _changed: int, fixed_base: bool) -> Model:
    return load_urdf(path, fixed_base=fixed_base)[0]


def robot(name: str, model: Model, alone: Model, pose: Pose) -> Body:
    """The body of a model that the world knows as `name`, its base at `pose`; `alone` is the same with a fixed base."""
    joint = model.joints[model.links[1].joint] if len(model.links) > 1 and model.links[1].joint >= 0 else None
    floats = joint is not None and joint.name == "root_joint"
    # A root link called `world` is the world itself, and link 1 hangs on it by a joint of the file.
    links = model.links[0 if joint is not None and not floats else 1 :]
    moved_by = [model.joints[link.joint] for link in links[1:]]
    return Body(
        links=[link.name if link.name == "world" else f"{name}/{link.name}" for link in links],
        coms=[link.com for link in links],
        joints=[None, *(f"{name}/{joint.name}" if joint.nv else None for joint in moved_by)],
        pose=None if floats else pose,
        model=alone,
    )


def shape(
    kind: ShapeName, sizes: Sequence[float], mass: float, position: ArrayLike, name: str, ghost: bool, look: Look
) -> tuple[Body, ModelBuilder | None]:
    """A body of one uniform shape, and what makes it part of a world: None for a ghost without mass.

    sizes: those of a box, cylinder or sphere as `ModelBuilder.add_geom` takes them [m]. mass [kg]: 0 for one that does
    not move. position (3) [m]: of its centre. Raises ValueError on a size that is not above 0 or a negative mass.
    """
    sizes = tuple(float(size) for size in sizes)
    if not all(0 < size < np.inf for size in sizes):
        raise ValueError(f"body {name!r}: a {kind} has the sizes {sizes}; expected numbers above 0")
    if not 0 <= mass < np.inf:
        raise ValueError(f"body {name!r}: mass is {mass} kg; expected 0, for a body that stays, or more")
    pose = Pose(np.array(position, np.float64).reshape(3), rotations.IDENTITY)
    body = Body([name], [np.zeros(3)], [None], pose, shape=(kind, sizes), look=look)
    if ghost and mass == 0:
        body.in_world = False
        return body, None
    builder = ModelBuilder(name)
    builder.set_contact_rules(friction="product", restitution="product", self_collision=False)
    builder.add_link(name, mass=mass, inertia=mass * np.diag(_moments(kind, sizes)))
    if mass > 0:
        body.pose = None
        builder.add_joint(f"{name}_free", "floating", "world", name, initial=[*pose.position, *pose.quaternion])
    builder.add_geom(name, kind, sizes, name=name, friction=_FRICTION, visual=ghost, rgba=look.rgba)
    return body, builder


def _moments(kind: ShapeName, sizes: tuple[float, ...]) -> tuple[float, float, float]:
    """Of inertia, principal, for a mass of 1 [m²]."""
    if kind == "sphere":
        moment = 0.4 * sizes[0] ** 2
        return moment, moment, moment
    if kind == "cylinder":
        radius, half_length = sizes
        across = radius**2 / 4 + half_length**2 / 3
        return across, across, radius**2 / 2
    x, y, z = (size**2 / 3 for size in sizes)
    return y + z, x + z, x + y
