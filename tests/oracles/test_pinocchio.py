"""Dynamics in double equal Pinocchio's: on random trees with every type of joint, the Panda, and PyBullet's robots."""

import os
from pathlib import Path

import numpy as np
import pinocchio as pin
import pybullet_data
import pytest
from pinocchio_map import ANGULAR_FIRST, Array, Tree, random_state, random_tree
from scipy.spatial.transform import Rotation

import manyhands as mh

# Files as they are in the wild: some ask for parts that cannot be.
pytestmark = pytest.mark.filterwarnings("ignore:.*; print the report:UserWarning")
TOLERANCE = 1e-10  # relative to the largest entry of each result
PYBULLET = Path(pybullet_data.getDataPath())
URDFS = sorted(path.relative_to(PYBULLET).as_posix() for path in PYBULLET.rglob("*.urdf"))


def difference(ours: Array | float, theirs: Array | float) -> float:
    scale = np.max(np.abs(theirs), initial=0.0)
    return float(np.max(np.abs(np.asarray(ours) - theirs), initial=0.0) / max(scale, 1e-9))


def dynamics_differences(tree: Tree, q: Array, v: Array, a: Array) -> dict[str, float]:
    """By how much rnea, crba, aba, energies, centre of mass and momentum differ in one state."""
    model, data = tree.pinocchio, tree.data
    model.gravity.linear = tree.ours.gravity
    G, drift = tree.velocity_map(q, v)
    q_p, v_p, a_p = tree.configuration(q), G @ v, G @ a + drift
    tau_p = pin.rnea(model, data, q_p, v_p, a_p).copy()
    tau = G.T @ tau_p
    M = G.T @ full(pin.crba(model, data, q_p)) @ G
    found = {
        "rnea": difference(mh.dynamics.rnea(tree.ours, q, v, a), tau),
        "crba": difference(mh.dynamics.crba(tree.ours, q), M),
    }
    if np.linalg.cond(M) < 1e12:  # PyBullet's cartpole slides on a rail without mass: afloat, no acceleration is right
        a_back = np.linalg.solve(G, pin.aba(model, data, q_p, v_p, tau_p) - drift)
        found["aba"] = difference(mh.dynamics.aba(tree.ours, q, v, tau), a_back)
    kinetic, potential = mh.dynamics.energy(tree.ours, q, v)
    armature = model.armature.copy()  # of which Pinocchio 4.1 counts a part
    model.armature = np.zeros(model.nv)
    rotors = 0.5 * float(armature @ v_p**2)
    found["kinetic"] = difference(kinetic, pin.computeKineticEnergy(model, data, q_p, v_p) + rotors)
    model.armature = armature
    theirs = pin.computePotentialEnergy(model, data, q_p)
    # A height may cancel: measured against the weight times a metre.
    weight = sum(inertia.mass for inertia in model.inertias[1:]) * 9.81
    found["potential"] = abs(float(potential) - theirs) / max(weight, 1e-9)
    if weight > 0:
        found["com"] = float(
            np.max(np.abs(mh.dynamics.center_of_mass(tree.ours, q) - pin.centerOfMass(model, data, q_p)))
        )
        h = pin.computeCentroidalMomentum(model, data, q_p, v_p)
        angular = h.angular + np.cross(data.com[0], h.linear)
        found["momentum"] = difference(mh.dynamics.momentum(tree.ours, q, v), np.concatenate([angular, h.linear]))
    return found


def full(upper: Array) -> Array:
    return np.triu(upper) + np.triu(upper, 1).T


def frame_differences(tree: Tree, q: Array) -> dict[str, float]:
    """By how much frame poses and Jacobians differ, worst over all frames of both."""
    model, data = tree.pinocchio, tree.data
    q_p = tree.configuration(q)
    G, _ = tree.velocity_map(q, np.zeros(tree.ours.nv))
    pin.computeJointJacobians(model, data, q_p)
    pin.updateFramePlacements(model, data)
    worst = {"pose": 0.0, "jacobian": 0.0}
    positions, quaternions = mh.dynamics.forward_kinematics(tree.ours, q)
    for frame, position, quaternion in zip(tree.ours.frames, positions, quaternions, strict=True):
        if frame.name == "world":
            continue
        index = tree.frames[frame.name]
        placement = data.oMf[index]
        J = pin.getFrameJacobian(model, data, index, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        J = J.reshape(6, -1)[ANGULAR_FIRST] @ G
        rotation = Rotation.from_quat(quaternion).as_matrix()
        reach = max(float(np.linalg.norm(placement.translation)), 1.0)
        away = float(np.max(np.abs(position - placement.translation))) / reach
        worst["pose"] = max(worst["pose"], away, difference(rotation, placement.rotation))
        worst["jacobian"] = max(worst["jacobian"], difference(mh.dynamics.jacobian(tree.ours, q, frame.name), J))
    frame = tree.ours.frames[-1].name
    single = mh.dynamics.frame_pose(tree.ours, q, frame)
    assert np.array_equal(single[0], positions[-1])
    assert np.array_equal(single[1], quaternions[-1])
    return worst


def assert_equal_dynamics(tree: Tree, rng: np.random.Generator, states: int) -> None:
    for _ in range(states):
        q, v = random_state(tree.ours, rng)
        a = rng.normal(size=tree.ours.nv)
        found = dynamics_differences(tree, q, v, a) | frame_differences(tree, q)
        wrong = {name: value for name, value in found.items() if not value <= TOLERANCE}
        assert not wrong, f"{tree.ours.name}: {wrong} at q = {q.tolist()}, v = {v.tolist()}, a = {a.tolist()}"


@pytest.mark.parametrize("block", range(10))
def test_random_trees(block: int) -> None:
    kinds: set[str] = set()
    for seed in range(100 * block, 100 * block + 100):
        tree = random_tree(seed)
        kinds |= {joint.type for joint in tree.ours.joints}
        assert_equal_dynamics(tree, np.random.default_rng(seed), states=1)
    assert kinds == {"revolute", "continuous", "prismatic", "spherical", "planar", "floating", "fixed"}


def loaded(path: Path, fixed_base: bool) -> tuple[Tree, list[str]]:
    """The robot in both programs, and the joints whose inertia our loader mended: there Pinocchio gets ours."""
    ours, report = mh.load_urdf(path, fixed_base=fixed_base, load_meshes=False, allow_outside_package=True)
    base = () if fixed_base or ours.joints[0].name != "root_joint" else (pin.JointModelFreeFlyer(),)
    tree = Tree(ours, pin.buildModelFromUrdf(os.fspath(path), *base))
    poses = mh.dynamics.forward_kinematics(ours, ours.neutral_configuration())
    frames = [pin.SE3(Rotation.from_quat(r).as_matrix(), p) for p, r in zip(*poses, strict=True)]
    mended: list[str] = []
    armature = np.zeros(tree.pinocchio.nv)
    for joint, theirs in tree.joints:
        child = ours.links[joint.child]
        total = pin.Inertia.Zero()
        for i, link in enumerate(ours.links):
            if link.body == child.body:
                total += (frames[joint.child].inverse() * frames[i]).act(pin.Inertia(link.mass, link.com, link.inertia))
        if difference(total.matrix(), tree.pinocchio.inertias[theirs.id].matrix()) > 1e-12:
            names = [link.name for link in ours.links if link.body == child.body]
            assert any(name in note.element for note in report.notes for name in names), f"{joint.name}: not reported"
            mended.append(joint.name)
            tree.pinocchio.inertias[theirs.id] = total
        armature[theirs.idx_v : theirs.idx_v + theirs.nv] = joint.armature
    tree.pinocchio.armature = armature
    return tree, mended


def test_panda() -> None:
    tree, mended = loaded(mh.asset_path("panda/panda.urdf"), fixed_base=True)
    assert not mended
    assert tree.ours.nv == 9
    assert_equal_dynamics(tree, np.random.default_rng(0), states=100)


@pytest.mark.parametrize("fixed_base", [True, False], ids=["fixed", "floating"])
@pytest.mark.parametrize("name", URDFS)
def test_pybullet_robots(name: str, fixed_base: bool) -> None:
    path = PYBULLET / name
    try:
        ours, _ = mh.load_urdf(path, fixed_base=fixed_base, load_meshes=False, allow_outside_package=True)
    except mh.UrdfError as error:
        pytest.skip(f"ours: {error}")
    try:
        theirs = pin.buildModelFromUrdf(os.fspath(path))
    except (ValueError, RuntimeError) as error:
        pytest.skip(f"Pinocchio: {error}")
    if ours.nv == 0:
        assert theirs.nv == 0
        return
    tree, mended = loaded(path, fixed_base)
    if mended:
        print(f"{name}: Pinocchio was given our mended inertia of {', '.join(mended)}")
    assert_equal_dynamics(tree, np.random.default_rng(1), states=3)
