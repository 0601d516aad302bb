"""What the physics computes is the same with every C library: none of those functions whose last bit is up to it."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CALL = re.compile(r"\bstd::(a?(?:sin|cos|tan)h?|atan2|exp2?|expm1|log(?:2|10|1p)?|pow|hypot|cbrt)f?\(|\blong double\b")


def calls(folder: str) -> set[str]:
    """Files and functions, as `file: function`."""
    found = set[str]()
    for path in sorted((ROOT / "manyhands" / folder).rglob("*")):
        if path.suffix in {".h", ".cpp", ".inl"}:
            found |= {f"{path.name}: {call[0]}" for call in CALL.finditer(path.read_text())}
    return found


def test_physics_has_functions_of_its_own():
    assert calls("physics") == set()


def test_mathematics_calls_the_library_for_tables_of_numpy_alone():
    """As NumPy itself does, whose bits those are."""
    assert calls("math") == {f"numpy_random.cpp: std::{name}(" for name in ("exp", "log", "log1p")}
