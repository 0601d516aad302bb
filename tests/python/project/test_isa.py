"""Which build of the extension is chosen, and what is said where none fits."""

import os
import subprocess
import sys

import pytest

import manyhands as mh
from manyhands import isa

WHEEL = ("x86-64-v3", "x86-64-v4")


@pytest.mark.parametrize(
    ("built", "processor", "wanted", "chosen"),
    [
        (WHEEL, ("x86-64-v4", "x86-64-v3"), "", "x86-64-v4"),
        (WHEEL, ("x86-64-v3",), "", "x86-64-v3"),
        (WHEEL, ("x86-64-v4", "x86-64-v3"), "x86-64-v3", "x86-64-v3"),
        (("native",), ("x86-64-v3",), "", "native"),
        (("native",), (), "", "native"),
        (("native", "x86-64-v3"), ("x86-64-v3",), "x86-64-v3", "x86-64-v3"),
    ],
)
def test_the_best_that_the_processor_has_is_chosen(
    built: tuple[str, ...], processor: tuple[str, ...], wanted: str, chosen: str
) -> None:
    assert isa.choose(built, processor, wanted) == chosen


@pytest.mark.parametrize(
    ("built", "processor", "wanted", "message"),
    [
        (WHEEL, (), "", "built for processors with x86-64-v3 or x86-64-v4, this one has neither AVX2 nor FMA"),
        (WHEEL, ("x86-64-v3",), "x86-64-v4", "MANYHANDS_ISA is x86-64-v4, but this processor has x86-64-v3"),
        (WHEEL, ("x86-64-v3",), "avx", "MANYHANDS_ISA is 'avx', but this installation has x86-64-v3, x86-64-v4"),
        (("native",), ("x86-64-v3",), "x86-64-v3", "this installation has native"),
    ],
)
def test_what_does_not_fit_is_said_in_a_line(
    built: tuple[str, ...], processor: tuple[str, ...], wanted: str, message: str
) -> None:
    with pytest.raises(ImportError, match=message) as refused:
        isa.choose(built, processor, wanted)
    assert "\n" not in str(refused.value)


def test_the_command_refuses_in_a_line() -> None:
    told = subprocess.run(
        [sys.executable, "-c", "import sys, manyhands_command as m; sys.exit(m.main())", "envs"],
        env={**os.environ, "MANYHANDS_ISA": "none"}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert told.returncode == 2
    assert told.stderr.startswith("manyhands: MANYHANDS_ISA is 'none'")
    assert told.stderr.count("\n") == 1


def test_build_info_tells_what_runs() -> None:
    info = mh.build_info()
    assert info.isa in info.isas
    assert info.lanes in (4, 8, 16)
    assert info.version == mh.__version__
    assert mh.Batch(mh.World().model, 2).lanes == info.lanes
