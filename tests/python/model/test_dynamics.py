"""The Python face of model, dynamics and world: shapes, types, errors. tests/oracles proves the numbers."""

import threading

import numpy as np
import pytest

import manyhands as mh
from manyhands import _core


def arm(name: str = "arm") -> mh.Model:
    """Two hinges of 1 m, 1 kg each at their tips, and a tool."""
    builder = mh.ModelBuilder(name)
    parent = "world"
    for i in range(2):
        builder.add_link(f"link{i}", mass=1.0, com=(1.0, 0.0, 0.0))
        builder.add_joint(
            f"joint{i}", "revolute", parent, f"link{i}", position=(float(i), 0.0, 0.0), axis=(0.0, -1.0, 0.0),
            lower=-2.0, upper=2.5, damping=0.1,
        )  # fmt: skip
        parent = f"link{i}"
    builder.add_frame("tool", "link1", position=(1.0, 0.0, 0.0))
    return builder.build()


def test_model_says_what_it_is() -> None:
    model = arm()
    assert (model.name, model.nq, model.nv, model.num_bodies) == ("arm", 2, 2, 3)
    assert [link.name for link in model.links] == ["world", "link0", "link1"]
    assert [frame.name for frame in model.frames] == ["world", "link0", "link1", "tool"]
    joint = model.joint("joint1")
    assert (joint.type, joint.lower, joint.upper) == ("revolute", -2.0, 2.5)
    assert (joint.damping, joint.iq, joint.iv) == (0.1, 1, 1)
    np.testing.assert_array_equal(joint.axis, [0.0, -1.0, 0.0])
    np.testing.assert_array_equal(model.link("link0").com, [1.0, 0.0, 0.0])
    np.testing.assert_array_equal(model.gravity, [0.0, 0.0, -9.81])
    assert model.links[joint.child].name == "link1"
    assert "nq 2" in repr(model)


def test_formulas_of_a_planar_arm() -> None:
    model = arm()
    q0, q1 = 0.4, 0.7
    q = np.array([q0, q1])
    tip = np.array([np.cos(q0) + np.cos(q0 + q1), 0.0, np.sin(q0) + np.sin(q0 + q1)])
    position, quaternion = mh.dynamics.frame_pose(model, q, "tool")
    np.testing.assert_allclose(position, tip, atol=1e-15)
    angle = -(q0 + q1) / 2  # about y
    np.testing.assert_allclose(quaternion, [0.0, np.sin(angle), 0.0, np.cos(angle)], atol=1e-15)
    J = mh.dynamics.jacobian(model, q, "tool")
    np.testing.assert_allclose(J[:3], [[0.0, 0.0], [-1.0, -1.0], [0.0, 0.0]], atol=1e-15)
    np.testing.assert_allclose(J[3], [-tip[2], -np.sin(q0 + q1)], atol=1e-15)
    np.testing.assert_allclose(J[5], [tip[0], np.cos(q0 + q1)], atol=1e-15)
    gravity = 9.81 * np.array([np.cos(q0) + tip[0], np.cos(q0 + q1)])
    np.testing.assert_allclose(mh.dynamics.rnea(model, q, [0, 0], [0, 0]), gravity, rtol=1e-14)
    M = [[3 + 2 * np.cos(q1), 1 + np.cos(q1)], [1 + np.cos(q1), 1]]
    np.testing.assert_allclose(mh.dynamics.crba(model, q), M, rtol=1e-14)
    kinetic, potential = mh.dynamics.energy(model, q, [1.0, 2.0])
    np.testing.assert_allclose(kinetic, 0.5 * np.array([1.0, 2.0]) @ M @ [1.0, 2.0], rtol=1e-14)
    np.testing.assert_allclose(potential, 9.81 * (np.sin(q0) + tip[2]), rtol=1e-14)
    np.testing.assert_allclose(mh.dynamics.center_of_mass(model, q)[0], (np.cos(q0) + tip[0]) / 2, rtol=1e-14)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_rows_are_single_states(dtype: type) -> None:
    model = arm()
    rng = np.random.default_rng(0)
    q, v, a = (rng.normal(size=(21, 2)).astype(dtype) for _ in range(3))
    d = mh.dynamics
    calls = {
        "rnea": (d.rnea(model, q, v, a), lambda i: d.rnea(model, q[i], v[i], a[i])),
        "aba": (d.aba(model, q, v, a), lambda i: d.aba(model, q[i], v[i], a[i])),
        "crba": (d.crba(model, q), lambda i: d.crba(model, q[i])),
        "jacobian": (d.jacobian(model, q, "tool"), lambda i: d.jacobian(model, q[i], "tool")),
        "position": (d.frame_pose(model, q, "tool")[0], lambda i: d.frame_pose(model, q[i], "tool")[0]),
        "poses": (d.forward_kinematics(model, q)[1], lambda i: d.forward_kinematics(model, q[i])[1]),
        "com": (d.center_of_mass(model, q), lambda i: d.center_of_mass(model, q[i])),
        "momentum": (d.momentum(model, q, v), lambda i: d.momentum(model, q[i], v[i])),
        "kinetic": (d.energy(model, q, v)[0], lambda i: d.energy(model, q[i], v[i])[0]),
    }
    for name, (batch, single) in calls.items():
        assert batch.dtype == dtype, name
        assert batch.shape[0] == 21, name
        for i in range(21):
            assert batch[i].shape == single(i).shape, name
            assert np.array_equal(batch[i], single(i)), name
    assert d.crba(model, q[:0]).shape == (0, 2, 2)


def test_float32_runs_in_lanes_and_follows_float64() -> None:
    model, _ = mh.load_urdf(mh.asset_path("panda/panda.urdf"), load_meshes=False)
    rng = np.random.default_rng(1)
    q, v, a = (rng.uniform(-1, 1, size=(50, 9)).astype(np.float32) for _ in range(3))
    tau = mh.dynamics.rnea(model, q, v, a)
    for width in (1, mh.Batch(model, 2).lanes):
        assert np.array_equal(_core.dynamics.rnea(model, q, v, a, width=width), tau), width
    with pytest.raises(ValueError, match="width is 5"):
        _core.dynamics.rnea(model, q, v, a, width=5)
    reference = mh.dynamics.rnea(model, q.astype(float), v.astype(float), a.astype(float))
    np.testing.assert_allclose(tau, reference, atol=1e-6 * np.max(np.abs(reference)))  # float carries 6e-8
    back = mh.dynamics.aba(model, q, v, tau)
    np.testing.assert_allclose(back, a, atol=1e-3)  # times the condition of M, up to 1e4


def test_types_and_layouts_of_input() -> None:
    model = arm()
    q = np.array([[0.1, 0.2], [0.3, 0.4]], np.float32)
    assert mh.dynamics.rnea(model, q, q, q).dtype == np.float32
    assert mh.dynamics.rnea(model, q, q.astype(np.float64), q).dtype == np.float64
    assert mh.dynamics.crba(model, [1, 2]).dtype == np.float64
    spread = np.arange(8.0).reshape(2, 4)[:, ::2]
    np.testing.assert_array_equal(mh.dynamics.crba(model, spread), mh.dynamics.crba(model, spread.copy()))
    fortran = np.asfortranarray(q)
    np.testing.assert_array_equal(mh.dynamics.crba(model, fortran), mh.dynamics.crba(model, q))


def test_errors_name_the_array() -> None:
    model, q = arm(), np.zeros((3, 2))
    with pytest.raises(ValueError, match=r"v has shape \(3, 1\); expected \(3, 2\)"):
        mh.dynamics.rnea(model, q, q[:, :1], q)
    with pytest.raises(ValueError, match=r"tau has shape \(2,\); expected \(3, 2\)"):
        mh.dynamics.aba(model, q, q, q[0])
    with pytest.raises(ValueError, match=r"q has shape \(5,\); expected \(2,\) or \(n, 2\)"):
        mh.dynamics.crba(model, np.zeros(5))
    with pytest.raises(ValueError, match="q holds complex128"):
        mh.dynamics.crba(model, q * 1j)
    with pytest.raises(KeyError, match="'tool'"):
        mh.dynamics.frame_pose(model, q, "tol")
    with pytest.raises(KeyError, match="joint0"):
        model.joint("elbow")


def test_builder_errors() -> None:
    builder = mh.ModelBuilder()
    builder.add_link("a", mass=1.0)
    with pytest.raises(ValueError, match="'a' already"):
        builder.add_link("a")
    with pytest.raises(KeyError, match="'b'"):
        builder.add_joint("j", "revolute", "a", "b")
    with pytest.raises(ValueError, match=r"'hinge'.*'revolute'"):
        builder.add_joint("j", "hinge", "world", "a")
    with pytest.raises(ValueError, match="quaternion"):
        builder.add_joint("j", "revolute", "world", "a", quaternion=(0, 0, 0, 0))
    builder.add_joint("j", "revolute", "world", "a")
    with pytest.raises(ValueError, match="moves no inertia"):
        builder.build()


def test_load_urdf_errors(tmp_path) -> None:
    with pytest.raises(FileNotFoundError, match=r"nothing\.urdf"):
        mh.load_urdf(tmp_path / "nothing.urdf")
    bad = tmp_path / "bad.urdf"
    bad.write_text("<robot name='x'>\n<link>\n</robot>")
    with pytest.raises(mh.UrdfError, match=r"bad\.urdf:\d"):
        mh.load_urdf(bad)
    assert issubclass(mh.UrdfError, ValueError)


def test_load_urdf_reports() -> None:
    model, report = mh.load_urdf(mh.asset_path("panda/panda.urdf"), load_meshes=False)
    assert model.nq == model.nv == 9
    assert isinstance(str(report), str)
    assert len(report) == len(report.notes)


def test_threads_share_a_model() -> None:
    model = arm()
    q = np.random.default_rng(0).normal(size=(20_000, 2))
    expected = mh.dynamics.crba(model, q)
    found: list[np.ndarray] = []
    threads = [threading.Thread(target=lambda: found.append(mh.dynamics.crba(model, q))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4
    assert all(np.array_equal(M, expected) for M in found)


def test_world_moves_and_returns() -> None:
    world = mh.World(arm(), time_step=0.001)
    world.q = [0.5, 0.2]
    world.set_motors(target_q=[0.0, 0.3], max_force=1e4)
    world.step(10)
    snapshot, digest = world.snapshot(), world.state_hash()
    assert world.time == pytest.approx(0.01)
    world.step(2000)
    np.testing.assert_allclose(world.q, [0.0, 0.3], atol=1e-9)
    assert world.state_hash() != digest
    world.restore(snapshot)
    assert world.state_hash() == digest
    with pytest.raises(ValueError, match="read-only"):
        world.q[0] = 1.0
    with pytest.raises(ValueError, match=r"v has shape \(3,\); expected \(2,\)"):
        world.v = np.zeros(3)
    with pytest.raises(ValueError, match="'semi_implicit' and 'rk4'"):
        mh.World(arm(), integrator="euler")  # pyright: ignore[reportArgumentType]


def test_world_agrees_with_dynamics() -> None:
    model = arm()
    world = mh.World(model, time_step=1e-6)
    q, v, tau = np.array([0.3, -0.4]), np.array([1.0, 0.5]), np.array([2.0, -1.0])
    world.q, world.v, world.tau = q, v, tau
    a = mh.dynamics.aba(model, q, v, tau - 0.1 * v)  # damping
    assert world.energy() == pytest.approx(tuple(float(e) for e in mh.dynamics.energy(model, q, v)))
    np.testing.assert_allclose(world.momentum(), mh.dynamics.momentum(model, q, v))
    np.testing.assert_allclose(world.center_of_mass(), mh.dynamics.center_of_mass(model, q))
    world.step()
    np.testing.assert_allclose((world.v - v) / 1e-6, a, rtol=1e-4)


def test_runge_kutta_refuses_motors() -> None:
    world = mh.World(arm(), integrator="rk4")
    world.step(5)
    world.set_motors(max_force=1.0)
    with pytest.raises(RuntimeError, match="motors"):
        world.step()
