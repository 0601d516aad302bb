"""The layer check finds what it is there to find, and nothing in this tree."""

import importlib.util
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
SPEC = importlib.util.spec_from_file_location("check_layers", ROOT / "tools/check_layers.py")
assert SPEC is not None and SPEC.loader is not None
check_layers = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(check_layers)

TABLE = """
| folder | holds | may use |
| --- | --- | --- |
| `manyhands/base` | asserts | the standard library |
| `manyhands/math` | numbers | `manyhands/base` |
| `manyhands/model` | models | `manyhands/math`, `<pugixml>` |
| `manyhands/learn` | trainers | `manyhands/math`, `manyhands/model/api.h` |
| `bindings` | glue | everything |

| folder | holds | may use |
| --- | --- | --- |
| `python/manyhands` | modules | `<matplotlib>` |
| `python/manyhands/envs` | environments | `python/manyhands/viewer` |
| `python/manyhands/viewer` | a page | `python/manyhands` |
| `python/manyhands/__init__.py` | names | everything |
"""


def complaints(root: Path, file: str, text: str, table: str = TABLE, **others: str) -> list[str]:
    """Of a tree with the table, a file, and others by their paths from python/, without slashes and ends."""
    more = {f"python/{name.replace('__', '/')}.py": content for name, content in others.items()}
    for name, content in {"docs/architecture.md": table, file: text, **more}.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content)
    return check_layers.check(root)


@pytest.mark.parametrize(
    ("file", "include"),
    [
        ("manyhands/base/a.h", "<vector>"),
        ("manyhands/base/a.h", '"manyhands/base/b.h"'),
        ("manyhands/math/a.h", '"manyhands/base/b.h"'),
        ("manyhands/model/deep/a.cpp", '"manyhands/base/b.h"'),  # through math
        ("manyhands/model/a.cpp", "<pugixml.hpp>"),
        ("manyhands/learn/a.cpp", '"manyhands/model/api.h"'),  # the one header
        ("bindings/a.cpp", "<nanobind/nanobind.h>"),
    ],
)
def test_allows(tmp_path: Path, file: str, include: str) -> None:
    assert complaints(tmp_path, file, f"#pragma once\n#include {include}\n") == []


@pytest.mark.parametrize(
    ("file", "include", "reason"),
    [
        ("manyhands/base/a.h", '"manyhands/math/b.h"', "may not use `manyhands/math`"),
        ("manyhands/math/a.cpp", '"manyhands/model/b.h"', "may not use `manyhands/model`"),
        ("manyhands/learn/a.cpp", '"manyhands/model/other.h"', "may not use `manyhands/model`"),
        ("manyhands/math/a.cpp", "<pugixml.hpp>", "not a library"),
        ("manyhands/learn/a.cpp", "<pugixml.hpp>", "not a library"),
        ("manyhands/math/a.cpp", '"b.h"', "written from the root"),
        ("manyhands/magic/a.cpp", "<vector>", "in no row"),
    ],
)
def test_forbids(tmp_path: Path, file: str, include: str, reason: str) -> None:
    (found,) = complaints(tmp_path, file, f"#pragma once\n#include {include}\n")
    assert found.startswith(f"{file}:")
    assert reason in found


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        ("no table here", "no layer table"),
        ("| `manyhands/base` | x | `manyhands/gone` |\n", "not rows"),
        ("| `manyhands/base` | x | `manyhands/math` |\n| `manyhands/math` | x | `manyhands/base` |\n", "on itself"),
    ],
)
def test_rejects_a_bad_table(tmp_path: Path, table: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        complaints(tmp_path, "manyhands/base/a.h", "", table)


VIEWER = {"manyhands__viewer__viewer": "", "manyhands__envs__one": "", "manyhands__plots": ""}


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("envs/a.py", "from manyhands.viewer import viewer"),
        ("envs/a.py", "import manyhands.plots"),  # through the viewer
        ("viewer/a.py", "import json, numpy as np\nfrom manyhands._core.envs import x"),
        ("a.py", "def f():\n    import matplotlib.pyplot"),
        ("__init__.py", "from manyhands.envs import one"),
    ],
)
def test_allows_imports(tmp_path: Path, file: str, text: str) -> None:
    assert complaints(tmp_path, f"python/manyhands/{file}", text, **VIEWER) == []


@pytest.mark.parametrize(
    ("file", "text", "reason"),
    [
        ("viewer/a.py", "from manyhands.envs import one", "may not use `python/manyhands/envs`"),
        ("viewer/a.py", "def f():\n    from manyhands.envs.one import x", "may not use `python/manyhands/envs`"),
        ("viewer/a.py", "if TYPE_CHECKING:\n    import manyhands.envs.one", "may not use `python/manyhands/envs`"),
        ("plots2.py", "from manyhands.viewer.viewer import Viewer", "may not use `python/manyhands/viewer`"),
        ("envs/a.py", "import matplotlib", "not a library"),
        ("envs/a.py", "from .one import x", "not a library"),
    ],
)
def test_forbids_imports(tmp_path: Path, file: str, text: str, reason: str) -> None:
    (found,) = complaints(tmp_path, f"python/manyhands/{file}", text, **VIEWER)
    assert found.startswith(f"python/manyhands/{file}:")
    assert reason in found


def test_forbids_imports_in_a_circle(tmp_path: Path) -> None:
    text = "def f():\n    from manyhands.viewer import c"
    others = {"manyhands__viewer__b": "import manyhands.viewer.a", "manyhands__viewer__c": "import manyhands.viewer.b"}
    (found,) = complaints(tmp_path, "python/manyhands/viewer/a.py", text, **others)
    assert "imports in a circle" in found
    assert all(f"viewer/{name}.py" in found for name in "abc")


def test_this_tree_keeps_its_layers() -> None:
    assert check_layers.check(ROOT) == []
