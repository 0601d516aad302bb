"""Forces that files ask for besides motors and contacts: accelerations equal MuJoCo's in any state."""

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from mujoco_map import Array, Scene  # noqa: E402

import manyhands as mh  # noqa: E402

INERTIAL = '<inertial pos="0.1 -0.2 0.3" mass="1.5" diaginertia="0.02 0.03 0.04"/>'

SPRINGS = f"""
<mujoco><compiler angle="degree"/><option gravity="1 2 -9"/><worldbody>
  <body name="a" pos="0 0 1" euler="10 20 30"><joint name="h" axis="1 2 3" stiffness="40" springref="25" ref="10"/>{INERTIAL}
    <body name="b" pos="0.1 0 0.3"><joint name="s" type="slide" axis="0 1 1" stiffness="300" springref="0.2"/>{INERTIAL}
      <body name="c" pos="0 0.2 0"><joint name="ball" type="ball" stiffness="7" damping="0.3" pos="0.1 0 0"/>{INERTIAL}
        <body name="d" pos="0 0.2 0"><joint name="d" springdamper="0.1 0.7" armature="0.01"/>{INERTIAL}</body></body>
    </body></body>
  <body name="free" pos="1 2 3" euler="30 20 10"><joint type="free" stiffness="11" damping="0.2"/>{INERTIAL}
    <body name="e" pos="0 0.2 0"><joint name="e" type="ball" springdamper="0.2 1.3"/>{INERTIAL}</body></body>
  <body name="soft" pos="3 2 3"><joint type="free" springdamper="0.3 0.9"/>{INERTIAL}</body>
</worldbody></mujoco>"""


def acceleration(model: mh.Model, q: Array, v: Array, ctrl: Array | None = None, step: float = 1e-7) -> Array:
    """v' (nv) in this state, by a step too short for anything to change."""
    world = mh.World(model, time_step=step)
    world.q = q
    world.v = v
    if ctrl is not None:
        world.ctrl = ctrl
    world.step()
    return (np.asarray(world.v) - v) / step


def assert_equal_accelerations(text: str, states: int = 20) -> None:
    scene = Scene.of_string(text)
    model, data = scene.mujoco, scene.data
    rng = np.random.default_rng(0)
    for k in range(states):
        data.qpos = model.qpos0 if k == 0 else scene.random_qpos(rng)
        data.qvel = 0 if k == 0 else rng.uniform(-1, 1, model.nv)
        if model.nu:
            data.ctrl = rng.uniform(-2, 2, model.nu)
        mujoco.mj_forward(model, data)
        G = scene.velocity_map(data.qpos)  # of angular accelerations, too: omega x omega = 0
        v, a = G @ data.qvel, G @ data.qacc
        ours = acceleration(scene.ours, scene.configuration(data.qpos), v, np.array(data.ctrl))
        assert np.max(np.abs(ours - a)) < 1e-6 * max(1.0, np.max(np.abs(a))), k


def test_springs() -> None:
    assert_equal_accelerations(SPRINGS)
