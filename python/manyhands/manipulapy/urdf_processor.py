"""From a URDF file to an arm that computes."""

import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands.manipulapy.dynamics import ManipulatorDynamics
from manyhands.manipulapy.kinematics import SerialManipulator
from manyhands.manipulapy.urdf import URDF, Scene, URDFModifier

Array = NDArray[np.float64]

__all__ = ["URDFToSerialManipulator", "create_multi_robot_scene", "load_robot"]


class URDFToSerialManipulator:
    """The arm from the root of a file to its end effector: `serial_manipulator` and `dynamics`.

    use_pybullet_limits changes nothing: both readers are one. validate=True warns of what `validate` finds.
    """

    def __init__(
        self,
        urdf_name: str,
        use_pybullet_limits: bool = False,
        backend: str = "builtin",
        load_meshes: bool = False,
        validate: bool = False,
        tip_link: str | None = None,
    ) -> None:
        del use_pybullet_limits
        self.urdf_name, self.backend = str(urdf_name), backend
        self.robot = URDF.load(urdf_name, load_meshes=load_meshes, backend=backend)
        self.tip_link = tip_link or self.robot.end_effector_link
        screws = self.robot.extract_screw_axes(self.tip_link)
        self.robot_data: dict[str, Any] = {
            "M": screws.M,
            "omega_list": screws.omega_list,
            "Slist": screws.S_list,
            "Blist": screws.B_list,
            "Glist": screws.G_list,
            "actuated_joints_num": screws.S_list.shape[1],
            "joint_limits": screws.joint_limits,
            "Mlist_per_link": screws.Mlist_per_link,
        }
        self.serial_manipulator = SerialManipulator(
            screws.M,
            screws.omega_list,
            S_list=screws.S_list,
            B_list=screws.B_list,
            G_list=screws.G_list,
            joint_limits=screws.joint_limits,
        )
        self.dynamics = ManipulatorDynamics(
            screws.M, screws.omega_list, None, None, screws.S_list, screws.B_list, screws.G_list, screws.Mlist_per_link
        )
        self.dynamics.joint_limits = screws.joint_limits
        self.manipulator_dynamics = self.dynamics
        if validate:
            for issue in self.validate()["issues"]:
                warnings.warn(issue["message"], UserWarning, stacklevel=2)

    @property
    def num_dofs(self) -> int:
        return self.serial_manipulator.S_list.shape[1]

    @property
    def joint_names(self) -> list[str]:
        """Of the arm, root first."""
        chain = self.robot.get_chain(self.robot.root_link, self.tip_link)
        return [joint.name for joint in chain if joint.type != "fixed"]

    @property
    def link_names(self) -> list[str]:
        return [link.name for link in self.robot.links]

    @property
    def end_effector_name(self) -> str:
        return self.tip_link

    @property
    def joint_limits_array(self) -> Array:
        """(n, 2)"""
        return np.array(self.robot_data["joint_limits"])

    def get_serial_manipulator(self) -> SerialManipulator:
        return self.serial_manipulator

    def get_manipulator_dynamics(self) -> ManipulatorDynamics:
        return self.dynamics

    def load_urdf(self, urdf_name: str) -> dict[str, Any]:
        """Deprecated: make another object."""
        warnings.warn("load_urdf is deprecated; make another URDFToSerialManipulator", DeprecationWarning, stacklevel=2)
        return URDFToSerialManipulator(urdf_name).robot_data

    def forward_kinematics(self, cfg: ArrayLike, frame: Any = "space") -> Array:
        """The pose (4, 4) of the end effector."""
        return self.serial_manipulator.forward_kinematics(cfg, frame)

    def jacobian(self, cfg: ArrayLike, frame: Any = "space") -> Array:
        """(6, n)"""
        return self.serial_manipulator.jacobian(cfg, frame)

    def inverse_kinematics(
        self, T: ArrayLike, initial_guess: ArrayLike | None = None, method: str = "robust", **options: Any
    ) -> tuple[Array, bool, int]:
        """Angles, success, attempts; method "robust", "smart", or another for the iterative one."""
        arm = self.serial_manipulator
        if method == "robust":
            theta, success, attempts, _ = arm.robust_inverse_kinematics(T, **options)
            return theta, success, attempts
        if method == "smart":
            return arm.smart_inverse_kinematics(T, theta_current=initial_guess, **options)
        guess = np.zeros(self.num_dofs) if initial_guess is None else initial_guess
        return arm.iterative_inverse_kinematics(T, guess, **options)

    def link_fk(self, cfg: "ArrayLike | Mapping[str, float] | None" = None, use_names: bool = True) -> dict[Any, Array]:
        """The poses (4, 4) of all links."""
        return self.robot.link_fk(cfg, use_names=use_names)

    def batch_forward_kinematics(self, cfgs: ArrayLike, link_name: str | None = None) -> Any:
        """The poses (N, 4, 4) of a link, or of all by name. Raises ValueError on an unknown link."""
        found = self.robot.link_fk_batch(cfgs)
        if link_name is None:
            return found
        if link_name not in found:
            raise ValueError(f"there is no link {link_name!r}; there are {', '.join(found)}")
        return found[link_name]

    def get_end_effector_transforms(self, cfgs: ArrayLike) -> Array:
        """(N, 4, 4)"""
        return self.serial_manipulator.forward_kinematics(cfgs)

    def get_transform(self, frame_to: str, frame_from: str = "world", cfg: ArrayLike | None = None) -> Array:
        """The pose (4, 4) of one link in another."""
        return self.robot.get_transform(frame_to, frame_from, cfg)

    def create_modifier(self) -> URDFModifier:
        """A copy of the description, to change."""
        return URDFModifier(self.robot)

    def validate(self) -> dict[str, Any]:
        """What is doubtful: {"valid": bool, "issues": [{"severity", "message"}]}."""
        issues = [
            {"severity": "warning", "message": f"joint {joint.name!r} has no limits"}
            for joint in self.robot.actuated_joints
            if joint.type == "revolute" and not np.isfinite([joint.lower, joint.upper]).all()
        ]
        moved = {joint.child for joint in self.robot.actuated_joints}
        issues += [
            {"severity": "warning", "message": f"link {link.name!r} moves and has no mass"}
            for k, link in enumerate(self.robot.model.links)
            if k in moved and link.mass == 0
        ]
        return {"valid": not any(issue["severity"] == "error" for issue in issues), "issues": issues}

    def print_joint_info(self) -> dict[str, Any]:
        """{"num_joints", "joint_names"} of all joints."""
        names = [joint.name for joint in self.robot.joints]
        return {"num_joints": len(names), "joint_names": names}

    @staticmethod
    def transform_to_xyz(T: ArrayLike) -> Array:
        """The position (3,) of a pose (4, 4)."""
        return np.asarray(T, np.float64)[:3, 3]

    @staticmethod
    def get_link(robot: URDF, link_name: str) -> Any:
        """A link by name; None of one that is not there."""
        return robot.link_map.get(link_name)

    @staticmethod
    def w_p_to_slist(w: ArrayLike, p: ArrayLike, robot_dof: int) -> Array:
        """Screw axes (6, n) of axes and points (n, 3)."""
        omega = np.asarray(w, np.float64).reshape(robot_dof, 3)
        return np.vstack([omega.T, -np.cross(omega, np.asarray(p, np.float64).reshape(robot_dof, 3)).T])

    def visualize_robot(self, cfg: ArrayLike | None = None) -> Any:
        """Shows the robot on a page in the browser; returns the viewer."""
        return self.visualize_trajectory(None if cfg is None else np.atleast_2d(np.asarray(cfg, np.float64)))

    def visualize_trajectory(
        self,
        cfg_trajectory: "ArrayLike | Mapping[str, ArrayLike] | None" = None,
        loop_time: float = 3.0,
        use_collision: bool = False,
    ) -> Any:
        """Shows the robot as it moves through configurations (N, n), or {joint: (N,)}, in loop_time [s] on a page in
        the browser; every joint goes from 0 to a half or quarter turn by default. Returns the viewer."""
        del use_collision
        import time

        from manyhands._core import World
        from manyhands.viewer import view

        rows = self._rows(cfg_trajectory)
        world = World(self.robot.model)
        viewer = view(world)
        for row in rows:
            world.q = self.robot.configuration(row)
            time.sleep(loop_time / len(rows))
        return viewer

    def _rows(self, given: Any) -> Array:
        n = self.robot.num_dofs
        if given is None:
            return np.linspace(np.zeros(n), np.full(n, np.pi / 2), 50)
        if isinstance(given, Mapping):
            if len(given) != n:
                raise ValueError(f"the trajectory names {len(given)} joints; expected {n}")
            return np.stack([np.asarray(given[name], np.float64) for name in self.robot.actuated_joint_names], axis=1)
        if not isinstance(given, list | tuple | np.ndarray):
            raise TypeError(f"the trajectory is a {type(given).__name__}; expected an array (N, {n}) or a dictionary")
        rows = np.asarray(given, np.float64)
        if rows.ndim != 2 or rows.shape[1] != n:
            raise ValueError(f"the trajectory has shape {rows.shape}; expected (N, {n})")
        return rows


def load_robot(urdf_path: str, backend: str = "builtin", use_pybullet_limits: bool = False) -> URDFToSerialManipulator:
    """`URDFToSerialManipulator` of a file."""
    return URDFToSerialManipulator(urdf_path, use_pybullet_limits, backend)


def create_multi_robot_scene(name: str = "scene") -> Scene:
    """An empty `Scene`."""
    return Scene(name)
