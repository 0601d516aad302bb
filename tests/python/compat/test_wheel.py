"""packages/manyhands-pybullet: a wheel that gives the names of PyBullet."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from programs import output

PACKAGE = Path(__file__).parents[3] / "packages" / "manyhands-pybullet"


def test_the_wheel_gives_our_modules(tmp_path: Path) -> None:
    pytest.importorskip("scikit_build_core")
    source, site = tmp_path / "source", tmp_path / "site"
    shutil.copytree(PACKAGE, source)
    install = ["install", "--quiet", "--no-index", "--no-build-isolation", "--no-deps", "--target", str(site)]
    outside = {key: value for key, value in os.environ.items() if key != "PIP_REQUIRE_VIRTUALENV"}
    subprocess.run([sys.executable, "-m", "pip", *install, str(source)], check=True, env=outside, timeout=300)
    text = output(
        tmp_path,
        """
        import pybullet as p, pybullet_data, pybullet_utils.bullet_client as bc
        client = bc.BulletClient(p.DIRECT)
        print(p.__name__, pybullet_data.__name__, bc.__name__, client.isConnected(), "plane" in str(pybullet_data))
        from pathlib import Path
        assert Path(pybullet_data.getDataPath()).parent != Path("site").resolve(), "no models there"
        """,
        paths=(site,),
    )
    assert text.endswith("manyhands.pybullet manyhands.pybullet_data manyhands.pybullet_utils.bullet_client 1 False\n")
