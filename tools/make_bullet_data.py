#!/usr/bin/env python3
"""Write the project's own models under the names of PyBullet's data folder.

    python tools/make_bullet_data.py            # writes assets/bullet
    python tools/make_bullet_data.py --out DIR

Needs numpy only. The same input gives the same bytes. What is in the folder and no longer made is taken away.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from robots.bullet_data.all_files import bullet_files
from robots.write import ASSETS


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ASSETS / "bullet", help="folder to write to")
    out: Path = parser.parse_args().out
    files = bullet_files()
    for path in [p for p in out.rglob("*") if p.is_file() and p.relative_to(out).as_posix() not in files]:
        path.unlink()
    for name, data in files.items():
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        (out / name).write_bytes(data)
    print(f"{out}: {len(files)} files, {sum(map(len, files.values())) / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
