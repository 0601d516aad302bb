"""The layer check finds what it is there to find."""

import importlib.util
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
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
"""


def complaints(root: Path, file: str, text: str, table: str = TABLE) -> list[str]:
    for name, content in (("docs/architecture.md", table), (file, text)):
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
