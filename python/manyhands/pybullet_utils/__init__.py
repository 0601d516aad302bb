"""What programs use of pybullet_utils.

Modules that are not here are looked for in the package of that name, if it is installed; they get our pybullet.
"""

import sys
from pathlib import Path

__path__ += [
    str(folder)
    for folder in (Path(entry).resolve() / "pybullet_utils" for entry in sys.path)
    if (folder / "bullet_client.py").is_file() and folder != Path(__file__).parent
]
