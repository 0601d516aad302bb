#!/usr/bin/env python3
"""Write the project's own arms, grippers and furniture, and the catalogue of them.

    python tools/make_robots.py            # writes assets/robots
    python tools/make_robots.py --out DIR

Needs numpy only. The same input gives the same bytes. What is in the folder and no longer made is taken away.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from robots.collection.all_files import collection_files
from robots.write import ASSETS, write_folder

if __name__ == "__main__":
    write_folder(collection_files(), ASSETS / "robots", __doc__)
