"""Files appear whole or not at all, whoever else writes and whatever lies there."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import manyhands as mh
from manyhands import cli
from manyhands.files import replacing, write_text


def test_writers_of_one_file_do_not_meet(tmp_path: Path) -> None:
    path = tmp_path / "shared.txt"
    texts = [f"{k}" * 10_000 for k in range(8)]
    with ThreadPoolExecutor(8) as threads:
        list(threads.map(lambda k: write_text(path, texts[k % 8]), range(400)))
    assert path.read_text() in texts
    assert [file.name for file in tmp_path.iterdir()] == ["shared.txt"]


def test_savers_of_one_model_do_not_meet(tmp_path: Path) -> None:
    (tmp_path / "given.urdf").write_text('<robot name="r"><link name="a"/></robot>')
    model, _ = mh.load_urdf(tmp_path / "given.urdf")
    path = tmp_path / "robot.urdf"
    with ThreadPoolExecutor(8) as threads:
        list(threads.map(lambda _: mh.save_urdf(model, path), range(200)))
    assert mh.load_urdf(path)[0].links[-1].name == "a"
    assert sorted(file.name for file in tmp_path.iterdir()) == ["given.urdf", "robot.urdf"]


def test_a_link_in_the_way_leads_nowhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("manyhands.files.secrets.token_hex", lambda _: "known")
    (tmp_path / "kept").write_text("mine")
    (tmp_path / ".new.known.txt").symlink_to(tmp_path / "kept")
    with pytest.raises(FileExistsError), replacing(tmp_path / "new.txt"):
        pass
    assert (tmp_path / "kept").read_text() == "mine"


def test_what_a_killed_run_had_begun_to_write_is_cleared(tmp_path: Path) -> None:
    command = ["train", "PandaReach", "--num-envs", "16", "--episodes", "10", "--set", "stop_streak=0"]
    assert cli.main([*command, "--max-steps", "800", "--runs", str(tmp_path)]) == 0
    (run,) = tmp_path.iterdir()
    drafts = [run / "checkpoint.bin.part123", run / ".metrics.0123abcd.csv", run / ".policy.77.onnx"]
    for draft in drafts:
        draft.write_text("half")
    assert cli.main(["train", "--resume", str(run), "--max-steps", "1600"]) == 0
    assert not [draft for draft in drafts if draft.exists()]
