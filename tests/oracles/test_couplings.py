"""Joints coupled with each other, ancestors included, move as MuJoCo's dynamics say."""

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

import manyhands as mh  # noqa: E402
from benchmarks.mujoco_map import Array, Scene  # noqa: E402

TREES = 1000
STEP = 1e-3  # [s]


def inertial(rng: np.random.Generator) -> str:
    x, y, z = rng.uniform(0.05, 0.5, 3)
    mass = rng.uniform(0.2, 5)
    diagonal = mass / 12 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])
    return (
        f'<inertial pos="{numbers(rng.uniform(-0.2, 0.2, 3))}" quat="{numbers(rng.normal(size=4))}" '
        f'mass="{float(mass)!r}" diaginertia="{numbers(diagonal)}"/>'
    )


def numbers(values: Array) -> str:
    return " ".join(repr(float(x)) for x in values)


def random_scene(rng: np.random.Generator) -> tuple[str, list[tuple[int, int, float, float]]]:
    """A random tree in MJCF, and its couplings (driver, driven, offset, ratio) by joints: q_1 = offset + ratio q_0.

    No joint is driven twice, and drivers come first in the list, so that the rows are independent. Joints of one degree
    of freedom are called j0, j1, ... in the order of the bodies.
    """
    count = int(rng.integers(3, 10))
    parents = [int(i if rng.random() < 0.7 else rng.integers(0, i + 1)) for i in range(count)]  # 0 is the world
    kinds = rng.choice(["hinge", "hinge", "slide", "ball", "free"], size=count).tolist()
    kinds[1] = kinds[2] = "hinge"
    single: list[int] = []

    def body(i: int) -> str:
        pose = f'pos="{numbers(rng.uniform(-0.5, 0.5, 3))}" quat="{numbers(rng.normal(size=4))}"'
        kind = kinds[i] if kinds[i] != "free" or parents[i] == 0 else "hinge"
        if kind in ("hinge", "slide"):
            joint = f'<joint name="j{i}" type="{kind}" axis="{numbers(rng.normal(size=3))}" armature="0.01"/>'
            single.append(i)
        else:
            joint = "<freejoint/>" if kind == "free" else '<joint type="ball" armature="0.01"/>'
        inner = "".join(body(k) for k in range(i + 1, count) if parents[k] == i + 1)
        return f'<body name="b{i}" {pose}>{joint}{inertial(rng)}{inner}</body>'

    bodies = "".join(body(i) for i in range(count) if parents[i] == 0)
    order = rng.permutation(single).tolist()
    couplings = [
        (order[int(rng.integers(0, k))], order[k], float(rng.uniform(-0.5, 0.5)), float(rng.uniform(-3, 3)))
        for k in range(1, min(len(order), 1 + int(rng.integers(1, 4))))
    ]
    rows = "".join(
        f'<joint joint1="j{driven}" joint2="j{driver}" polycoef="{offset!r} {ratio!r} 0 0 0" solref="-1 -1" '
        'solimp="0.9999 0.9999 0.001 0.5 2"/>'
        for driver, driven, offset, ratio in couplings
    )
    text = (
        '<mujoco><compiler angle="radian"/><option solver="Newton" tolerance="0" iterations="200"><flag '
        f'contact="disable"/></option><worldbody>{bodies}</worldbody><equality>{rows}</equality></mujoco>'
    )
    return text, couplings


class CoupledTree:
    """A random tree whose state obeys its couplings."""

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        text, self.couplings = random_scene(rng)
        self.scene = Scene.of_string(text, compliance="none")
        model, data = self.scene.mujoco, self.scene.data
        data.qpos[:] = self.scene.random_qpos(rng)
        data.qvel[:] = rng.uniform(-2, 2, model.nv)
        for driver, driven, offset, ratio in self.couplings:
            one, other = model.joint(f"j{driver}"), model.joint(f"j{driven}")
            data.qpos[other.qposadr[0]] = offset + ratio * data.qpos[one.qposadr[0]]
            data.qvel[other.dofadr[0]] = ratio * data.qvel[one.dofadr[0]]
        mujoco.mj_forward(model, data)

    def ancestors(self) -> int:
        """How many couplings join a joint with one that it hangs on."""
        model, found = self.scene.mujoco, 0
        for driver, driven, _, _ in self.couplings:
            low, body = sorted((model.body(f"b{driver}").id, model.body(f"b{driven}").id))
            while body > low:
                body = model.body_parentid[body]
            found += body == low
        return found

    def accelerations(self, softness: Array, aim: Array) -> Array:
        """Accelerations (nv) in MuJoCo's coordinates: [M, -J^T; J, diag(softness)] [a; force] = [-bias; aim], of which
        M, the bias force and the rows J are MuJoCo's. Softness and aim are 0 where the couplings hold exactly, since J
        is constant."""
        model, data = self.scene.mujoco, self.scene.data
        M = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, M)
        J = self.rows()
        system = np.block([[M, -J.T], [J, np.diag(softness)]])
        solution = np.linalg.solve(system, np.concatenate([-data.qfrc_bias, aim]))
        return solution[: model.nv].astype(np.float64)

    def rows(self) -> Array:
        model, data = self.scene.mujoco, self.scene.data
        J = np.zeros((data.nefc, model.nv))
        for i in range(data.nefc):
            unit = np.zeros(data.nefc)
            unit[i] = 1
            mujoco.mj_mulJacTVec(model, data, J[i], unit)
        return J

    def ours(self) -> Array:
        """Accelerations (nv) in our coordinates by one step: the velocity it adds is its length times these, whatever
        the length."""
        data = self.scene.data
        world = mh.World(self.scene.ours, STEP)
        world.q = self.scene.configuration(data.qpos)
        v = self.scene.velocity_map(data.qpos) @ data.qvel
        world.v = v
        world.step()
        return (np.asarray(world.v) - v) / STEP


def test_random_couplings_accelerate_as_mujocos_dynamics_say() -> None:
    """Ours equal, to 1e-8 of the largest, the exact constrained accelerations that MuJoCo's mass matrix, bias force
    and constraint rows imply, by linear algebra of our own. MuJoCo's couplings are always soft: its own `qacc` equals
    the same linear system with its own softness R, so that nothing is left out there."""
    ancestors = 0
    for seed in range(TREES):
        tree = CoupledTree(seed)
        data, none = tree.scene.data, np.zeros(tree.scene.data.nefc)
        exact = tree.accelerations(none, none)
        scale = 1 + float(np.max(np.abs(exact)))
        expected = tree.scene.velocity_map(data.qpos) @ exact
        assert np.max(np.abs(tree.ours() - expected)) <= 1e-8 * scale, f"seed {seed}"
        soft = tree.accelerations(data.efc_R, data.efc_aref)
        assert np.max(np.abs(data.qacc - soft)) <= 1e-8 * scale, f"MuJoCo's own, seed {seed}"
        ancestors += tree.ancestors()
    assert ancestors > TREES / 4


def chain(links: int, ratio: float, angle: float) -> str:
    """Rods that hang on each other by hinges, each turning `ratio` times as far as the first."""
    text = ""
    for i in reversed(range(links)):
        place = "" if i == 0 else 'pos="0 0 -0.3"'
        text = (
            f'<body name="b{i}" {place}><joint name="j{i}" axis="0 1 0"/>{text}<geom type="capsule" '
            'fromto="0 0 0 0 0 -0.3" size="0.02" mass="1" contype="0" conaffinity="0"/></body>'
        )
    rows = "".join(f'<joint joint1="j{i}" joint2="j0" polycoef="0 {ratio!r} 0 0 0"/>' for i in range(1, links))
    angles = " ".join([repr(angle)] + [repr(angle * ratio)] * (links - 1))
    return (
        '<mujoco><compiler angle="radian"/><option timestep="0.002"><flag energy="enable"/></option>'
        f'<worldbody>{text}</worldbody><equality>{rows}</equality><keyframe><key qpos="{angles}"/></keyframe></mujoco>'
    )


def reduced_motion(scene: Scene, ratio: float, angle: float, steps: int) -> tuple[Array, Array]:
    """The first joint's angle (steps) and the energy (steps) [J] by semi-implicit Euler with the couplings solved for:
    one degree of freedom, whose inertia and bias are those of MuJoCo's that it moves."""
    model = scene.mujoco
    data, J, h = mujoco.MjData(model), np.array([1.0] + [ratio] * (model.nv - 1)), model.opt.timestep
    M = np.zeros((model.nv, model.nv))
    q, v = angle, 0.0
    angles, energies = np.zeros(steps), np.zeros(steps)
    for i in range(steps):
        data.qpos[:], data.qvel[:] = J * q, J * v
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, data, M)
        energies[i] = np.sum(data.energy)
        v -= h * (J @ data.qfrc_bias) / (J @ M @ J)
        q += h * v
        angles[i] = q
    return angles, energies - energies[0]


@pytest.mark.parametrize("links", [2, 3, 5])
@pytest.mark.parametrize("ratio", [1.0, -0.5, 2.0])
def test_coupled_chains_move_as_one_degree_of_freedom(links: int, ratio: float) -> None:
    """10 s at 2 ms from rest. The angles are those of the reduced system, integrated alike; so the energy drifts by as
    much as the integrator makes it, and by no more than MuJoCo's, which loses some in its soft couplings, where that is
    more. With two links it stays within 0.3 J."""
    scene, angle, steps = Scene.of_string(chain(links, ratio, 1.2)), 1.2, 5000
    model, data = scene.mujoco, scene.data
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    world = mh.World(scene.ours, model.opt.timestep)
    world.q = data.qpos
    start, their_start = float(sum(world.energy())), float(np.sum(data.energy))
    angles, energies, theirs = np.zeros((steps, links)), np.zeros(steps), np.zeros(steps)
    for i in range(steps):
        energies[i] = sum(world.energy()) - start
        theirs[i] = np.sum(data.energy) - their_start
        world.step()
        mujoco.mj_step(model, data)
        angles[i] = world.q
    expected, reduced = reduced_motion(scene, ratio, angle, steps)
    np.testing.assert_allclose(angles, np.outer(expected, [1.0] + [ratio] * (links - 1)), rtol=0, atol=1e-7)
    drift, their_drift, integrators = (abs(float(np.mean(x[-500:]))) for x in (energies, theirs, reduced))
    assert drift <= max(their_drift, integrators + 1e-6)
    if links == 2:
        assert np.max(np.abs(energies)) <= 0.3
