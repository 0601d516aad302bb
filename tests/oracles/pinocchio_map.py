"""The same trees for Pinocchio, and the map between its coordinates and ours.

Pinocchio's spatial vectors are linear first. Its velocity of spherical, planar and free-flyer joints is in the child's
axes, ours in the joint frame F; hence per joint v_p = G v and a_p = G a + dG/dt v, tau = G^T tau_p.
"""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import manyhands as mh

Array = NDArray[np.float64]

JOINT_TYPES = ("revolute", "continuous", "prismatic", "spherical", "planar", "floating", "fixed")
ANGULAR_FIRST = [3, 4, 5, 0, 1, 2]
JOINT_MODELS = {
    "revolute": pin.JointModelRevoluteUnaligned,
    "continuous": pin.JointModelRevoluteUnaligned,
    "prismatic": pin.JointModelPrismaticUnaligned,
    "spherical": lambda _: pin.JointModelSpherical(),
    "floating": lambda _: pin.JointModelFreeFlyer(),
}


def from_z_to(axis: Array) -> Array:
    """The smallest rotation that takes z to `axis`: where a planar joint's x and y lie."""
    turn = np.cross([0.0, 0.0, 1.0], axis)
    sine = float(np.linalg.norm(turn))
    if sine == 0:
        return np.eye(3)
    return Rotation.from_rotvec(turn / sine * np.arctan2(sine, axis[2])).as_matrix()


@dataclass
class Tree:
    """A model of ours and Pinocchio's of the same robot, joints and frames by the same names."""

    ours: mh.Model
    pinocchio: pin.Model

    def __post_init__(self) -> None:
        self.data = self.pinocchio.createData()
        self.joints = [
            (joint, self.pinocchio.joints[self.pinocchio.getJointId(joint.name)])
            for joint in self.ours.joints
            if joint.type != "fixed"
        ]
        poses = (pin.FrameType.BODY, pin.FrameType.OP_FRAME)
        self.frames = {frame.name: i for i, frame in enumerate(self.pinocchio.frames) if frame.type in poses}

    def configuration(self, q: Array) -> Array:
        """Pinocchio's q of ours."""
        result = np.zeros(self.pinocchio.nq)
        for joint, theirs in self.joints:
            x = q[joint.iq : joint.iq + joint.nq]
            if joint.type == "planar":
                x = np.array([x[0], x[1], np.cos(x[2]), np.sin(x[2])])
            elif theirs.nq == 2:  # a continuous joint, as its URDF loader makes them
                x = np.array([np.cos(x[0]), np.sin(x[0])])
            result[theirs.idx_q : theirs.idx_q + theirs.nq] = x
        return result

    def velocity_map(self, q: Array, v: Array) -> tuple[Array, Array]:
        """G (nv, nv) and dG/dt v (nv)."""
        G = np.zeros((self.pinocchio.nv, self.ours.nv))
        drift = np.zeros(self.pinocchio.nv)
        for joint, theirs in self.joints:
            columns = slice(joint.iv, joint.iv + joint.nv)
            rows = slice(theirs.idx_v, theirs.idx_v + theirs.nv)
            qj, vj = q[joint.iq : joint.iq + joint.nq], v[columns]
            block, rest = np.eye(joint.nv), np.zeros(joint.nv)
            if joint.type == "spherical":
                block = Rotation.from_quat(qj).as_matrix().T
            elif joint.type == "planar":
                R = Rotation.from_rotvec([0.0, 0.0, qj[2]]).as_matrix()[:2, :2]
                block[:2, :2] = R.T
                rest[:2] = -R.T @ (vj[2] * np.array([-vj[1], vj[0]]))
            elif joint.type == "floating":
                R = Rotation.from_quat(qj[3:]).as_matrix()
                block = np.zeros((6, 6))
                block[:3, 3:] = block[3:, :3] = R.T
                rest[:3] = -R.T @ np.cross(vj[:3], vj[3:])
            G[rows, columns] = block
            drift[rows] = rest
        return G, drift


def random_state(model: mh.Model, rng: np.random.Generator) -> tuple[Array, Array]:
    """q (nq) within a turn and half a metre, quaternions at random, and v (nv)."""
    q = rng.uniform(-0.5, 0.5, model.nq)
    for joint in model.joints:
        if joint.type in ("revolute", "continuous"):
            q[joint.iq] *= 2 * np.pi
        elif joint.type == "planar":
            q[joint.iq + 2] *= 2 * np.pi
        elif joint.type in ("spherical", "floating"):
            end = joint.iq + joint.nq
            q[end - 4 : end] = Rotation.random(random_state=int(rng.integers(2**31))).as_quat()
    return q, rng.normal(size=model.nv)


def random_inertia(rng: np.random.Generator) -> tuple[float, Array, Array]:
    """Mass, centre of mass and inertia of a random box."""
    mass = float(np.exp(rng.uniform(np.log(0.2), np.log(5.0))))
    extents = rng.uniform(0.05, 0.5, 3)
    principal = mass / 12 * (np.sum(extents**2) - extents**2)
    R = Rotation.random(random_state=int(rng.integers(2**31))).as_matrix()
    inertia = R @ np.diag(principal) @ R.T
    return mass, rng.uniform(-0.2, 0.2, 3), (inertia + inertia.T) / 2


@dataclass
class Part:
    """A link, and the joint that holds it."""

    parent: int
    kind: str
    placement: pin.SE3
    axis: Array
    armature: float
    inertia: pin.Inertia
    offset: pin.SE3  # of a frame on the link


def random_placement(rng: np.random.Generator) -> pin.SE3:
    turned = rng.random() > 0.2
    turn = Rotation.random(random_state=int(rng.integers(2**31))) if turned else Rotation.identity()
    return pin.SE3(turn.as_matrix(), rng.uniform(-0.3, 0.3, 3))


def random_parts(rng: np.random.Generator) -> list[Part]:
    """4 to 16 parts, with every type of joint anywhere."""
    parts: list[Part] = []
    for i in range(int(rng.integers(4, 17))):
        kind = JOINT_TYPES[int(rng.integers(len(JOINT_TYPES)))]
        axis = rng.normal(size=3) if rng.random() < 0.7 else np.array([0.0, 0.0, 1.0])
        # Pinocchio gives a planar or floating joint's armature to the child's axes, where it is no inertia.
        has_rotor = kind not in ("fixed", "planar", "floating")
        parts.append(
            Part(
                parent=int(rng.integers(-1, i)) if rng.random() < 0.4 else i - 1,
                kind=kind,
                placement=random_placement(rng),
                axis=axis / np.linalg.norm(axis),
                armature=float(rng.uniform(0.01, 0.5)) if has_rotor else 0.0,
                inertia=pin.Inertia(*random_inertia(rng)),
                offset=random_placement(rng),
            )
        )
    return parts


def our_model(name: str, parts: list[Part]) -> mh.Model:
    builder = mh.ModelBuilder(name)
    for i, part in enumerate(parts):
        inertia = part.inertia
        builder.add_link(f"link{i}", mass=inertia.mass, com=inertia.lever, inertia=inertia.inertia)
        builder.add_joint(
            f"joint{i}",
            part.kind,
            f"link{part.parent}" if part.parent >= 0 else "world",
            f"link{i}",
            position=part.placement.translation,
            quaternion=pin.Quaternion(part.placement.rotation).coeffs(),
            axis=part.axis,
            armature=part.armature,
        )
        quaternion = pin.Quaternion(part.offset.rotation).coeffs()
        builder.add_frame(f"frame{i}", f"link{i}", position=part.offset.translation, quaternion=quaternion)
    return builder.build()


def pinocchio_model(parts: list[Part]) -> pin.Model:
    """Depth first, as Pinocchio wants it."""
    model = pin.Model()
    armature: dict[int, float] = {}

    def add_children(of: int, carrier: int, on_carrier: pin.SE3) -> None:
        """`carrier` is the joint that moves part `of`, `on_carrier` the part's pose on it."""
        for i, part in enumerate(parts):
            if part.parent != of:
                continue
            placement, on_joint = on_carrier * part.placement, pin.SE3.Identity()
            if part.kind == "fixed":
                joint, on_joint = carrier, placement
            elif part.kind == "planar":
                tilt = pin.SE3(from_z_to(part.axis), np.zeros(3))
                joint = model.addJoint(carrier, pin.JointModelPlanar(), placement * tilt, f"joint{i}")
                on_joint = tilt.inverse()
            else:
                joint = model.addJoint(carrier, JOINT_MODELS[part.kind](part.axis), placement, f"joint{i}")
                armature[joint] = part.armature
            model.appendBodyToJoint(joint, part.inertia, on_joint)
            model.addFrame(pin.Frame(f"link{i}", joint, on_joint, pin.FrameType.OP_FRAME))
            model.addFrame(pin.Frame(f"frame{i}", joint, on_joint * part.offset, pin.FrameType.OP_FRAME))
            add_children(i, joint, on_joint)

    add_children(-1, 0, pin.SE3.Identity())
    rotors = np.zeros(model.nv)
    for joint, value in armature.items():
        start = model.joints[joint].idx_v
        rotors[start : start + model.joints[joint].nv] = value
    model.armature = rotors
    return model


def random_tree(seed: int) -> Tree:
    parts = random_parts(np.random.default_rng(seed))
    return Tree(our_model(f"random {seed}", parts), pinocchio_model(parts))
