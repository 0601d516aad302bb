#!/usr/bin/env python3
"""Write the project's own Franka-Panda-like arm: URDF, visual shells and collision hulls.

    python tools/make_panda.py            # writes assets/panda
    python tools/make_panda.py --out DIR

Needs numpy only. The same input gives the same bytes.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from robots.panda import PANDA
from robots.write import main

if __name__ == "__main__":
    main(PANDA, __doc__)
