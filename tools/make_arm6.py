#!/usr/bin/env python3
"""Write the project's own six-axis arm of the UR5e's class, with a parallel gripper: URDF and visual shells.

    python tools/make_arm6.py            # writes assets/arm6
    python tools/make_arm6.py --out DIR

Needs numpy only. The same input gives the same bytes.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from robots.arm6 import ARM6
from robots.write import main

if __name__ == "__main__":
    main(ARM6, __doc__)
