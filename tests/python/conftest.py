"""What several tests share: they import modules of `shared/`, look at one policy that was learned, and open pages."""

import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

os.environ["BROWSER"] = "true"  # human mode opens none in tests
sys.path.insert(0, str(Path(__file__).parent / "shared"))


@pytest.fixture(scope="session")
def reach_policy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a training run that learned PandaReach, in about two seconds."""
    from manyhands import cli

    runs = tmp_path_factory.mktemp("runs")
    assert cli.main(["train", "PandaReach", "--seed", "0", "--episodes", "10", "--runs", str(runs)]) == 0
    (path,) = runs.iterdir()
    return path


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Headless, with WebGL in software."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed: make test installs it")
    from browsed import FLAGS

    with playwright.sync_playwright() as driver:
        names = ("chromium", "chromium-browser", "google-chrome")
        found = next((path for name in names if (path := shutil.which(name))), None)
        own = Path(driver.chromium.executable_path)
        if found is None and not own.exists():
            text = "there is no Chromium: tools/setup.sh browser installs one"
            pytest.fail(text) if os.environ.get("CI") else pytest.skip(text)
        running = driver.chromium.launch(executable_path=found or str(own), args=FLAGS)
        yield running
        running.close()


@pytest.fixture(scope="module")
def page(browser: Any) -> Any:
    """The only page: each one that is open draws all the time, by the processor alone."""
    from browsed import SIZE

    page = browser.new_page(viewport=SIZE)
    page.set_default_timeout(60000)
    return page
