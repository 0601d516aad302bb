"""Robot descriptions: a URDF file as a tree of links and joints, and the screws and inertias of an arm in it."""

import tempfile
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands import dynamics as _dynamics
from manyhands import kinematics
from manyhands._core import Joint, Link, Model, load_urdf
from manyhands.manipulapy.utils import TransInv, adjoint_transform

if TYPE_CHECKING:
    from manyhands.manipulapy.dynamics import ManipulatorDynamics
    from manyhands.manipulapy.kinematics import SerialManipulator

Array = NDArray[np.float64]

_TOOLS = ("tool", "tcp", "grasp", "_ee", "ee_", "end_effector", "endeffector", "flange")
_FREE = ("revolute", "continuous", "prismatic")

__all__ = ["URDF", "Screws"]


class Screws(NamedTuple):
    """What an arm's description says of it as screws, space axes, at angles 0."""

    M: Array
    """(4, 4) of the end effector"""
    S_list: Array
    """(6, n)"""
    B_list: Array
    """(6, n)"""
    G_list: list[Array]
    """n of (6, 6), angular first, about the centres of mass; what joints beyond the arm carry counts where it is at
    0"""
    omega_list: Array
    """(3, n)"""
    r_list: Array
    """(3, n)"""
    joint_limits: list[tuple[float, float]]
    Mlist_per_link: list[Array]
    """n of (4, 4): the centres of mass"""


class URDF:
    """A robot's description. `model` is what manyhands makes of it, `xml` the text."""

    def __init__(self, model: Model, xml: str, mimic: Iterable[str] = (), filename: str | None = None) -> None:
        self.model, self.xml, self.filename, self.name = model, xml, filename, model.name
        self._mimic = frozenset(mimic)
        self._cfg = np.zeros(len(self.actuated_joints))

    @classmethod
    def load(
        cls,
        filename: str | PathLike[str],
        load_meshes: bool = False,
        mesh_dir: str | None = None,
        backend: str = "builtin",
    ) -> "URDF":
        """Reads a file. Raises FileNotFoundError, and ValueError on what is no robot or an unknown backend."""
        if backend not in ("builtin", "pybullet"):
            raise ValueError(f"unknown backend {backend!r}; there are 'builtin' and 'pybullet'")
        path = Path(filename)
        if not path.is_file():
            raise FileNotFoundError(f"there is no file {path}")
        folders = [] if mesh_dir is None else [mesh_dir]
        try:
            model, _ = load_urdf(path, package_paths=folders, load_meshes=load_meshes)
            root = ElementTree.parse(path).getroot()
        except (RuntimeError, ElementTree.ParseError) as reason:
            raise ValueError(f"{path}: {reason}") from reason
        mimic = [joint.attrib.get("name", "") for joint in root.findall("joint") if joint.find("mimic") is not None]
        return cls(model, ElementTree.tostring(root, encoding="unicode"), mimic, str(path))

    @classmethod
    def from_xml_string(cls, xml: str) -> "URDF":
        """The same of a text."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "robot.urdf"
            path.write_text(xml)
            return cls.load(path)

    # ---- what there is -----------------------------------------------------------------------------------------

    @property
    def links(self) -> list[Link]:
        """In the order of the file; manyhands' own "world", on which the robot stands, is none."""
        all_links = self.model.links
        return all_links if any(joint.parent == 0 for joint in self.joints) else all_links[1:]

    @property
    def joints(self) -> list[Joint]:
        return self.model.joints

    def _parent(self, joint: Joint) -> str:
        return self.model.links[joint.parent].name

    def _child(self, joint: Joint) -> str:
        return self.model.links[joint.child].name

    @property
    def link_map(self) -> dict[str, Link]:
        return {link.name: link for link in self.links}

    @property
    def joint_map(self) -> dict[str, Joint]:
        return {joint.name: joint for joint in self.joints}

    @property
    def actuated_joints(self) -> list[Joint]:
        """Those that move and mimic no other, root first."""
        return [joint for joint in self.joints if joint.type != "fixed" and joint.name not in self._mimic]

    @property
    def actuated_joint_names(self) -> list[str]:
        return [joint.name for joint in self.actuated_joints]

    @property
    def num_dofs(self) -> int:
        return len(self.actuated_joints)

    num_actuated_joints = num_dofs

    @property
    def root_link(self) -> str:
        """The link that no joint moves."""
        children = {self._child(joint) for joint in self.joints}
        return next(link.name for link in self.links if link.name not in children)

    @property
    def end_links(self) -> list[str]:
        """Those that carry no other."""
        parents = {self._parent(joint) for joint in self.joints}
        return [link.name for link in self.links if link.name not in parents]

    @property
    def end_effector_link(self) -> str:
        """The end link that is named as a tool, else the one that most joints move; of several, the one with most links
        before it, then the first of the file."""

        def rank(name: str) -> tuple[bool, int, int]:
            chain = self.get_chain(self.root_link, name)
            is_tool = any(word in name.lower() for word in _TOOLS)
            moving = [joint for joint in chain if joint.type != "fixed"]
            return is_tool and bool(moving), len(moving), len(chain)

        return max(self.end_links, key=rank)

    @property
    def kinematic_chain(self) -> list[str]:
        """The names of the joints from the root to the end effector."""
        return [joint.name for joint in self.get_chain(self.root_link, self.end_effector_link)]

    @property
    def joint_limits(self) -> list[tuple[float, float]]:
        """(low, high) of the actuated joints; half a turn each way where there are none."""
        return [_limits(joint) for joint in self.actuated_joints]

    def get_link(self, name: str) -> Link:
        return self.model.link(name)

    def get_joint(self, name: str) -> Joint:
        return self.model.joint(name)

    def get_chain(self, root: str, tip: str) -> list[Joint]:
        """The joints from one link to another. Raises ValueError if there is no way."""
        above = {self._child(joint): joint for joint in self.joints}
        chain: list[Joint] = []
        at = tip
        while at != root:
            if at not in above:
                raise ValueError(f"there is no chain of joints from {root!r} to {tip!r}")
            chain.append(above[at])
            at = self._parent(above[at])
        return chain[::-1]

    # ---- where things are --------------------------------------------------------------------------------------

    @property
    def cfg(self) -> Array:
        """The angles of the actuated joints."""
        return self._cfg

    @cfg.setter
    def cfg(self, values: "ArrayLike | Mapping[str, float]") -> None:
        self.update_cfg(values)

    def update_cfg(self, cfg: "ArrayLike | Mapping[str, float]") -> None:
        """Sets them, in order or by name."""
        self._cfg = self._actuated(cfg)

    def _actuated(self, cfg: "ArrayLike | Mapping[str, float] | None") -> Array:
        if cfg is None:
            return self._cfg
        if isinstance(cfg, Mapping):
            return np.array([float(cfg.get(name, 0.0)) for name in self.actuated_joint_names])
        values = np.asarray(cfg, np.float64)
        if values.shape[-1:] != (self.num_dofs,):
            raise ValueError(f"the configuration has shape {values.shape}; expected (..., {self.num_dofs})")
        return values

    def configuration(self, cfg: "ArrayLike | Mapping[str, float] | None" = None) -> Array:
        """The model's q (..., nq) of actuated angles (..., n); joints that mimic stand at 0 as manyhands takes them."""
        values = self._actuated(cfg)
        q = np.zeros((*values.shape[:-1], self.model.nq))
        for k, joint in enumerate(self.actuated_joints):
            q[..., joint.iq] = values[..., k]
        return q

    def link_fk(
        self,
        cfg: "ArrayLike | Mapping[str, float] | None" = None,
        links: Sequence[str] | None = None,
        use_names: bool = False,
    ) -> dict[Any, Array]:
        """The poses (4, 4) of links, by link or by name."""
        found = self._poses(self.configuration(cfg))
        wanted = [link for link in self.links if links is None or link.name in links]
        return {(link.name if use_names else link): found[link.name] for link in wanted}

    def link_fk_batch(self, cfgs: ArrayLike, links: Sequence[str] | None = None) -> dict[str, Array]:
        """The poses (N, 4, 4) of links by name, for N configurations."""
        found = self._poses(self.configuration(cfgs))
        return {link.name: found[link.name] for link in self.links if links is None or link.name in links}

    def _poses(self, q: Array) -> dict[str, Array]:
        T = kinematics.matrix(*_dynamics.forward_kinematics(self.model, q))
        return {frame.name: T[..., k, :, :] for k, frame in enumerate(self.model.frames)}

    def get_transform(
        self, frame_to: str, frame_from: str | None = None, cfg: "ArrayLike | Mapping[str, float] | None" = None
    ) -> Array:
        """The pose (4, 4) of a link in the frame of another, by default the world."""
        found = self._poses(self.configuration(cfg))
        for name in (frame_to, frame_from):
            if name not in (None, "world") and name not in found:
                raise ValueError(f"there is no link {name!r}")
        T = found[frame_to]
        return T if frame_from in (None, "world") else TransInv(found[str(frame_from)]) @ T

    # ---- as screws ---------------------------------------------------------------------------------------------

    def extract_screw_axes(self, tip_link: str | None = None) -> Screws:
        """The arm from the root to a link, by default the end effector. Joints beside the way stand at 0. Raises
        ValueError if a joint on the way is no turn or shift, or if there is none."""
        tip = tip_link or self.end_effector_link
        chain = [joint for joint in self.get_chain(self.root_link, tip) if joint.type != "fixed"]
        if not chain:
            raise ValueError(f"no joint moves {tip!r}")
        for joint in chain:
            if joint.type not in _FREE:
                raise ValueError(f"joint {joint.name!r} is {joint.type}; screws are of single turns and shifts")
        zero = np.zeros(self.model.nq)
        found = kinematics.screw_axes(self.model, tip, zero)
        M = kinematics.matrix(found.position, found.quaternion)
        S = found.axes[:, [joint.iq for joint in chain]]
        centres, inertias = self._lumped(chain, zero)
        omega, v = S[:3], S[3:]
        return Screws(
            M,
            S,
            adjoint_transform(TransInv(M)) @ S,
            inertias,
            omega,
            np.cross(omega.T, v.T).T,
            [_limits(joint) for joint in chain],
            centres,
        )

    def _lumped(self, chain: list[Joint], q: Array) -> tuple[list[Array], list[Array]]:
        """The centre of mass, as a pose with the axes of space, and the spatial inertia of all that each joint carries
        before the next one."""
        poses = self._poses(q)
        place = {joint.child: k for k, joint in enumerate(chain)}
        mass, moment = np.zeros(len(chain)), np.zeros((len(chain), 3))
        about = np.zeros((len(chain), 3, 3))
        for link in self.links:
            k = self._carrier(link, place)
            if k is None or link.mass == 0:
                continue
            T = poses[link.name]
            centre, R = T[:3, :3] @ link.com + T[:3, 3], T[:3, :3]
            mass[k] += link.mass
            moment[k] += link.mass * centre
            about[k] += R @ link.inertia @ R.T + link.mass * spread(centre)
        centres, inertias = [], []
        for k, joint in enumerate(chain):
            pose, G = np.eye(4), np.zeros((6, 6))
            pose[:3, 3] = moment[k] / mass[k] if mass[k] > 0 else poses[self._child(joint)][:3, 3]
            G[:3, :3] = about[k] - mass[k] * spread(pose[:3, 3])
            G[3:, 3:] = mass[k] * np.eye(3)
            centres.append(pose)
            inertias.append(G)
        return centres, inertias

    def _carrier(self, link: Link, place: dict[int, int]) -> int | None:
        """Which joint of the chain carries a link."""
        indices = {other.name: k for k, other in enumerate(self.model.links)}
        at = indices[link.name]
        while at >= 0:
            if at in place:
                return place[at]
            at = self.model.links[at].parent
        return None

    def to_serial_manipulator(self, tip_link: str | None = None) -> "SerialManipulator":
        """The arm's kinematics."""
        from manyhands.manipulapy.kinematics import SerialManipulator

        s = self.extract_screw_axes(tip_link)
        return SerialManipulator(
            s.M, s.omega_list, S_list=s.S_list, B_list=s.B_list, G_list=s.G_list, joint_limits=s.joint_limits
        )

    def to_manipulator_dynamics(self, tip_link: str | None = None) -> "ManipulatorDynamics":
        """The arm's dynamics."""
        from manyhands.manipulapy.dynamics import ManipulatorDynamics

        s = self.extract_screw_axes(tip_link)
        return ManipulatorDynamics(s.M, s.omega_list, None, None, s.S_list, s.B_list, s.G_list, s.Mlist_per_link)


def _limits(joint: Joint) -> tuple[float, float]:
    if np.isfinite(joint.lower) and np.isfinite(joint.upper) and joint.lower < joint.upper:
        return float(joint.lower), float(joint.upper)
    return -np.pi, np.pi


def spread(centre: Array) -> Array:
    """The rotational inertia of a unit point mass about the origin."""
    return (centre @ centre) * np.eye(3) - np.outer(centre, centre)
