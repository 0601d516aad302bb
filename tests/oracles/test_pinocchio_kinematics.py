"""Kinematics in double equal Pinocchio's: poses, Jacobians in three forms and their derivatives, exponential maps."""

import numpy as np
import pinocchio as pin
import pytest
from pinocchio_map import ANGULAR_FIRST, Array, Tree, random_state, random_tree
from scipy.spatial.transform import Rotation

import manyhands as mh
from manyhands import kinematics as kin

FORMS: dict[kin.Form, pin.ReferenceFrame] = {
    "mixed": pin.ReferenceFrame.LOCAL_WORLD_ALIGNED,
    "space": pin.ReferenceFrame.WORLD,
    "body": pin.ReferenceFrame.LOCAL,
}
TOLERANCE = 1e-12  # relative to the largest entry, or to 1 where terms of that size cancel
ROBOTS = ("panda/panda.urdf", "arm6/arm6.urdf")


def difference(ours: Array, theirs: Array) -> float:
    return float(np.max(np.abs(ours - theirs), initial=0.0) / max(np.max(np.abs(theirs), initial=0.0), 1.0))


def moved(model: mh.Model, q: Array, v: Array, time: float) -> Array:
    """q after the velocity v has acted for a moment."""
    result = q.copy()
    for joint in model.joints:
        vj, end = time * v[joint.iv : joint.iv + joint.nv], joint.iq + joint.nq
        if joint.type in ("spherical", "floating"):
            turned = Rotation.from_rotvec(vj[:3]) * Rotation.from_quat(q[end - 4 : end])
            result[end - 4 : end] = turned.as_quat()
            vj = vj[3:]
        result[joint.iq : joint.iq + len(vj)] += vj
    return result


def assert_equal_kinematics(tree: Tree, rng: np.random.Generator) -> None:
    model, data, ours = tree.pinocchio, tree.data, tree.ours
    q, v = random_state(ours, rng)
    q_p = tree.configuration(q)
    G, drift = tree.velocity_map(q, v)
    pin.computeJointJacobiansTimeVariation(model, data, q_p, G @ v)
    pin.updateFramePlacements(model, data)
    for frame in ours.frames:
        if frame.name == "world":
            continue
        index = tree.frames[frame.name]
        position, quaternion = kin.forward(ours, q, frame.name)
        assert difference(kin.matrix(position, quaternion), data.oMf[index].homogeneous) < TOLERANCE
        for form, theirs in FORMS.items():
            J_p = pin.getFrameJacobian(model, data, index, theirs)[ANGULAR_FIRST]
            dJ_p = pin.getFrameJacobianTimeVariation(model, data, index, theirs)[ANGULAR_FIRST]
            assert difference(kin.jacobian(ours, q, frame.name, form), J_p @ G) < TOLERANCE, (form, frame.name)
            dJ = kin.jacobian_derivative(ours, q, v, frame.name, form)
            assert difference(dJ @ v, dJ_p @ G @ v + J_p @ drift) < TOLERANCE, (form, frame.name)
            if np.array_equal(G, np.eye(ours.nv)):
                assert difference(dJ, dJ_p) < TOLERANCE, (form, frame.name)


@pytest.mark.parametrize("block", range(4))
def test_random_trees(block: int) -> None:
    for seed in range(50 * block, 50 * block + 50):
        assert_equal_kinematics(random_tree(seed), np.random.default_rng(seed))


@pytest.mark.parametrize("path", ROBOTS)
def test_robots(path: str) -> None:
    file = mh.asset_path(path)
    tree = Tree(mh.load_urdf(file, load_meshes=False)[0], pin.buildModelFromUrdf(str(file)))
    for seed in range(20):
        assert_equal_kinematics(tree, np.random.default_rng(seed))


@pytest.mark.parametrize("form", FORMS)
def test_derivatives_are_what_jacobians_change_by(form: kin.Form) -> None:
    """Every entry, also of joints whose velocities Pinocchio writes in other axes."""
    for seed in range(60):
        model = random_tree(seed).ours
        rng = np.random.default_rng(seed)
        q, v = random_state(model, rng)
        frame, h = model.frames[-1].name, 1e-6
        ahead, behind = (kin.jacobian(model, moved(model, q, v, s * h), frame, form) for s in (1, -1))
        dJ = kin.jacobian_derivative(model, q, v, frame, form)
        # Central differences: h² from the third derivative, 1e-16 / h from rounding.
        np.testing.assert_allclose(dJ, (ahead - behind) / (2 * h), atol=1e-7, err_msg=f"seed {seed}")


def test_exponential_maps() -> None:
    rng = np.random.default_rng(0)
    for size in (1e-9, 1e-4, 0.1, 1.0, 3.0):
        for _ in range(50):
            w = rng.normal(size=3)
            w *= size / np.linalg.norm(w)
            v = rng.normal(size=3)
            theirs = pin.exp6(pin.Motion(v, w))
            position, quaternion = kin.exp6([*w, *v])
            np.testing.assert_allclose(kin.matrix(position, quaternion), theirs.homogeneous, atol=1e-14)
            rotation = Rotation.from_quat(kin.exp3(w)).as_matrix()
            np.testing.assert_allclose(rotation, pin.exp3(w), atol=1e-14)
            back = pin.log6(theirs)
            # Pinocchio's logarithm of a rotation matrix loses half its digits near half a turn.
            np.testing.assert_allclose(kin.log6(position, quaternion), [*back.angular, *back.linear], atol=1e-11)
            np.testing.assert_allclose(kin.log3(quaternion), pin.log3(theirs.rotation), atol=1e-11)
            Ad, swap = theirs.toActionMatrix(), np.ix_(ANGULAR_FIRST, ANGULAR_FIRST)
            np.testing.assert_allclose(kin.adjoint(position, quaternion), Ad[swap], atol=1e-14)
            inverse = theirs.toActionMatrixInverse()[swap]
            np.testing.assert_allclose(kin.adjoint(position, quaternion, inverse=True), inverse, atol=1e-14)
            carried = pin.Motion(rng.normal(size=3), rng.normal(size=3))
            rate = pin.Motion(v, w).cross(carried)
            found = kin.ad([*w, *v]) @ [*carried.angular, *carried.linear]
            np.testing.assert_allclose(found, [*rate.angular, *rate.linear], atol=1e-14)


def test_products_of_exponentials_are_forward_kinematics() -> None:
    """On every type of joint, from any home, in both forms."""
    forms: tuple[kin.Form, ...] = ("space", "body")
    for seed in range(100):
        model = random_tree(seed).ours
        rng = np.random.default_rng(seed)
        home, q = random_state(model, rng)[0], np.array([random_state(model, rng)[0] for _ in range(3)])
        theta = kin.screw_coordinates(model, q, home)
        frame = model.frames[-1].name
        expected = kin.matrix(*kin.forward(model, q, frame))
        for form in forms:
            screws = kin.screw_axes(model, frame, home, form)  # pyright: ignore[reportArgumentType]
            np.testing.assert_array_equal(screws.axes, kin.jacobian(model, home, frame, form))
            found = kin.matrix(*kin.product_of_exponentials(screws, theta))
            np.testing.assert_allclose(found, expected, atol=1e-12, err_msg=f"seed {seed}")
