"""Batch from Python: arrays whose rows are worlds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import manyhands as mh


def cube_model() -> mh.Model:
    world = mh.World()
    world.add_plane("floor")
    world.add_box("cube", [0.02, 0.02, 0.02], 0.1, [0, 0, 0.05])
    return world.model


def test_a_batch_follows_a_world() -> None:
    model = cube_model()
    batch, world = mh.Batch(model, 5), mh.World(model)
    batch.step(300)
    world.step(300)
    position, quaternion = batch.body_pose("cube")
    assert position.shape == (5, 3) and quaternion.shape == (5, 4) and position.dtype == np.float32
    np.testing.assert_allclose(position, np.tile(world.body_pose("cube")[0], (5, 1)), atol=1e-5)
    np.testing.assert_allclose(batch.contact_force("cube")[:, 5], 0.1 * 9.81, rtol=1e-3)
    normal, friction = batch.contact_wrench("cube")
    np.testing.assert_allclose(normal + friction, batch.contact_force("cube"))
    assert np.all(batch.contact_count == 4)
    np.testing.assert_allclose(batch.time, 0.6)
    assert not batch.flags.any()


def test_worlds_differ_and_do_not_depend_on_lanes() -> None:
    model = cube_model()
    hashes = set()
    native = mh.Batch(model, 7).lanes  # the C++ tests have the other widths
    for lanes, threads in ((1, 1), (native, 1), (native, 2)):
        batch = mh.Batch(model, 7, num_threads=threads, lanes=lanes)
        assert batch.lanes == lanes
        batch.set_mass("cube", np.linspace(0.1, 0.7, 7))
        batch.set_friction("cube", 0.3)
        batch.set_gravity([[0.2 * i, 0, -9.81] for i in range(7)])
        batch.v = np.outer(np.arange(7), [0, 0, 1, 0.1, 0, 0])
        batch.apply_force("cube", [0, 0, 1])
        batch.step(120)
        hashes.add(batch.state_hash())
    assert len(hashes) == 1
    assert len(np.unique(batch.q[:, 0])) == 7


def test_a_width_that_is_not_built_is_refused_with_those_that_are() -> None:
    model = cube_model()
    native = mh.Batch(model, 2).lanes
    for lanes in {4, 5, 8, 16, -1} - {native}:
        with pytest.raises(ValueError, match=rf"lanes is {lanes}; this build has 0 \(automatic\), 1, {native}$"):
            mh.Batch(model, 2, lanes=lanes)


def test_masks_choose_worlds() -> None:
    batch = mh.Batch(cube_model(), 4)
    start = batch.snapshot()
    batch.step(50)
    moved = batch.q
    mask = np.array([True, False, True, False])
    batch.reset(mask)
    np.testing.assert_array_equal(batch.q[~mask], moved[~mask])
    np.testing.assert_array_equal(batch.time, [0, 0.1, 0, 0.1])
    batch.restore(start)
    assert np.all(batch.time == 0)
    batch.set_v(np.ones(6), mask)
    np.testing.assert_array_equal(batch.v, np.where(mask[:, None], 1, 0) * np.ones(6))


def test_nan_stays_in_its_world() -> None:
    batch, calm = mh.Batch(cube_model(), 18), mh.Batch(cube_model(), 18)
    force = np.zeros((18, 3), np.float32)
    force[4, 0] = 3e38
    batch.apply_force("cube", force)
    batch.step(60)
    calm.step(60)
    np.testing.assert_array_equal(batch.flags, (np.arange(18) == 4).astype(np.uint8))
    others = np.arange(18) != 4
    np.testing.assert_array_equal(batch.q[others], calm.q[others])
    assert np.all(np.isfinite(batch.q)) and np.all(np.isfinite(batch.v))


def test_errors_name_what_was_wrong() -> None:
    batch = mh.Batch(cube_model(), 3)
    with pytest.raises(ValueError, match="broadcast"):
        batch.q = np.zeros((2, 7))
    with pytest.raises(ValueError, match="quaternion"):
        batch.q = np.zeros((3, 7))
    with pytest.raises(ValueError, match="not finite"):
        batch.v = np.full((3, 6), np.nan)
    with pytest.raises(ValueError, match="mass"):
        batch.set_mass("cube", [0.1, 0.0, 0.1])
    with pytest.raises(KeyError, match="cube"):
        batch.body_pose("nobody")
    with pytest.raises(ValueError, match="number of worlds"):
        mh.Batch(cube_model(), 0)


@settings(deadline=None, max_examples=40)
@given(force=st.lists(st.floats(width=32), min_size=3, max_size=3), mass=st.floats(width=32))
def test_anything_is_refused_or_flagged(force: list[float], mass: float) -> None:
    batch = mh.Batch(cube_model(), 3)
    try:
        batch.set_mass("cube", [0.1, mass, 0.1])
        batch.apply_force("cube", [[0, 0, 0], force, [0, 0, 0]])
    except ValueError:
        return
    batch.step(30)
    assert batch.flags[0] == 0 and batch.flags[2] == 0
    assert np.all(np.isfinite(batch.q)) and np.all(np.isfinite(batch.v))
    np.testing.assert_array_equal(batch.q[0], batch.q[2])
