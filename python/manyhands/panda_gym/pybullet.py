"""The class PyBullet of panda-gym, over a `manyhands.World`."""

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands import rotations
from manyhands._core import UrdfError, World
from manyhands._core.render import Camera
from manyhands.envs.cameras import orbit_camera
from manyhands.panda_gym import bodies, load_flags, rendering
from manyhands.panda_gym.assets import get_data_path
from manyhands.panda_gym.bodies import Look, Pose, ShapeName
from manyhands.panda_gym.simulation import Simulation, error
from manyhands.rotations import Array

__all__ = ["PyBullet", "error"]

_GUI, _DIRECT = 1, 2
_BACKGROUND = (223.0, 54.0, 45.0)


class PyBullet:
    """A simulation whose bodies are addressed by name.

    Positions are in metres and world axes, z up; orientations are quaternions (x, y, z, w); links and joints are
    numbered as PyBullet does, -1 being the base. Unknown names raise KeyError; unknown links, joints and states, and
    whatever is asked of a closed simulation, raise `error`.

    A world holds its own clock, `timestep` [s], of which `n_substeps` make a `step`. `world` is the `manyhands.World`
    that all this moves: contacts, forces and parameters are there. `real_time` False lets human rendering run freely.
    """

    def __init__(
        self,
        render_mode: str | bool = "rgb_array",
        n_substeps: int = 20,
        background_color: ArrayLike | None = None,
        renderer: str = "Tiny",
        *,
        render: bool | None = None,
        timestep: float = 0.002,
    ) -> None:
        """`render`, or a bool in the first place, is the interface of panda-gym 2: robots and tasks in it belong to
        environments in the manner of the old gym. background_color (3): 0 to 255, drawn if it is given."""
        if isinstance(render_mode, bool):
            render, render_mode = render_mode, "rgb_array"
        self.is_version_2 = render is not None
        self.render_mode: str = "human" if render else render_mode
        rendering.require_mode(self.render_mode, renderer)
        self.connection_mode = _DIRECT if (self.render_mode, renderer) == ("rgb_array", "Tiny") else _GUI
        color = np.asarray(_BACKGROUND if background_color is None else background_color, np.float32)
        self.background_color = color / np.float32(255)
        self.background = None if background_color is None else self.background_color
        """(3) 0 to 1, behind the scene; None: a sky."""
        self.n_substeps = n_substeps
        self.timestep = timestep
        self.real_time = True
        self._bodies_idx: dict[str, int] = {}
        self._display = rendering.Display()
        self._simulation: Simulation | None = Simulation(timestep)

    @property
    def physics_client(self) -> Simulation:
        """What does the work; not PyBullet's client."""
        if self._simulation is None:
            raise error("not connected to a simulation: it has been closed")
        return self._simulation

    @property
    def world(self) -> World:
        """The world of all bodies that collide or move."""
        return self.physics_client.world

    @property
    def dt(self) -> float:
        """What a `step` takes [s]."""
        return self.timestep * self.n_substeps

    def step(self) -> None:
        """Advances by n_substeps time steps."""
        self.physics_client.step(self.n_substeps)

    def close(self) -> None:
        """Ends the simulation; may be called again."""
        self._display.close()
        self._simulation = None

    def forget(self) -> None:
        """Holds all joints where they are, and clears the solver's warm start: what follows depends on poses and
        velocities alone. Environments do it in each reset; panda-gym does not."""
        self.physics_client.forget()

    def save_state(self) -> int:
        """Keeps the state of all bodies, and the motors; gives the smallest number that is not in use."""
        return self.physics_client.save()

    def restore_state(self, state_id: int) -> None:
        """Goes back to a saved state, bit for bit."""
        self.physics_client.restore(state_id)

    def remove_state(self, state_id: int) -> None:
        """Forgets a saved state; passes over one that is not there."""
        self.physics_client.remove(state_id)

    # ---- rendering -----------------------------------------------------------------------------------------------

    @overload
    def render(
        self,
        width: int = 720,
        height: int = 480,
        target_position: ArrayLike | None = None,
        distance: float = 1.4,
        yaw: float = 45,
        pitch: float = -30,
        roll: float = 0,
        *,
        mode: str | None = None,
    ) -> NDArray[np.uint8] | None: ...

    @overload
    def render(
        self,
        mode: str,
        width: int = 720,
        height: int = 480,
        target_position: ArrayLike | None = None,
        distance: float = 1.4,
        yaw: float = 45,
        pitch: float = -30,
        roll: float = 0,
    ) -> NDArray[np.uint8] | None: ...

    def render(self, *args: Any, mode: str | None = None, **kwargs: Any) -> NDArray[np.uint8] | None:
        """In human mode, a page in the browser, in real time; in rgb_array mode, a picture (height, width, 3), angles
        in degrees.

        mode: that of the constructor, or "human" in the manner of panda-gym 2, where it comes first.
        """
        if args and isinstance(args[0], str) and mode is None:
            mode, args = args[0], args[1:]
        mode = mode or ("human" if self.is_version_2 else self.render_mode)
        rendering.require_mode(mode, "Tiny")
        simulation, camera = self.physics_client, _camera(*args, **kwargs)
        if mode == "rgb_array":
            return rendering.picture(simulation.world, simulation.bodies.values(), camera, self.background)
        self._display.show(self, simulation.world.time, self.real_time)
        return None

    @contextmanager
    def no_rendering(self) -> Iterator[None]:
        """Suspends the window within this context."""
        yield

    def place_visualizer(self, target_position: ArrayLike, distance: float, yaw: float, pitch: float) -> None:
        """Turns the page's camera, in human mode: it looks at target_position (3) from a distance [m], angles in
        degrees."""
        self._display.look(target_position, distance, yaw, pitch)

    # ---- bases ---------------------------------------------------------------------------------------------------

    def get_base_position(self, body: str) -> Array:
        """Of the base's centre of mass (3)."""
        return self.physics_client.center(body, -1)[0]

    def get_base_orientation(self, body: str) -> Array:
        """Quaternion (4)."""
        return self.physics_client.center(body, -1)[1]

    def get_base_rotation(self, body: str, type: str = "euler") -> Array:
        """Roll, pitch, yaw (3) [rad] with `type` "euler", the quaternion (4) with "quaternion"."""
        if type not in ("euler", "quaternion"):
            raise ValueError(f"type is {type!r}, expected 'euler' or 'quaternion'")
        quaternion = self.get_base_orientation(body)
        return rotations.to_euler(quaternion) if type == "euler" else quaternion

    def get_base_velocity(self, body: str) -> Array:
        """Of the base's centre of mass (3) [m/s]."""
        return self.physics_client.velocity(body, -1)[1]

    def get_base_angular_velocity(self, body: str) -> Array:
        """(3) [rad/s]."""
        return self.physics_client.velocity(body, -1)[0]

    def set_base_pose(self, body: str, position: ArrayLike, orientation: ArrayLike) -> None:
        """Puts the base's centre of mass at `position` (3), at rest. orientation: a quaternion (4), or roll, pitch, yaw
        (3) [rad]."""
        self.physics_client.place(body, position, rotations.as_quaternion(orientation))

    # ---- links ---------------------------------------------------------------------------------------------------

    def get_link_position(self, body: str, link: int) -> Array:
        """Of the link's centre of mass (3)."""
        return self.physics_client.center(body, link)[0]

    def get_link_orientation(self, body: str, link: int) -> Array:
        """Quaternion (4)."""
        return self.physics_client.center(body, link)[1]

    def get_link_velocity(self, body: str, link: int) -> Array:
        """Of the link's centre of mass (3) [m/s]."""
        return self.physics_client.velocity(body, link)[1]

    def get_link_angular_velocity(self, body: str, link: int) -> Array:
        """(3) [rad/s]."""
        return self.physics_client.velocity(body, link)[0]

    # ---- joints --------------------------------------------------------------------------------------------------

    def get_joint_angle(self, body: str, joint: int) -> float:
        """[rad], or [m] of a prismatic joint."""
        return self.physics_client.joint_state(body, joint)[0]

    def get_joint_velocity(self, body: str, joint: int) -> float:
        """[rad/s], or [m/s] of a prismatic joint."""
        return self.physics_client.joint_state(body, joint)[1]

    def set_joint_angle(self, body: str, joint: int, angle: float) -> None:
        """Teleports a joint, at rest, beyond its limits if need be. Its motor keeps its target."""
        self.physics_client.set_joints(body, [joint], [angle])

    def set_joint_angles(self, body: str, joints: Sequence[int] | NDArray[Any], angles: ArrayLike) -> None:
        """Teleports joints (n) to angles (n), at rest."""
        self.physics_client.set_joints(body, joints, np.asarray(angles, np.float64).reshape(-1))

    def control_joints(self, body: str, joints: ArrayLike, target_angles: ArrayLike, forces: ArrayLike) -> None:
        """Drives joints (n) to target angles (n) with at most forces (n) [N m or N], until they are driven elsewhere:
        each time step takes a tenth of the way."""
        self.physics_client.drive_joints(body, joints, target_angles, forces)

    def inverse_kinematics(self, body: str, link: int, position: ArrayLike, orientation: ArrayLike) -> Array:
        """Positions of all movable joints, by index, that bring the link's frame closer to a pose. Starts from where
        they are, moves nothing. Damped so heavily that it falls short: panda-gym's actions mean this."""
        return self.physics_client.reach(body, link, position, rotations.as_quaternion(orientation))

    # ---- new bodies ----------------------------------------------------------------------------------------------

    def loadURDF(  # noqa: N802  PyBullet's name
        self,
        body_name: str,
        fileName: str,
        basePosition: ArrayLike = (0.0, 0.0, 0.0),
        baseOrientation: ArrayLike = (0.0, 0.0, 0.0, 1.0),
        useFixedBase: bool = False,
        flags: int = 0,
        globalScaling: float = 1.0,
        useMaximalCoordinates: bool = False,
    ) -> None:
        """Loads a robot, its root link's frame at a position (3) and quaternion (4).

        fileName: in the working folder, or one that ships with the package, as "franka_panda/panda.urdf". flags: those
        of PyBullet; one that changes nothing here says so in a warning. Raises `error` if the file is not there or
        malformed, and on what cannot be honoured: other flags, a globalScaling other than 1.
        """
        load_flags.require_honoured(int(flags))
        if globalScaling not in (1, -1):  # -1 is PyBullet's own default
            raise error(f"globalScaling is {globalScaling}, but robots keep their size here: scale the file itself")
        if useMaximalCoordinates and useMaximalCoordinates != -1:
            warnings.warn("useMaximalCoordinates has no effect here: joints are never given up", UserWarning, 2)
        pose = Pose(np.array(basePosition, np.float64), rotations.as_quaternion(baseOrientation))
        try:
            path = bodies.find_urdf(fileName)
            self.physics_client.add_robot(body_name, path, pose, bool(useFixedBase))
        except (FileNotFoundError, UrdfError) as reason:
            raise error(f"cannot load {fileName!r}: {reason}") from reason
        self._bodies_idx[body_name] = len(self._bodies_idx)

    def create_box(
        self,
        body_name: str,
        half_extents: ArrayLike,
        mass: float,
        position: ArrayLike,
        rgba_color: ArrayLike | None = None,
        specular_color: ArrayLike | None = None,
        ghost: bool = False,
        lateral_friction: float | None = None,
        spinning_friction: float | None = None,
        texture: str | None = None,
    ) -> None:
        """A box: half_extents (3), its centre at position (3).

        mass [kg]: 0 for a body that stays. rgba_color (4) and specular_color (3) in [0, 1]; without a colour it is
        white. ghost: seen, but touches nothing. lateral_friction: 0.5 unless given; two surfaces slide by the product
        of theirs. texture: a file in the package's assets, or anywhere by its full path.
        """
        look = _look(rgba_color, specular_color, texture)
        sizes = np.asarray(half_extents, np.float64).reshape(3).tolist()
        self._create(body_name, "box", sizes, mass, position, ghost, look, lateral_friction, spinning_friction)

    def create_cylinder(
        self,
        body_name: str,
        radius: float,
        height: float,
        mass: float,
        position: ArrayLike,
        rgba_color: ArrayLike | None = None,
        specular_color: ArrayLike | None = None,
        ghost: bool = False,
        lateral_friction: float | None = None,
        spinning_friction: float | None = None,
    ) -> None:
        """A cylinder along z, of full height; the other arguments as in `create_box`."""
        look, sizes = _look(rgba_color, specular_color), [radius, height / 2]
        self._create(body_name, "cylinder", sizes, mass, position, ghost, look, lateral_friction, spinning_friction)

    def create_sphere(
        self,
        body_name: str,
        radius: float,
        mass: float,
        position: ArrayLike,
        rgba_color: ArrayLike | None = None,
        specular_color: ArrayLike | None = None,
        ghost: bool = False,
        lateral_friction: float | None = None,
        spinning_friction: float | None = None,
    ) -> None:
        """A sphere; the other arguments as in `create_box`."""
        look = _look(rgba_color, specular_color)
        self._create(body_name, "sphere", [radius], mass, position, ghost, look, lateral_friction, spinning_friction)

    def create_plane(self, z_offset: float) -> None:
        """The body "plane": a fixed slab of 6 m by 6 m whose top is at z_offset."""
        self.create_box("plane", (3.0, 3.0, 0.01), 0.0, (0.0, 0.0, z_offset - 0.01), rgba_color=(0.15, 0.15, 0.15, 1.0))

    def create_table(
        self,
        length: float,
        width: float,
        height: float,
        x_offset: float = 0.0,
        lateral_friction: float | None = None,
        spinning_friction: float | None = None,
    ) -> None:
        """The body "table": a fixed box, length along x, its top at z = 0, centred on x_offset."""
        self.create_box(
            "table",
            (length / 2, width / 2, height / 2),
            0.0,
            (x_offset, 0.0, -height / 2),
            rgba_color=(0.95, 0.95, 0.95, 1.0),
            lateral_friction=lateral_friction,
            spinning_friction=spinning_friction,
        )

    def _create(
        self,
        name: str,
        kind: ShapeName,
        sizes: Sequence[float],
        mass: float,
        position: ArrayLike,
        ghost: bool,
        look: Look,
        lateral_friction: float | None,
        spinning_friction: float | None,
    ) -> None:
        body, builder = bodies.shape(kind, sizes, mass, position, name, ghost, look)
        self.physics_client.add_shape(name, body, builder)
        self._bodies_idx[name] = len(self._bodies_idx)
        if lateral_friction is not None:
            self.set_lateral_friction(name, -1, lateral_friction)
        if spinning_friction is not None:
            self.set_spinning_friction(name, -1, spinning_friction)

    # ---- friction ------------------------------------------------------------------------------------------------

    def set_lateral_friction(self, body: str, link: int, lateral_friction: float) -> None:
        """Of a link; passes over links that are not there or touch nothing, as PyBullet does."""
        simulation = self.physics_client
        if simulation.touches(body, link):
            simulation.world.set_friction(simulation.link_name(body, link), lateral_friction)

    def set_spinning_friction(self, body: str, link: int, spinning_friction: float) -> None:
        """Of a link [m]; passes over links that are not there or touch nothing."""
        simulation = self.physics_client
        if simulation.touches(body, link):
            simulation.world.set_spinning_friction(simulation.link_name(body, link), spinning_friction)


def _camera(
    width: int = 720,
    height: int = 480,
    target_position: ArrayLike | None = None,
    distance: float = 1.4,
    yaw: float = 45,
    pitch: float = -30,
    roll: float = 0,
) -> Camera:
    return orbit_camera(width, height, target_position, distance, yaw, pitch, roll)


def _look(rgba: ArrayLike | None, specular: ArrayLike | None, texture: str | None = None) -> Look:
    """Raises FileNotFoundError if the texture is not there."""
    look = Look()
    if rgba is not None:
        look.rgba = tuple(np.asarray(rgba, np.float64).reshape(4).tolist())
    if specular is not None:
        look.specular = tuple(np.asarray(specular, np.float64).reshape(3).tolist())
    if texture is not None:
        look.texture = Path(get_data_path()) / texture
        if not look.texture.is_file():
            raise FileNotFoundError(f"there is no texture {texture!r}, neither by this path nor in {get_data_path()}")
    return look
