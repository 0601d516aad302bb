"""docs/pybullet_coverage.md, whole: every function of the real module is in it, or there is a reason."""

from benchmarks.bullet.beside import real
from benchmarks.bullet.calls import TABLE, rows_of
from benchmarks.bullet.differences import DIFFERENCES, NOT_COMPARED

ENOUGH = 200


def test_every_function_is_in_the_table_or_has_a_reason() -> None:
    functions = {name for name, value in vars(real).items() if callable(value) and not name.startswith("_")}
    compared = set(rows_of(TABLE.read_text(encoding="utf-8")))
    assert compared | set(NOT_COMPARED) >= functions
    assert not compared & set(NOT_COMPARED)
    assert set(DIFFERENCES) <= compared


def test_the_table_is_long_enough() -> None:
    table = rows_of(TABLE.read_text(encoding="utf-8"))
    assert len(table) + sum(len(options) for options in table.values()) >= ENOUGH
