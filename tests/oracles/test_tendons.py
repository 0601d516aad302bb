"""Tendons: lengths, rates and accelerations equal MuJoCo's; where its constraints are soft, the exact ones that its
dynamics imply."""

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

import manyhands as mh  # noqa: E402
from benchmarks.mujoco_map import Array, Scene  # noqa: E402

INERTIAL = '<inertial pos="0.1 -0.2 0.3" mass="1.5" diaginertia="0.02 0.03 0.04"/>'

# A hand of two fingers on an arm, a free body and a pendulum beside it.
BODIES = f"""
<worldbody>
  <site name="hook" pos="0.3 0.1 1.5"/>
  <body name="arm" pos="0 0 1" euler="10 20 30"><joint name="a" axis="1 2 3" ref="0.2"/>{INERTIAL}
    <site name="on_arm" pos="0.1 0.1 0"/>
    <body name="wrist" pos="0.1 0 0.3"><joint name="w" type="slide" axis="0 1 1"/>{INERTIAL}
      <body name="f1" pos="0 0.2 0"><joint name="f1" axis="1 0 0" ref="-0.1"/>{INERTIAL}
        <site name="s1" pos="0 0.1 0.1"/>
        <body name="g1" pos="0 0.2 0"><joint name="g1" axis="1 0 0.3"/>{INERTIAL}
          <site name="t1" pos="0.1 0.2 0"/></body>
      </body>
      <body name="f2" pos="0 -0.2 0"><joint name="f2" axis="1 0 0"/>{INERTIAL}<site name="s2" pos="0 -0.1 0.1"/>
        <body name="g2" pos="0 -0.2 0"><joint name="g2" type="ball"/>{INERTIAL}<site name="t2" pos="0.1 0 0.2"/></body>
      </body></body></body>
  <body name="free" pos="1 2 3" euler="30 20 10"><joint name="x" type="free"/>{INERTIAL}
    <site name="on_free" pos="0 0.2 0"/>
    <body name="e" pos="0 0.2 0"><joint name="e" axis="0 1 0"/>{INERTIAL}<site name="on_e" pos="0 0.2 0"/></body></body>
  <body name="other" pos="-1 0 1"><joint name="p" axis="0 1 0"/>{INERTIAL}<site name="on_p" pos="0.2 0 0.1"/></body>
</worldbody>"""

TENDONS = """
<tendon>
  <fixed name="chain" stiffness="40" springlength="0.3" damping="0.7" armature="0.05">
    <joint joint="a" coef="1.5"/><joint joint="w" coef="-2"/><joint joint="f1" coef="0.5"/></fixed>
  <fixed name="branches" stiffness="30" damping="0.4"><joint joint="g1" coef="1"/>
    <joint joint="f2" coef="-0.7"/></fixed>
  <fixed name="trees" stiffness="9" springlength="-0.2 0.3">
    <joint joint="p" coef="2"/><joint joint="e" coef="1"/><joint joint="a" coef="0.3"/></fixed>
  <spatial name="rope" stiffness="55" damping="0.9" armature="0.2"><site site="hook"/><site site="on_arm"/>
    <site site="s1"/><site site="t1"/></spatial>
  <spatial name="between" stiffness="25" springlength="0.5 0.9" damping="0.3"><site site="t1"/>
    <site site="t2"/></spatial>
  <spatial name="far" stiffness="15"><site site="on_e"/><site site="on_p"/><site site="s2"/><site site="on_free"/>
    </spatial>
  <spatial name="pulleys" stiffness="35" damping="0.2"><site site="hook"/><site site="s1"/>
    <pulley divisor="2"/><site site="s1"/><site site="on_free"/><pulley divisor="3"/><site site="s1"/>
    <site site="t2"/></spatial>
</tendon>"""

ACTUATORS = """
<actuator>
  <motor tendon="chain" gear="2"/><position tendon="branches" kp="20" kv="3"/><velocity tendon="rope" kv="2"/>
  <general tendon="far" gainprm="0.3" biasprm="1.5 -20 -1" biastype="affine" ctrlrange="-9 9"/>
  <general joint="p" gainprm="3" biasprm="0.5 0 -1" biastype="affine" gear="-1.5"/>
  <general tendon="pulleys" gainprm="3" biasprm="0.5 0 0" biastype="affine" gear="0.5" forcerange="-1.2 1.2"/>
</actuator>"""


# Slow enough for a step of a millisecond.
DAMPED = BODIES.replace("axis=", 'damping="0.5" axis=').replace('type="ball"', 'type="ball" damping="0.5"')


def scene_of(*sections: str) -> Scene:
    return Scene.of_string(f'<mujoco><option gravity="1 2 -9"/>{"".join(sections)}</mujoco>')


def randomise(scene: Scene, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """MuJoCo's data in a random state, and ours: q, v and the map of velocities."""
    model, data = scene.mujoco, scene.data
    data.qpos = scene.random_qpos(rng)
    data.qvel = rng.uniform(-1, 1, model.nv)
    if model.nu:
        data.ctrl = rng.uniform(-2, 2, model.nu)
    mujoco.mj_forward(model, data)
    G = scene.velocity_map(data.qpos)
    return scene.configuration(data.qpos), G @ data.qvel, G


def acceleration(model: mh.Model, q: Array, v: Array, ctrl: Array) -> Array:
    """v' (nv) in this state, by short steps, extrapolated to none."""

    def mean(step: float) -> Array:
        world = mh.World(model, time_step=step)
        world.q, world.v, world.ctrl = q, v, ctrl
        world.step()
        return (np.asarray(world.v) - v) / step

    return 2 * mean(5e-8) - mean(1e-7)


def test_lengths_and_rates() -> None:
    scene = scene_of(BODIES, TENDONS)
    world, rng = mh.World(scene.ours), np.random.default_rng(0)
    assert [t.name for t in scene.ours.tendons] == [scene.mujoco.tendon(i).name for i in range(scene.mujoco.ntendon)]
    for _ in range(50):
        world.q, world.v, _ = randomise(scene, rng)
        np.testing.assert_allclose(world.tendon_lengths, scene.data.ten_length, rtol=0, atol=1e-12)
        np.testing.assert_allclose(world.tendon_velocities, scene.data.ten_velocity, rtol=0, atol=1e-12)


@pytest.mark.parametrize("sections", [(TENDONS,), (TENDONS, ACTUATORS)], ids=["passive", "driven"])
def test_accelerations(sections: tuple[str, ...]) -> None:
    scene, rng = scene_of(BODIES, *sections), np.random.default_rng(1)
    for k in range(30):
        q, v, G = randomise(scene, rng)
        a = G @ scene.data.qacc
        ours = acceleration(scene.ours, q, v, np.array(scene.data.ctrl))
        assert np.max(np.abs(ours - a)) < 1e-6 * max(1.0, np.max(np.abs(a))), k


STIFF = """
<tendon>
  <fixed name="chain" limited="true" range="-0.1 0.2" frictionloss="0.3"><joint joint="a" coef="1.5"/>
    <joint joint="w" coef="-2"/><joint joint="f1" coef="0.5"/></fixed>
  <spatial name="between" range="0 0.35"><site site="t1"/><site site="t2"/></spatial>
  <fixed name="one"><joint joint="f2" coef="1"/></fixed>
  <fixed name="two"><joint joint="g1" coef="1"/><joint joint="p" coef="0.3"/></fixed>
  <spatial name="far"><site site="on_e"/><site site="on_p"/></spatial>
</tendon>
<equality><tendon tendon1="one" tendon2="two" polycoef="0.1 0.6 -0.3 0.2 0.05"/>
  <tendon tendon1="far" polycoef="0.2"/></equality>"""


POLYNOMIAL = np.polynomial.Polynomial([0.1, 0.6, -0.3, 0.2, 0.05])


def open_by(scene: Scene, length: Array) -> Array:
    """The errors of both equations at MuJoCo's lengths."""
    names = [scene.mujoco.tendon(i).name for i in range(scene.mujoco.ntendon)]
    change = dict(zip(names, length - scene.mujoco.tendon_length0, strict=True))
    return np.array([change["one"] - POLYNOMIAL(change["two"]), change["far"] - 0.2])


def errors_from(scene: Scene, direction: Array, by: float) -> Array:
    """The same where MuJoCo's state has moved on."""
    model, data = scene.mujoco, mujoco.MjData(scene.mujoco)
    data.qpos[:] = scene.data.qpos
    mujoco.mj_integratePos(model, data.qpos, direction, by)
    mujoco.mj_fwdPosition(model, data)
    return open_by(scene, data.ten_length)


def equation_rows(scene: Scene) -> tuple[Array, Array]:
    """J of both equations, and its rate times v, by differences."""
    h, v = 1e-4, np.array(scene.data.qvel)
    columns = [(errors_from(scene, e, h) - errors_from(scene, e, -h)) / (2 * h) for e in np.eye(scene.mujoco.nv)]
    bend = (errors_from(scene, v, h) - 2 * errors_from(scene, v, 0) + errors_from(scene, v, -h)) / h**2
    return np.stack(columns, axis=1), bend


def test_equations_between_tendons_close_and_stay_closed() -> None:
    """From a random state, at no more than 1 m/s; then to the third order of the step."""
    scene = scene_of(DAMPED, STIFF)
    world, rng = mh.World(scene.ours, 1e-3), np.random.default_rng(2)
    for _ in range(3):
        q, _, _ = randomise(scene, rng)
        world.forget()
        world.q, world.v = q, np.zeros(scene.ours.nv)
        world.step(4000)
        for _ in range(300):
            world.step()
            assert np.max(np.abs(open_by(scene, world.tendon_lengths))) < 3e-5


def test_equations_accelerate_as_mujocos_dynamics_say() -> None:
    """With equations alone: [M, -J^T; J, 0] [a; force] = [-bias; -rate of J times v], to what differences lose."""
    only = STIFF.replace('limited="true" range="-0.1 0.2" frictionloss="0.3"', "").replace('range="0 0.35"', "")
    scene, rng = scene_of(BODIES, only), np.random.default_rng(3)
    model, data = scene.mujoco, scene.data
    none = np.zeros(model.nv)
    for seed in range(20):
        randomise(scene, rng)
        for _ in range(30):  # to a state that the equations allow
            mujoco.mj_integratePos(
                model, data.qpos, -np.linalg.pinv(equation_rows(scene)[0]) @ errors_from(scene, none, 0), 1
            )
        J, _ = equation_rows(scene)
        data.qvel = data.qvel - np.linalg.pinv(J) @ (J @ data.qvel)
        mujoco.mj_forward(model, data)
        M, (J, bend) = np.zeros((model.nv, model.nv)), equation_rows(scene)
        mujoco.mj_fullM(model, data, M)
        system = np.block([[M, -J.T], [J, np.zeros((2, 2))]])
        G = scene.velocity_map(data.qpos)
        a = G @ np.linalg.solve(system, np.concatenate([-data.qfrc_bias, -bend]))[: model.nv]
        q, v = scene.configuration(data.qpos), G @ data.qvel
        means, half = [], np.linalg.solve(M, J.T @ np.linalg.solve(J @ np.linalg.solve(M, J.T), bend / 2))
        for step in (1e-4, 5e-5):
            world = mh.World(scene.ours, step)
            world.q, world.v = (
                q,
                v + step * (G @ half),
            )  # a step leaves positions right, and velocities half of one late
            before = np.asarray(world.v)
            world.step()
            means.append((np.asarray(world.v) - before) / step)
        ours = 2 * means[1] - means[0]
        assert np.max(np.abs(ours - a)) < 1e-5 * max(1.0, np.max(np.abs(a))), seed


def test_limits_are_kept() -> None:
    """Within them, or as far beyond as the arc of a step."""
    scene = scene_of(DAMPED, STIFF)
    world, rng = mh.World(scene.ours, 1e-3), np.random.default_rng(4)
    beyond, touched = 0.0, 0
    for _ in range(3):
        world.forget()
        world.q, world.v = scene.ours.initial_configuration(), rng.uniform(-2, 2, scene.ours.nv)
        world.step(3000)
        for _ in range(2000):
            world.step()
            chain, between = np.asarray(world.tendon_lengths)[:2]
            beyond = max(beyond, -0.1 - chain, chain - 0.2, between - 0.35)
            touched += min(abs(-0.1 - chain), abs(chain - 0.2), abs(between - 0.35)) < 1e-6
    assert beyond < 1e-3
    assert touched > 100


def test_saved_models_are_the_same() -> None:
    for sections in ((TENDONS, ACTUATORS), (STIFF,)):
        model = scene_of(BODIES, *sections).ours
        again, report = mh.load_mjcf_string(mh.save_mjcf_string(model)[0])
        assert not any(note.serious for note in report.notes)
        assert [repr(t.branches) for t in again.tendons] == [repr(t.branches) for t in model.tendons]
        assert again.fingerprint == model.fingerprint
