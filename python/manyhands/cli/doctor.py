"""The command `manyhands doctor`: what is installed, what it runs on, and whether it works."""

import argparse
import os
import platform
import re
import sys
import time
from collections.abc import Callable, Iterator
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path

import numpy as np

from manyhands._core import Batch, Model, World, asset_path, load_urdf
from manyhands._core.envs import make_env_batch
from manyhands._core.render import Camera, Renderer
from manyhands.extras import install_extra
from manyhands.isa import build_info
from manyhands.policies import policy

EXAMPLES = """\
examples:
  manyhands doctor            all that it can tell, and a check of a few seconds
  manyhands doctor --quick    without the check

It exits with 1 where the check fails. The variable MANYHANDS_ISA chooses another build of the kernels, and
MANYHANDS_THREADS how many threads there are.
"""
_EXTRAS = ("train", "viewer", "plots", "video", "convex", "online", "demos", "ray")
_CUBE = 0.02  # half of its side [m]
_SECONDS = 2.0  # that the speed is measured


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What comes after `manyhands doctor`."""
    parser.add_argument("--quick", action="store_true", help="leave out the check")


def run(arguments: argparse.Namespace) -> int:
    """Prints what there is, and checks it."""
    for name, text in _facts():
        print(f"{name:<12} {text}")
    print()
    for line in _extras():
        print(line)
    return 0 if arguments.quick else _check()


def _facts() -> Iterator[tuple[str, str]]:
    info = build_info()
    yield "manyhands", f"{info.version} in {Path(__file__).parents[1]}"
    yield "Python", f"{platform.python_version()}, {sys.executable}"
    yield "with", f"numpy {version('numpy')}, gymnasium {version('gymnasium')}"
    yield "system", f"{platform.platform()}"
    yield "processor", f"{_processor()}: {', '.join(info.processor) or 'too old for these kernels'}"
    chosen = " (by MANYHANDS_ISA)" if os.environ.get("MANYHANDS_ISA") else ""
    yield "kernels", f"{info.isa}{chosen} of {', '.join(info.isas)}; {info.lanes} worlds in a register; {info.compiler}"
    threads = Batch(World().model, 1024).num_threads
    yield "threads", f"{threads} by default, of {os.cpu_count()} processors"


def _processor() -> str:
    try:
        text = Path("/proc/cpuinfo").read_text()
    except OSError:
        return platform.processor() or platform.machine()
    found = re.search(r"^model name\s*:\s*(.*)$", text, re.MULTILINE)
    return found.group(1) if found else platform.machine()


def _extras() -> Iterator[str]:
    """What each extra of the package brings: what is there of it, and how to get the rest."""
    given = [each.partition(";") for each in requires("manyhands") or []]
    for extra in _EXTRAS:
        names = [
            match.group()
            for requirement, _, marker in given
            if re.search(rf"extra == ['\"]{extra}['\"]", marker)
            and (match := re.match(r"[A-Za-z0-9_.-]+", requirement))
            and match.group() != "manyhands"
        ]
        versions = {name: _version(name) for name in names}
        there = [f"{name} {found}" for name, found in versions.items() if found]
        missing = [name for name, found in versions.items() if not found]
        yield f"{f'[{extra}]':<12} {', '.join(there) or 'nothing'}"
        if missing:
            yield f"{'':<12} without {', '.join(missing)}: {install_extra(extra)}"


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


def _check() -> int:
    checks: dict[str, Callable[[], str]] = {
        "equal bits": _equal_bits,
        "contact": _contact,
        "pictures": _pictures,
        "policies": _policies,
        "speed": _speed,
    }
    print()
    return int(sum(not _passes(name, check) for name, check in checks.items()) > 0)


def _passes(name: str, check: Callable[[], str]) -> bool:
    try:
        print(f"{name:<12} ok: {check()}", flush=True)
    except Exception as error:  # whatever it is, the next check may tell more
        print(f"{name:<12} FAILED: {type(error).__name__}: {error}", flush=True)
        return False
    return True


def _panda() -> Model:
    return load_urdf(asset_path("panda/panda.urdf"))[0]


def _equal_bits() -> str:
    model, worlds = _panda(), 32
    batches = [Batch(model, worlds, lanes=lanes) for lanes in (0, 1)]
    for batch in batches:
        batch.step(200)
    if not np.array_equal(batches[0].q, batches[1].q):
        raise ArithmeticError(f"worlds in {batches[0].lanes} lanes and alone differ")
    return f"{worlds} falling arms in {batches[0].lanes} lanes are what each is alone, to the last bit"


def _contact() -> str:
    world = World()
    world.add_plane("floor")
    world.add_box("cube", [_CUBE] * 3, mass=0.1, position=[0, 0, 2 * _CUBE])
    world.step(1000)
    height = float(world.body_pose("cube")[0][2])
    force = sum(contact.normal_force for contact in world.contacts())
    if abs(height - _CUBE) > 1e-4 or abs(force - 0.981) > 1e-3:
        raise ArithmeticError(f"a cube of 0.1 kg rests at {height:.5f} m, and presses with {force:.4f} N")
    return f"a cube of 0.1 kg rests on the floor, and presses with {force:.3f} N"


def _pictures() -> str:
    camera = Camera.perspective(84, 84, 0.8).look_at([1.5, 1.5, 1], [0, 0, 0.4])
    model = _panda()
    renderer = Renderer(model)
    colours = len(np.unique(renderer.render(model.initial_configuration(), camera).colour.reshape(-1, 3), axis=0))
    if colours < 100:
        raise ArithmeticError(f"a picture of the arm has {colours} colours")
    begin, pictures = time.perf_counter(), 0
    while time.perf_counter() - begin < _SECONDS / 2:
        renderer.render(model.initial_configuration(), camera)
        pictures += 1
    return f"{pictures / (time.perf_counter() - begin):,.0f} of 84 x 84 pixels a second, one by one"


def _policies() -> str:
    result = policy("PandaReach").evaluate(episodes=200)
    if result.success_rate < 0.98:
        raise ArithmeticError(f"the policy of PandaReach succeeds in {result.success_rate:.1%} of its episodes")
    return f"that of PandaReach succeeds in {result.success_rate:.1%} of {result.episodes} episodes"


def _speed() -> str:
    worlds = 1024
    envs = make_env_batch("PandaPush-v3", worlds)
    envs.reset()
    action = np.random.default_rng(0).uniform(-1, 1, (worlds, envs.spec.action_dim)).astype(np.float32)
    begin, steps = time.perf_counter(), 0
    while time.perf_counter() - begin < _SECONDS:
        envs.step(action)
        steps += worlds
    return f"{steps / (time.perf_counter() - begin):,.0f} steps a second of {worlds} worlds of PandaPush"
