"""manyhands.install_as: other packages' names stand for our modules."""

from pathlib import Path

import pytest
from programs import output, run

import manyhands as mh

pytest.importorskip("pybullet")


def test_names_stand_for_our_modules(tmp_path: Path) -> None:
    output(
        tmp_path,
        """
        import sys
        import manyhands
        manyhands.install_as("pybullet", "pybullet_data", "pybullet_utils", "panda_gym", "gym")
        manyhands.install_as()  # all, once more
        assert not {"pybullet", "gym", "panda_gym"} & set(sys.modules), "nothing is imported before it is asked for"

        import gym, gym.spaces, panda_gym.envs.core, pybullet, pybullet_data, pybullet_utils.bullet_client
        from gym.envs.registration import register
        from gym.spaces.box import Box
        from panda_gym.pybullet import PyBullet
        from pybullet_utils import bullet_client as bc
        import gymnasium.spaces
        import manyhands.gym.envs.registration, manyhands.panda_gym, manyhands.pybullet_utils.bullet_client

        assert pybullet is sys.modules["manyhands.pybullet"] is bc._pybullet
        assert gym is manyhands.gym and register is manyhands.gym.envs.registration.register
        assert gym.spaces is gymnasium.spaces and Box is gymnasium.spaces.Box
        assert bc is manyhands.pybullet_utils.bullet_client
        assert panda_gym.envs.core is manyhands.panda_gym.envs.core
        assert PyBullet is manyhands.panda_gym.pybullet.PyBullet
        assert panda_gym.__spec__.name == "manyhands.panda_gym", "our modules keep what they are"
        manyhands.install_as("gym")
        """,
    )


def test_other_names_are_left_alone(tmp_path: Path) -> None:
    output(
        tmp_path,
        """
        import manyhands
        manyhands.install_as("gym")
        import gym, pybullet, panda_gym
        assert "site-packages" in panda_gym.__file__ and "manyhands" not in panda_gym.__file__
        assert "manyhands" not in pybullet.__file__
        """,
    )


def test_a_name_that_is_taken(tmp_path: Path) -> None:
    done = run(tmp_path, program='import manyhands, pybullet_data\nmanyhands.install_as("gym", "pybullet_data")\n')
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert "ImportError: 'pybullet_data' has been imported already, from " in last
    assert "before the first import" in last


def test_an_unknown_name() -> None:
    with pytest.raises(
        ValueError, match=r"'numpy' is no name .* pybullet, pybullet_data, pybullet_utils, panda_gym, gym"
    ):
        mh.install_as("gym", "numpy")


def test_what_is_not_ours_is_taken_from_the_installed_package(tmp_path: Path) -> None:
    output(
        tmp_path,
        """
        import manyhands
        manyhands.install_as("pybullet", "pybullet_utils")
        import pybullet_utils.urdfEditor, pybullet
        assert "manyhands" not in pybullet_utils.urdfEditor.__file__
        assert pybullet_utils.urdfEditor.p is pybullet
        try:
            import pybullet_utils.no_such
        except ModuleNotFoundError as reason:
            assert reason.name == "pybullet_utils.no_such"
        else:
            raise AssertionError
        """,
    )


def test_the_folder_of_models(tmp_path: Path) -> None:
    ours = tmp_path / "assets" / "bullet"
    ours.mkdir(parents=True)
    program = f"""
        import sys
        import manyhands
        manyhands.install_as("pybullet_data")
        import pybullet_data
        from pathlib import Path
        folder = Path(pybullet_data.getDataPath())
        assert folder.name == "pybullet_data" and (folder / "plane.urdf").is_file()

        sys.path[:] = [entry for entry in sys.path if not (Path(entry) / "pybullet_data").is_dir()]
        manyhands.set_asset_root({str(tmp_path / "assets")!r})
        assert Path(pybullet_data.getDataPath()) == Path({str(ours)!r})
    """
    output(tmp_path, program)
