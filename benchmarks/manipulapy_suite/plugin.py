"""A plugin of pytest with which ManipulaPy's tests meet our modules, and which writes down how they end."""

import json
import os
from importlib import import_module
from pathlib import Path
from typing import Any

import manyhands
from benchmarks.manipulapy_suite import OUTCOMES

_PRIVATE = {"ik_helpers": ("_clip_to_limits",), "path_planning": ("_traj_cpu_njit", "_trajectory_cpu_fallback")}
"""What test files import by the name of something private: without a stand-in all of their tests would be lost. It is
None, so tests that call it fail."""

_outcomes: dict[str, str] = {}

manyhands.install_as("ManipulaPy", "pybullet", "pybullet_data")
for _module, _names in _PRIVATE.items():
    for _name in _names:
        vars(import_module(f"manyhands.manipulapy.{_module}")).setdefault(_name, None)


def _note(test: str, outcome: str) -> None:
    """One word a test: setup, call, teardown and parts of it count together, and the worst says how it ended."""
    worse = ("passed", "skipped", "failed")
    _outcomes[test] = max(_outcomes.get(test, outcome), outcome, key=worse.index)


def pytest_runtest_logreport(report: Any) -> None:
    _note(report.nodeid.partition("::")[2], report.outcome)


def pytest_collectreport(report: Any) -> None:
    if report.outcome == "failed":
        _note("the file itself", "failed")


def pytest_sessionfinish() -> None:
    Path(os.environ[OUTCOMES]).write_text(json.dumps(_outcomes))
