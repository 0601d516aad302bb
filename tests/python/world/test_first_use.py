"""What a first-time user stumbled over: wrong arguments that were taken in silence, or refused without a reason."""

import os
from pathlib import Path

import gymnasium
import pytest

import manyhands as mh


def test_options_that_reset_does_not_know_are_refused() -> None:
    env = gymnasium.make("PandaReach-v3")
    with pytest.raises(ValueError, match="there are no options"):
        env.reset(options={"goal": [0, 0, 0]})
    env.reset(options={})


def test_restitution_above_one_is_refused() -> None:
    world = mh.World()
    with pytest.raises(ValueError, match=r"restitution is 2.*expected at most 1"):
        world.add_sphere("ball", 0.1, restitution=2)
    world.add_sphere("ball", 0.1, restitution=1)


def test_rows_that_do_not_fit_say_what_would() -> None:
    batch = mh.Batch(mh.load_urdf(mh.asset_path("panda/panda.urdf"))[0], 4)
    with pytest.raises(ValueError, match=r"shape \(3,\) cannot be broadcast to \(4,\)"):
        batch.set_mass("panda_hand", [1, 2, 3])


def test_a_mesh_that_is_not_there_is_a_file_that_is_not_found() -> None:
    with pytest.raises(FileNotFoundError, match=r"nope\.obj"):
        mh.World().add_mesh("m", "nope.obj")


def test_what_is_no_file_is_told_to_be_none(tmp_path: Path) -> None:
    """A pipe that nobody writes into would block for ever."""
    os.mkfifo(tmp_path / "pipe.urdf")
    for path in (tmp_path, tmp_path / "pipe.urdf"):
        with pytest.raises(ValueError, match="expected a URDF, MJCF or SDF file"):
            mh.World.from_file(path)


def test_worlds_and_models_count_the_same_links() -> None:
    model, _ = mh.load_urdf(mh.asset_path("panda/panda.urdf"))
    count = f"{len(model.links)} links"
    assert count in repr(model) and count in repr(mh.World(model))


def test_the_package_lists_what_is_for_users() -> None:
    assert {"World", "load_urdf", "view"} <= set(dir(mh))
    assert not {"Path", "TYPE_CHECKING", "import_module"} & set(dir(mh))
