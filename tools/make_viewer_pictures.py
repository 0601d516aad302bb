#!/usr/bin/env python3
"""Take the pictures of docs/viewer.md: the page in a headless browser, and plots of a run.

tools/setup.sh browser && python tools/make_viewer_pictures.py [--out docs/images]
"""

from __future__ import annotations

import argparse
import re
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import sync_playwright

from manyhands.envs import ArmVectorEnv, Expert
from manyhands.panda_gym import registration
from manyhands.plots import plot
from manyhands.recording import Recorder
from manyhands.viewer import Viewer

ROOT = Path(__file__).resolve().parent.parent
SIZE = {"width": 1280, "height": 800}
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def environment(name: str, seed: int) -> Any:
    env = registration.make_env(**registration.VARIANTS[name])
    env.reset(seed=seed)
    return env


def grasped(viewer: Viewer, steps: int) -> None:
    """Lets the expert act for some steps."""
    source: Any = viewer.source
    viewer.actor("scripted expert", Expert("PandaPickAndPlace-v3"))

    def act() -> None:
        source.reset(seed=36)
        for _ in range(steps):
            source.step()

    viewer.player.do(act, wait=30.0)


def drive(viewer: Viewer, page: Any) -> None:
    grasped(viewer, 12)


def robot(viewer: Viewer, page: Any) -> None:
    """The hand with its gizmo, contact forces and a trail."""
    page.get_by_role("tab", name="Robot").click()
    viewer.trail("panda/panda_grasptarget")
    viewer.overlays.shows_points = viewer.overlays.shows_forces = viewer.player.wants_contacts = True
    grasped(viewer, 0)
    viewer.play()
    time.sleep(1.0)
    viewer.pause()
    page.get_by_label("Drag the hand").click()
    page.mouse.move(300, 60)  # away: what the control says of itself is no part of the picture


def worlds(viewer: Viewer, page: Any) -> None:
    """Nine of a batch, under the expert."""
    source: Any = viewer.source
    expert = Expert("PandaPickAndPlace-v3")
    viewer.speed = float("inf")
    observation, _ = source.env.reset(seed=5)
    for _ in range(300):
        observation, *_ = source.env.step(expert(observation))
        viewer.sync()
    page.get_by_label("Side by side").click(force=True)
    page.get_by_role("option", name="9", exact=True).click(force=True)


def take(name: str, shown: Any, prepare: Callable[[Viewer, Any], None], browser: Any, out: Path) -> None:
    with Viewer(shown, port=18700, title="PandaPickAndPlace-v3") as viewer:
        page = browser.new_page(viewport=SIZE)
        page.set_default_timeout(120000)
        page.goto(viewer.url)
        page.get_by_role("button", name=re.compile("^(Play|Pause)$")).wait_for()
        # What browsers say of WebGL in software is no part of the page.
        page.add_style_tag(content=".mantine-Notifications-root { display: none }")
        prepare(viewer, page)
        time.sleep(12.0)
        page.screenshot(path=out / f"{name}.png", timeout=120000)
        page.close()
        print(out / f"{name}.png")


def run(out: Path) -> None:
    """Plots of a cube that is picked up and placed."""
    env = environment("PandaPickAndPlace", 36)
    expert, recorder = Expert("PandaPickAndPlace-v3"), Recorder(env.sim.world)
    observation = env.observe()
    for _ in range(45):
        observation, reward, *_ = env.step(np.asarray(expert(observation)))
        recorder.add(float(reward))
    print(plot(recorder.recording(), out / "run.png"))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "docs/images")
    out = parser.parse_args().out
    run(out)
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        for name, prepare in (("viewer_drive", drive), ("viewer_robot", robot)):
            take(name, environment("PandaPickAndPlace", 36), prepare, browser, out)
        take("viewer_worlds", ArmVectorEnv(64, "PandaPickAndPlace"), worlds, browser, out)
        browser.close()


if __name__ == "__main__":
    main()
