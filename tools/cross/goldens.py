"""Prints what tools/cross/goldens.sh found as a table, and fails where platforms differ from the tests' own numbers.

python tools/cross/goldens.py BUILD/PLATFORM...; beside each lies PLATFORM.txt, what the tests printed.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent.parent
LINE = re.compile(r'\{"(.+?)", 0x([0-9a-f]+)(?:, 0x([0-9a-f]+))?\}')
LANES = "lanes of 4, 8, 16"


def hashes(text: str) -> dict[str, str]:
    """Hashes in a table of the tests, by what was hashed."""
    found: dict[str, str] = {}
    for name, first, second in LINE.findall(text):
        found |= {f"{name}, double": first, f"{name}, float": second} if second else {name: first}
    return found


def main(platforms: list[str]) -> int:
    """One row for each hash, one column for each platform."""
    wanted = hashes((ROOT / "tests/physics/golden/test_golden.cpp").read_text())
    columns = {Path(p).name: Path(p).with_name(Path(p).name + ".txt").read_text() for p in platforms}
    print("| | in the tests |", " | ".join(columns), "|")
    print("| --- " * (2 + len(columns)) + "|")
    same = True
    for name, number in wanted.items():
        cells = [hashes(text).get(name, "none") for text in columns.values()]
        print(f"| {name} | {number} |", " | ".join("=" if cell == number else cell for cell in cells), "|")
        same &= all(cell == number for cell in cells)
    in_lanes = ["lanes equal" in text for text in columns.values()]
    print(f"| {LANES} | |", " | ".join("=" if equal else "**differ**" for equal in in_lanes), "|")
    return int(not (same and all(in_lanes)))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
