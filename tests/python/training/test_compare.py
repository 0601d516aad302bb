"""Runs that differ in the seed alone are one curve with a band; what cannot be compared is told in one line."""

import json
import re
import shutil
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from manyhands import cli
from manyhands.training.comparison import Group, Run, interval, read_groups
from manyhands.training.comparison_picture import explanation, thousands
from manyhands.training.comparison_table import notes, table_row
from manyhands.training.recorder import read_rows
from manyhands.training.run_folder import RunFolder

PNG = b"\x89PNG\r\n"
SHORT = ("--num-envs", "16", "--max-steps", "4000", "--episodes", "20", "--set", "evaluation_episodes=20")


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three runs of Reach: two that differ in the seed, and one with another gamma."""
    parent = tmp_path_factory.mktemp("runs")
    for seed, gamma in ((0, 0.95), (1, 0.95), (0, 0.5)):
        arguments = ["--seed", str(seed), "--set", f"gamma={gamma}", "--runs", str(parent)]
        assert cli.main(["train", "PandaReach", *SHORT, *arguments]) == 0
    return parent


def made(success: list[list[float]], done: Sequence[bool] = (True, True)) -> Group:
    """Runs evaluated every 100 steps, ten a second; the first run at 100, 200, ..., the second at 110, 210, ..."""
    found = []
    for seed, (rates, is_done) in enumerate(zip(success, done, strict=True)):
        steps = 10.0 * seed + 100 * np.arange(1, len(rates) + 1)
        found.append(Run(Path(f"{seed}"), "X", seed, {}, steps, steps / 10, np.array(rates), is_done))
    return Group("made", found)


def test_curves_are_linear_between_evaluations_and_keep_what_was_reached() -> None:
    steps, curves = made([[0.0, 1.0], [0.5, 0.5, 0.8]]).curves("steps")
    at = {float(x): column.tolist() for x, column in zip(steps, curves.T, strict=True)}
    assert (steps[0], steps[-1]) == (110, 310), "from where all are known to the end of the longest"
    assert at[110] == pytest.approx([0.1, 0.5])
    assert at[310] == pytest.approx([1.0, 0.8])
    seconds, same = made([[0.0, 1.0], [0.5, 0.5, 0.8]]).curves("seconds")
    np.testing.assert_allclose(seconds, steps / 10)
    np.testing.assert_allclose(same, curves)


def test_where_none_is_done_all_stop_with_the_first() -> None:
    group = made([[0.0, 1.0], [0.5, 0.5, 0.8]], done=(False, False))
    assert group.curves("steps")[0][-1] == 200
    assert [(run.seed, x[-1]) for run, x, _ in group.single("steps")] == [(0, 200), (1, 310)], "alone each goes on"
    assert table_row(group, "range") == ("made", "0 of 2 done", "80.0%", "90.0%", "100.0%", "310", "31.0")


def test_a_run_that_is_done_is_not_hidden_by_one_that_was_stopped() -> None:
    group = made([[0.1], [0.5, 0.5, 0.8]], done=(False, True))
    steps, curves = group.curves("steps")
    assert (steps[-1], curves[:, -1].tolist()) == (310, [0.8])
    assert [(run.seed, x[-1]) for run, x, _ in group.single("steps")] == [(1, 310), (0, 100)]
    assert table_row(group, "range") == ("made", "1 of 2 done", "80.0%", "80.0%", "80.0%", "310", "31.0")
    assert "stopped do not count" in notes([group], "range") and "dashed if stopped" in explanation([group], "range")


def test_bands() -> None:
    rng = np.random.default_rng(0)
    values = rng.normal(0.5, 0.1, (40, 3))
    low, high = interval(values, "bootstrap")
    # Of many runs the bootstrap's interval is the normal one, 1.96 standard errors of the mean.
    error = values.std(axis=0) / np.sqrt(40)
    np.testing.assert_allclose(high - low, 2 * 1.96 * error, rtol=0.06)
    np.testing.assert_allclose((high + low) / 2, values.mean(axis=0), atol=0.2 * error.max())
    # Of two runs, means are either value or between them: (a, a) and (b, b) have a quarter each.
    low, high = interval(np.array([[0.2], [0.6]]), "bootstrap")
    assert (low[0], high[0]) == pytest.approx((0.2, 0.6))
    low, high = interval(values, "range")
    assert (low == values.min(axis=0)).all() and (high == values.max(axis=0)).all()


def test_runs_are_grouped_by_all_but_the_seed(runs: Path) -> None:
    groups, left_out = read_groups(sorted(runs.iterdir()))
    assert {group.label: sorted(run.seed for run in group.runs) for group in groups} == {
        "gamma=0.95": [0, 1], "gamma=0.5": [0]
    }  # fmt: skip
    assert left_out == []
    for run in (run for group in groups for run in group.runs):
        assert run.is_done and run.last == json.loads((run.path / "evaluation.json").read_text())["success_rate"]
        assert (np.diff(run.steps) > 0).all() and (np.diff(run.seconds) > 0).all()


def test_compare_draws_and_prints(
    runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    for band in ("bootstrap", "range"):
        name = tmp_path / band
        assert cli.main(["compare", str(runs), "--out", str(name), "--band", band]) == 0
        out = capsys.readouterr().out
        assert "PandaReach-v3: success at the end" in out and "gamma=0.5" in out and "worst" in out
        assert name.with_suffix(".png").read_bytes().startswith(PNG)
        page = name.with_suffix(".html").read_text()
        assert "gamma=0.95 (2 runs)" in page and "<td>gamma=0.5</td>" in page
        assert not re.search(r"<(script|link|img)[^>]*(src|href)=", page), "the page opens alone"


def test_the_page_asks_the_network_for_nothing(runs: Path, tmp_path: Path, browser: object) -> None:
    assert cli.main(["compare", str(runs), "--out", str(tmp_path / "page")]) == 0
    page = browser.new_page()  # pyright: ignore[reportAttributeAccessIssue]
    asked: list[str] = []
    errors: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto((tmp_path / "page.html").as_uri())
    page.wait_for_selector(".legendtext")
    assert page.locator(".legendtext").all_text_contents() == ["gamma=0.95 (2 runs)", "gamma=0.5 (1 run)"]
    page.close()
    assert len(asked) == 1 and errors == []


def damaged(runs: Path, tmp_path: Path, name: str, text: str | None) -> Path:
    """A copy of a run with one file changed or, with None, missing."""
    folder = Path(shutil.copytree(sorted(runs.iterdir())[0], tmp_path / "damaged"))
    (folder / name).unlink() if text is None else (folder / name).write_text(text)
    return folder


def test_a_run_without_an_evaluation(runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = damaged(runs, tmp_path, "metrics.csv", None)
    out = ["--out", str(tmp_path / "out")]
    for named in (folder, tmp_path):
        assert cli.main(["compare", str(named), *out]) == 2
        assert f"no run in {named} has an evaluation yet" in capsys.readouterr().err
        assert cli.main(["compare", *map(str, runs.iterdir()), str(named), *out]) == 0
        assert f"Left out, without an evaluation yet: {folder}" in capsys.readouterr().out


def test_another_limit_is_no_other_setting(runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    copy = shutil.copytree(runs, tmp_path / "runs")
    changed = RunFolder(sorted(copy.iterdir())[0])
    changed.write_config(changed.read_settings(max_env_steps=100))
    groups, _ = read_groups([copy])
    assert {group.label: len(group.runs) for group in groups} == {"gamma=0.95": 2, "gamma=0.5": 1}


def test_a_copy_of_a_run_is_no_seed(runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first = read_groups([runs])[0][0].runs[0].path
    whole, part = (shutil.copytree(first, tmp_path / name) for name in ("whole", "part"))
    (part / "evaluation.json").unlink()
    evaluated = next(number for number, row in enumerate(read_rows(RunFolder(first)), start=2) if row.evaluations)
    rows = (part / "metrics.csv").read_text().splitlines(keepends=True)
    (part / "metrics.csv").write_text("".join(rows[:evaluated]))
    groups, lines = read_groups([part, runs, whole])
    assert sorted(len(group.runs) for group in groups) == [1, 2]
    assert lines == [f"Counted once, the same run of seed 0 as {first}: {copy}" for copy in (whole, part)]
    (other,) = (run for run in runs.iterdir() if RunFolder(run).read_settings().seed == 1)
    assert read_groups([first, other])[1] == [], "another seed is another run"
    assert cli.main(["compare", str(runs), str(part), "--out", str(tmp_path / "out")]) == 0
    assert f"the same run of seed 0 as {first}: {part}" in capsys.readouterr().out


def test_names_of_pictures_may_be_those_of_files(runs: Path, tmp_path: Path) -> None:
    for name, wanted in (("a.png", "a"), ("b.html", "b"), ("c.d", "c.d")):
        assert cli.main(["compare", str(runs), "--out", str(tmp_path / name)]) == 0
        assert {path.name for path in tmp_path.iterdir()} == {f"{wanted}.png", f"{wanted}.html"}
        for path in tmp_path.iterdir():
            path.unlink()


def test_labels_are_whole_where_there_is_no_terminal(
    runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    long = damaged(runs, tmp_path, "log.txt", "")
    config = json.loads((long / "config.json").read_text())
    config["trainer"] |= {"hidden_layers": [128, 128, 128, 128], "algorithm": "SAC", "batch_size": 4096}
    (long / "config.json").write_text(json.dumps(config))
    assert cli.main(["compare", str(runs), str(long), "--out", str(tmp_path / "out")]) == 0
    (line,) = (line for line in capsys.readouterr().out.splitlines() if "algorithm=SAC" in line)
    assert "batch_size=4096" in line and "hidden_layers=[128, 128, 128, 128]" in line


def test_small_numbers_on_an_axis_are_no_thousandths() -> None:
    texts = [thousands(value, 0) for value in (0, 0.25, 0.5, 1, 2.5, 400, 25_000, 1_500_000)]
    assert texts == ["0", "0.25", "0.5", "1", "2.5", "400", "25k", "1.5M"]


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("metrics.csv", "steps\n1", "metrics.csv:1: expected the header"),
        ("evaluation.json", "{", "evaluation.json:1: expected JSON"),
        ("evaluation.json", "[]", "evaluation.json: expected float under 'success_rate', found None"),
        ("evaluation.json", '{"success_rate": "all"}', "expected float under 'success_rate', found 'all'"),
        ("config.json", "{}", "config.json: expected the settings of a run under 'settings'"),
        ("config.json", '{"settings": {"env_id": "PandaReach-v3"}}', "expected dict under 'trainer', found None"),
    ],
)
def test_damaged_files_are_named(
    name: str, text: str, message: str, runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["compare", str(damaged(runs, tmp_path, name, text)), "--out", str(tmp_path / "out")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert message in line


def test_what_cannot_be_compared(runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def refusal(*arguments: str | Path) -> str:
        assert cli.main(["compare", *map(str, arguments)]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        return line

    assert f"there is no folder {tmp_path / 'nowhere'}" in refusal(tmp_path / "nowhere")
    assert f"{tmp_path} is no run folder and holds none" in refusal(tmp_path)
    other = damaged(runs, tmp_path, "log.txt", "")
    config = json.loads((other / "config.json").read_text())
    config["settings"]["env_id"] = "PandaPush-v3"
    (other / "config.json").write_text(json.dumps(config))
    text = refusal(runs, other)
    assert "runs of one environment can be compared" in text and "PandaReach-v3" in text and "PandaPush-v3" in text
    assert "there is no folder" in refusal(runs, "--out", tmp_path / "no" / "name")
    assert "/proc/name.png cannot be written" in refusal(runs, "--out", "/proc/name")
