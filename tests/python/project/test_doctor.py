"""`manyhands doctor` tells what there is, and finds this installation in order."""

import pytest

from manyhands import cli
from manyhands.cli import doctor


def test_an_installation_is_in_order(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "_SECONDS", 0.1)
    assert cli.main(["doctor"]) == 0
    told = capsys.readouterr().out
    for name in ("manyhands ", "processor ", "kernels ", "threads ", "[train] ", "[viewer] ", "equal bits ", "speed "):
        assert f"\n{name}" in f"\n{told}"
    assert "FAILED" not in told


def test_what_fails_is_said_and_the_rest_is_checked(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails() -> str:
        raise ArithmeticError("bits differ")

    monkeypatch.setattr(doctor, "_SECONDS", 0.1)
    monkeypatch.setattr(doctor, "_equal_bits", fails)
    assert cli.main(["doctor"]) == 1
    told = capsys.readouterr().out
    assert "equal bits   FAILED: ArithmeticError: bits differ" in told
    assert "contact      ok" in told
