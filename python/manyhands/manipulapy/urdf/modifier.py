"""Changes of a robot's description: calibration, payloads, names."""

import json
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands.files import replacing
from manyhands.manipulapy.urdf.tree import URDF, spread
from manyhands.manipulapy.utils import euler_to_rotation_matrix, rotation_matrix_to_euler_angles, transform_from_twist

Array = NDArray[np.float64]
Calibration = Mapping[str, Mapping[str, float]]

_INERTIAS = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
_LIMITS = ("lower", "upper", "velocity", "effort")

__all__ = ["URDFModifier", "load_calibration", "save_calibration"]


class URDFModifier:
    """A copy of a description that changes; every setter returns the modifier. What the description says of shapes
    stays as it is. Unknown links and joints raise ValueError."""

    def __init__(self, urdf: URDF) -> None:
        self._root = ElementTree.fromstring(urdf.xml)

    @property
    def urdf(self) -> URDF:
        """What it is now, without the shapes that need mesh files."""
        return URDF.from_xml_string(self.to_urdf_string())

    # ---- joints ------------------------------------------------------------------------------------------------

    def set_joint_origin(
        self, joint_name: str, xyz: ArrayLike | None = None, rpy: ArrayLike | None = None
    ) -> "URDFModifier":
        """The joint's frame in its parent: position (3,) [m]; roll, pitch and yaw [rad]. None leaves it."""
        joint = self._joint(joint_name)
        if xyz is not None:
            _write(_part(joint, "origin"), "xyz", _three("xyz", xyz))
        if rpy is not None:
            _write(_part(joint, "origin"), "rpy", _three("rpy", rpy))
        return self

    def set_joint_axis(self, joint_name: str, axis: ArrayLike) -> "URDFModifier":
        """(3,), of any length above 0."""
        direction = _three("axis", axis)
        length = np.linalg.norm(direction)
        if length == 0:
            raise ValueError("axis is 0; expected a direction")
        _write(_part(self._joint(joint_name), "axis"), "xyz", direction / length)
        return self

    def set_joint_limits(
        self,
        joint_name: str,
        lower: float | None = None,
        upper: float | None = None,
        velocity: float | None = None,
        effort: float | None = None,
    ) -> "URDFModifier":
        """[rad or m], [rad/s or m/s], [N m or N]; None leaves it. Raises ValueError where lower is above upper."""
        joint = self._joint(joint_name)
        given = {"lower": lower, "upper": upper, "velocity": velocity, "effort": effort}
        old = joint.find("limit")
        attributes = dict.fromkeys(_LIMITS, "0") | ({} if old is None else dict(old.attrib))
        attributes |= {name: repr(_number(name, value)) for name, value in given.items() if value is not None}
        if float(attributes["lower"]) > float(attributes["upper"]):
            raise ValueError(
                f"the limits of {joint_name!r} would be {attributes['lower']} and {attributes['upper']}; "
                "expected lower below upper"
            )
        _part(joint, "limit").attrib.update(attributes)
        return self

    def offset_joint_zero(self, joint_name: str, offset: float) -> "URDFModifier":
        """Moves the joint's frame as the joint does by offset [rad or m]: that is where its 0 is then."""
        joint = self._joint(joint_name)
        kind = joint.attrib.get("type")
        if kind not in ("revolute", "continuous", "prismatic"):
            raise ValueError(f"joint {joint_name!r} is {kind}; only single turns and shifts have a zero")
        axis = joint.find("axis")
        direction = _read(axis, "xyz", (1.0, 0.0, 0.0))
        direction = direction / np.linalg.norm(direction)
        still = np.zeros(3)
        screw = np.concatenate([still, direction] if kind == "prismatic" else [direction, still])
        T = _pose(joint.find("origin")) @ transform_from_twist(screw, _number("offset", offset))
        return self.set_joint_origin(joint_name, T[:3, 3], rotation_matrix_to_euler_angles(T[:3, :3]))

    def apply_calibration(self, calibration: Calibration) -> "URDFModifier":
        """{joint: {"offset", "lower", "upper", "velocity", "effort"}}, of each what is to change."""
        for joint_name, values in calibration.items():
            if unknown := values.keys() - {"offset", *_LIMITS}:
                raise ValueError(f"the calibration of {joint_name!r} has an unknown {', '.join(sorted(unknown))}")
            self._joint(joint_name)
        for joint_name, values in calibration.items():
            if "offset" in values:
                self.offset_joint_zero(joint_name, values["offset"])
            limits = {name: value for name, value in values.items() if name != "offset"}
            if limits:
                self.set_joint_limits(joint_name, **limits)
        return self

    # ---- links -------------------------------------------------------------------------------------------------

    def set_link_mass(self, link_name: str, mass: float) -> "URDFModifier":
        """[kg]; its inertia stays."""
        _part(self._inertial(link_name), "mass").set("value", repr(_mass(mass)))
        return self

    def set_link_inertia(self, link_name: str, inertia: ArrayLike) -> "URDFModifier":
        """(3, 3) [kg m²] about the centre of mass, in the axes of the link's inertial frame."""
        _part(self._inertial(link_name), "inertia").attrib.update(_tensor(_symmetric(inertia)))
        return self

    def set_link_com(self, link_name: str, com: ArrayLike) -> "URDFModifier":
        """The centre of mass (3,) [m] in the link's frame."""
        _write(_part(self._inertial(link_name), "origin"), "xyz", _three("com", com))
        return self

    def scale_masses(self, scale: float, link_names: Iterable[str] | None = None) -> "URDFModifier":
        """Masses and inertias of links, by default of all that have any, times a number."""
        factor = _mass(scale)
        links = self._root.findall("link") if link_names is None else [self._link(name) for name in link_names]
        for link in links:
            inertial = link.find("inertial")
            if inertial is not None:
                _part(inertial, "mass").set("value", repr(factor * _mass_of(inertial)))
                _part(inertial, "inertia").attrib.update(_tensor(factor * _inertia(inertial)))
        return self

    def add_payload(
        self, link_name: str, mass: float, com: ArrayLike | None = None, inertia: ArrayLike | None = None
    ) -> "URDFModifier":
        """What a link carries: mass [kg], centre of mass (3,) [m] in the link's frame, by default the link's own, and
        inertia (3, 3) [kg m²] about it in the link's axes, by default that of a point. Parallel axes (Steiner) bring
        both bodies to the centre of mass that they have together."""
        inertial = self._inertial(link_name)
        T, old = _pose(inertial.find("origin")), _mass_of(inertial)
        added, R = _mass(mass), T[:3, :3]
        at = T[:3, 3] if com is None else _three("com", com)
        own = np.zeros((3, 3)) if inertia is None else _symmetric(inertia)
        total = old + added
        centre = (old * T[:3, 3] + added * at) / total if total > 0 else at
        about = R @ _inertia(inertial) @ R.T + own + old * spread(T[:3, 3] - centre) + added * spread(at - centre)
        _part(inertial, "mass").set("value", repr(total))
        _part(inertial, "inertia").attrib.update(_tensor(about))
        origin = _part(inertial, "origin")
        _write(origin, "xyz", centre)
        _write(origin, "rpy", np.zeros(3))
        return self

    def remove_link_inertial(self, link_name: str) -> "URDFModifier":
        """Leaves the link without mass."""
        link = self._link(link_name)
        for inertial in link.findall("inertial"):
            link.remove(inertial)
        return self

    # ---- names and files ---------------------------------------------------------------------------------------

    def rename_joint(self, old_name: str, new_name: str) -> "URDFModifier":
        """Wherever the description names it. Raises ValueError on a name that is taken."""
        joint = self._joint(old_name)
        self._require_free("joint", new_name)
        joint.set("name", new_name)
        for mimic in self._root.iterfind("joint/mimic"):
            _replace(mimic, "joint", old_name, new_name)
        for driven in self._root.iterfind("transmission/joint"):
            _replace(driven, "name", old_name, new_name)
        return self

    def rename_link(self, old_name: str, new_name: str) -> "URDFModifier":
        """Wherever the description names it. Raises ValueError on a name that is taken."""
        link = self._link(old_name)
        self._require_free("link", new_name)
        link.set("name", new_name)
        for path in ("joint/parent", "joint/child"):
            for end in self._root.iterfind(path):
                _replace(end, "link", old_name, new_name)
        return self

    def to_urdf_string(self) -> str:
        """The description as XML."""
        return ElementTree.tostring(self._root, encoding="unicode", xml_declaration=True)

    def save(self, filename: str | PathLike[str]) -> None:
        """Writes it. Relative paths of meshes stay as they are, so they count from the new file."""
        with replacing(Path(filename)) as whole:
            whole.write_text(self.to_urdf_string(), encoding="utf-8")

    def _joint(self, name: str) -> ElementTree.Element:
        return self._named("joint", name)

    def _link(self, name: str) -> ElementTree.Element:
        return self._named("link", name)

    def _inertial(self, link_name: str) -> ElementTree.Element:
        """A link's inertial part, of nothing if it had none."""
        inertial = _part(self._link(link_name), "inertial")
        _part(inertial, "mass").attrib.setdefault("value", "0")
        inertia = _part(inertial, "inertia")
        for name in _INERTIAS:
            inertia.attrib.setdefault(name, "0")
        return inertial

    def _named(self, tag: str, name: str) -> ElementTree.Element:
        found = next((part for part in self._root.findall(tag) if part.attrib.get("name") == name), None)
        if found is None:
            names = ", ".join(part.attrib.get("name", "") for part in self._root.findall(tag))
            raise ValueError(f"there is no {tag} {name!r}; there are {names}")
        return found

    def _require_free(self, tag: str, name: str) -> None:
        if any(part.attrib.get("name") == name for part in self._root.findall(tag)):
            raise ValueError(f"there is a {tag} {name!r} already")


def load_calibration(filename: str | PathLike[str]) -> dict[str, dict[str, float]]:
    """{joint: {name: number}} of a JSON file, which may have all of it below "joints". Raises ValueError on another."""
    path = Path(filename)
    try:
        read: Any = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as reason:
        raise ValueError(f"{path} is no JSON: {reason}") from reason
    joints = read.get("joints", read) if isinstance(read, dict) else None
    if not isinstance(joints, dict) or not all(isinstance(values, dict) for values in joints.values()):
        raise ValueError(f"{path} is no calibration; expected an object of joints, each an object of numbers")
    return joints


def save_calibration(calibration: Calibration, filename: str | PathLike[str]) -> None:
    """Writes what `load_calibration` reads."""
    joints = {name: dict(values) for name, values in calibration.items()}
    with replacing(Path(filename)) as whole:
        whole.write_text(json.dumps({"joints": joints}, indent=2) + "\n", encoding="utf-8")


def _part(element: ElementTree.Element, tag: str) -> ElementTree.Element:
    """The part of that name, made if need be."""
    found = element.find(tag)
    return ElementTree.SubElement(element, tag) if found is None else found


def _replace(element: ElementTree.Element, attribute: str, old: str, new: str) -> None:
    if element.attrib.get(attribute) == old:
        element.set(attribute, new)


def _write(element: ElementTree.Element, attribute: str, values: Array) -> None:
    element.set(attribute, " ".join(map(repr, values.tolist())))


def _read(element: ElementTree.Element | None, attribute: str, default: tuple[float, ...] = (0.0, 0.0, 0.0)) -> Array:
    text = None if element is None else element.attrib.get(attribute)
    return np.array(default if text is None else text.split(), np.float64)


def _pose(origin: ElementTree.Element | None) -> Array:
    """(4, 4)"""
    T = np.eye(4)
    T[:3, :3] = euler_to_rotation_matrix(np.degrees(_read(origin, "rpy")))
    T[:3, 3] = _read(origin, "xyz")
    return T


def _mass_of(inertial: ElementTree.Element) -> float:
    mass = inertial.find("mass")
    return 0.0 if mass is None else float(mass.attrib.get("value", 0.0))


def _inertia(inertial: ElementTree.Element) -> Array:
    found, tensor = inertial.find("inertia"), np.zeros((3, 3))
    for name, (i, j) in _INERTIAS.items():
        tensor[i, j] = tensor[j, i] = 0.0 if found is None else float(found.attrib.get(name, 0.0))
    return tensor


def _tensor(inertia: Array) -> dict[str, str]:
    return {name: repr(float(inertia[at])) for name, at in _INERTIAS.items()}


def _number(name: str, value: float) -> float:
    number = float(value)
    if not np.isfinite(number):
        raise ValueError(f"{name} is {value}; expected a finite number")
    return number


def _mass(value: float) -> float:
    if not (np.isfinite(value) and value >= 0):
        raise ValueError(f"the mass or scale is {value}; expected a finite number, 0 or more")
    return float(value)


def _three(name: str, values: ArrayLike) -> Array:
    array = np.asarray(values, np.float64)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(f"{name} is {values}; expected 3 finite numbers")
    return array


def _symmetric(inertia: ArrayLike) -> Array:
    array = np.asarray(inertia, np.float64)
    if array.shape != (3, 3) or not np.isfinite(array).all() or not np.allclose(array, array.T):
        raise ValueError(f"the inertia is {inertia}; expected a symmetric matrix (3, 3) of finite numbers")
    return array
