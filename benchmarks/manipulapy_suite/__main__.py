"""Runs ManipulaPy's own tests on `manyhands.install_as("ManipulaPy")`: `python -m benchmarks.manipulapy_suite`.

The package index has the tests; they are fetched into build/ once, and only tests and no module of ManipulaPy are
unpacked. Each file is a process of its own. `differences` says which tests fail and why; the command ends with 1 if
anything else fails, and if one of these passes.
"""

import argparse
import hashlib
import json
import os
import subprocess
import sys
import tarfile
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from fnmatch import fnmatchcase
from pathlib import Path
from typing import NamedTuple

from benchmarks.manipulapy_suite import OUTCOMES
from benchmarks.manipulapy_suite.differences import DIFFERENCES, LEFT_OUT, Difference

ROOT = Path(__file__).parents[2]
VERSION = "1.4.1"
SHA256 = "ca295a4da0a482c285757bf784f64b7b57c9a3a0f92c33d595cef05d8c8f566e"
PATIENCE = 600.0  # for one file [s]


class Verdict(NamedTuple):
    """How a file ended: how many tests passed, were skipped, fail for a known reason, and what nobody expected."""

    passed: int
    skipped: int
    known: int
    surprises: list[str]


def fetch(folder: Path) -> Path:
    """The folder that holds ManipulaPy's `tests`, fetched and unpacked if need be. Raises ValueError if the archive is
    not the one that the list of differences is about."""
    home = folder / f"manipulapy-{VERSION}"
    if (home / "pytest.ini").is_file():
        return home
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--no-binary", ":all:"]
    subprocess.run([*command, "--dest", str(folder), f"ManipulaPy=={VERSION}"], check=True)
    archive = folder / f"manipulapy-{VERSION}.tar.gz"
    found = hashlib.sha256(archive.read_bytes()).hexdigest()
    if found != SHA256:
        raise ValueError(f"{archive} has the SHA-256 {found}; expected {SHA256}")
    with tarfile.open(archive) as tar:
        inside = f"{home.name}/tests/"
        wanted = [member for member in tar if member.isfile() and member.name.startswith(inside)]
        tar.extractall(folder, wanted, filter="data")
    (home / "pytest.ini").write_text("[pytest]\n")  # this repository's own settings lie above
    return home


def run(home: Path, file: str) -> dict[str, str]:
    """{test: "passed", "skipped" or "failed"} of one file; what it says goes to a log beside it."""
    outcomes = home / f"{file}.json"
    outcomes.unlink(missing_ok=True)
    environment = {
        **os.environ,
        OUTCOMES: str(outcomes),
        "MPLBACKEND": "Agg",
        "PYTHONPATH": os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")])),
    }
    command = [sys.executable, "-m", "pytest", "-q", "--tb=short", "-p", "no:cacheprovider"]
    command += ["-p", "benchmarks.manipulapy_suite.plugin", f"tests/{file}"]
    with (home / f"{file}.log").open("w") as log:
        try:
            subprocess.run(command, cwd=home, env=environment, stdout=log, stderr=log, timeout=PATIENCE, check=False)
        except subprocess.TimeoutExpired:
            return {f"the file itself, after {PATIENCE:g} s": "failed"}
    return json.loads(outcomes.read_text()) if outcomes.is_file() else {"the file itself": "failed"}


def judge(file: str, outcomes: Mapping[str, str], differences: Sequence[Difference]) -> Verdict:
    """What a file's outcomes are beside the differences that are known."""
    failed = [test for test, outcome in outcomes.items() if outcome == "failed"]
    known: set[str] = set()
    surprises: list[str] = []
    for one in differences:
        if one.file != file:
            continue
        found = {test for test in failed if fnmatchcase(test, one.tests)}
        known |= found
        if one.failures is not None and len(found) != one.failures:
            surprises.append(f"{file}::{one.tests}: {len(found)} fail, {one.failures} are known")
    surprises += [f"{file}::{test} fails" for test in failed if test not in known]
    counts = [list(outcomes.values()).count(outcome) for outcome in ("passed", "skipped")]
    return Verdict(counts[0], counts[1], len(known), surprises)


def main() -> int:
    """Prints a table; returns 0 where all is as `differences` says."""
    parser = argparse.ArgumentParser(
        "python -m benchmarks.manipulapy_suite",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("files", nargs="*", help="test_control.py, for example; all by default")
    parser.add_argument("--jobs", type=int, default=1, help="files at a time")
    options = parser.parse_args()
    folder = ROOT / "build" / "manipulapy"
    folder.mkdir(parents=True, exist_ok=True)
    home = fetch(folder)
    there = sorted(path.name for path in (home / "tests").glob("test_*.py") if path.name not in LEFT_OUT)
    files = options.files or there
    if unknown := set(files) - set(there):
        parser.error(f"there is no {', '.join(sorted(unknown))}; there are {', '.join(there)}")
    surprises: list[str] = []
    print("| file | pass | skipped | fail, and why is known | else |\n| --- | --- | --- | --- | --- |")
    with ThreadPoolExecutor(options.jobs) as pool:
        for file, outcomes in zip(files, pool.map(lambda file: run(home, file), files), strict=True):
            found = judge(file, outcomes, DIFFERENCES)
            surprises += found.surprises
            counts = found.passed, found.skipped, found.known, len(found.surprises)
            print(f"| `{file}` | {' | '.join(map(str, counts))} |", flush=True)
    for line in surprises:
        print(line)
    if surprises:
        print(f"logs are in {home}")
    return 1 if surprises else 0


if __name__ == "__main__":
    sys.exit(main())
