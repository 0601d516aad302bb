#!/usr/bin/env python3
"""Write the project's own models under the names of PyBullet's data folder.

    python tools/make_bullet_data.py            # writes assets/bullet
    python tools/make_bullet_data.py --out DIR

Needs numpy only. The same input gives the same bytes. What is in the folder and no longer made is taken away.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from robots.bullet_data.all_files import bullet_files
from robots.write import ASSETS, write_folder

if __name__ == "__main__":
    write_folder(bullet_files(), ASSETS / "bullet", __doc__)
