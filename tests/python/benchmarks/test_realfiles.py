"""`make realfiles`: its own logic, on files written here; nothing is fetched."""

import json
import sys
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).parents[3]))

pytest.importorskip("mujoco")

from benchmarks import children
from benchmarks.realfiles import __main__ as command
from benchmarks.realfiles import baseline, causes, loading, motion, results, summary, wheels
from benchmarks.realfiles.examine import Task, examine_here
from benchmarks.realfiles.files import File, files_in, matching, sample
from benchmarks.realfiles.wording import alike

PENDULUM = """
<mujoco><worldbody><body name="arm"><joint name="hinge" damping="0.2" frictionloss="0.01"/>
  <geom size="0.1 0.3" type="capsule" pos="0.3 0 0"/></body></worldbody>
  <actuator><motor joint="hinge" ctrlrange="-1 1"/></actuator></mujoco>"""
BOX = """
<mujoco><worldbody><geom type="plane" size="1 1 1"/>
  <body name="box" pos="0 0 0.1"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body></worldbody></mujoco>"""


def examined(folder: Path, text: str, seconds: float = 0.0) -> results.Result:
    path = folder / "scene.xml"
    path.write_text(text)
    task = Task(File("own/scene.xml", "own", path), seconds, budget=60.0, limit=300.0)
    said: list[Any] = []
    examine_here(said.append, task)
    return results.result_of(children.Ended(task, said, 0), "key")


def test_equal_scenes_pass_in_every_column(tmp_path: Path) -> None:
    result = examined(tmp_path, PENDULUM, seconds=0.5)
    words = results.verdicts(result)
    assert words | {"rests": "-"} == dict.fromkeys(results.COLUMNS, "pass") | {"rests": "-"}
    assert result["accelerations"]["states"] >= 20
    assert [run["start"] for run in result["motion"]] == ["file", "random controls"]
    assert all(run["cost"] > 0 and run["their_cost"] > 0 for run in result["motion"])


def test_the_stiffest_dampers_are_compared(tmp_path: Path) -> None:
    """A rate of 1e5/s: the differences of velocities need steps of a nanosecond."""
    stiff = PENDULUM.replace('damping="0.2" frictionloss="0.01"', 'damping="0.1"').replace("0.1 0.3", "0.01 0.01")
    assert results.verdicts(examined(tmp_path, stiff.replace('pos="0.3 0 0"', "")))["accelerations"] == "pass"


def test_friction_short_of_its_bound_is_not_compared(tmp_path: Path) -> None:
    """A light slide under much friction: MuJoCo lets it yield, and says of it that it does not."""
    rubs = """<mujoco><worldbody><body><joint name="x" type="slide" axis="1 0 0" frictionloss="250"/>
      <joint name="y" pos="-0.2 0 0" frictionloss="250"/>
      <inertial pos="0 0 0" mass="6" diaginertia="0.01 0.01 0.006"/></body></worldbody>
      <actuator><velocity joint="x" kv="1000" forcerange="-600 600"/><velocity joint="y" kv="1000"/></actuator>
      </mujoco>"""
    assert results.verdicts(examined(tmp_path, rubs))["accelerations"] == "pass"


def test_a_box_rests(tmp_path: Path) -> None:
    assert results.verdicts(examined(tmp_path, BOX, seconds=1.0))["rests"] == "pass"


def test_what_falls_off_its_tip_or_rolls_does_not_rest(tmp_path: Path) -> None:
    """It has hardly moved after the little while that is looked at, in either program."""
    tip = """<mujoco><option gravity="1e-3 0 -9.81"/><worldbody><body><joint axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0 0 0.6" size="0.045"/></body></worldbody></mujoco>"""
    rolling = BOX.replace('type="box" size="0.1 0.1 0.1"', 'type="sphere" size="0.1"')
    rolling = rolling.replace("</worldbody>", "</worldbody><keyframe><key qvel='0.002 0 0 0 0.02 0'/></keyframe>")
    for text in (tip, rolling):
        result = examined(tmp_path, text, seconds=1.0)
        assert [run["rests"] for run in result["motion"]][-1] is False


def test_refused_files_fail_only_where_mujoco_takes_them(tmp_path: Path) -> None:
    (tmp_path / "inner").mkdir()
    (tmp_path / "part.xml").write_text("<mujocoinclude><geom size='0.1'/></mujocoinclude>")
    outside = '<mujoco><worldbody><body><freejoint/><include file="../part.xml"/></body></worldbody></mujoco>'
    result = examined(tmp_path / "inner", outside)
    if result["load"]["refused"]:  # the rest is compared all the same
        assert "loads" in results.reasons(result)
    assert results.verdicts(result)["statics"] == "pass"
    fragment = examined(tmp_path, "<mujocoinclude/>")
    assert not results.accepted(fragment)
    assert set(results.verdicts(fragment).values()) == {"-"}


def other_model(text: str, change: tuple[str, str], folder: Path, monkeypatch: pytest.MonkeyPatch) -> results.Result:
    """As if we had loaded `text` changed."""
    other = folder / "other.xml"
    other.write_text(text.replace(*change))
    ours = loading.load_ours(other)
    monkeypatch.setattr("benchmarks.realfiles.examine.load_ours", lambda path: ours)
    return examined(folder, text, seconds=1.0)


@pytest.mark.parametrize(
    ("change", "column", "word"),
    [
        (('pos="0.3 0 0"', 'pos="0.3001 0 0"'), "statics", "centre of mass"),
        (('damping="0.2"', 'damping="0.21"'), "accelerations", "hinge"),
        (('frictionloss="0.01"', 'frictionloss="0.02"'), "accelerations", "hinge"),
        (('name="hinge"', 'name="hinge" range="-9 9"'), "statics", "limits"),
    ],
)
def test_differences_are_found(
    change: tuple[str, str], column: str, word: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert word in results.reasons(other_model(PENDULUM, change, tmp_path, monkeypatch))[column]


def test_what_slides_away_does_not_rest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result = other_model(BOX, ("<worldbody>", '<option gravity="1 0 -0.5"/><worldbody>'), tmp_path, monkeypatch)
    assert "box moves" in results.reasons(result)["rests"]


def run_of(**fields: Any) -> dict[str, Any]:
    return motion.Run("file", 1.0, cost=2e-5, their_cost=1e-5, contacts=12.0, **fields).words()


def result_of(name: str, **fields: Any) -> results.Result:
    plain = {"mujoco": "", "load": {"refused": ""}, "serious": [], "features": [], "overlap": 0.0, "ended": ""}
    known = {"statics": {"dofs": ""}, "motion": [run_of()], "stage": "motion", "key": "key"}
    return {"file": name, "collection": name.split("/")[0], **plain, **known, **fields}


def test_crashes_and_hangs_fail_in_their_column() -> None:
    for stage, column in (("load", "loads"), ("statics", "statics"), ("motion", "stable")):
        result = result_of("a/x", stage=stage, ended=results.ending(-11))
        assert results.reasons(result) == {column: "crashes with status -11"}
    assert results.ending(None) == "hangs"
    assert not results.reasons(result_of("a/x", stage="MuJoCo", mujoco="crashed", ended="crashes with status -11"))


def test_explosions_count_unless_mujoco_is_unstable_too() -> None:
    silent = result_of("a/x", motion=[run_of(exploded="1e9 rad/s beside MuJoCo's 1")], features=["equality weld"])
    assert results.verdicts(silent)["stable"] == "fail"
    assert causes.by_cause([silent])["stable"] == {"runs away; equality weld; nothing touches": ["a/x"]}
    both = result_of("a/x", motion=[run_of(exploded="SimulationError: x", unstable=True)])
    assert results.verdicts(both)["stable"] == "-"


def test_what_falls_elsewhere_is_not_restless() -> None:
    fallen = {"moved": 2.0, "they_moved": 2.0, "drifted": 0.5, "they_drifted": 0.0}
    assert results.verdicts(result_of("a/x", motion=[run_of(**fallen, apart=0.5)]))["rests"] == "-"
    assert results.verdicts(result_of("a/x", motion=[run_of(**fallen, apart=0.001)]))["rests"] == "fail"


def test_serious_notes_excuse_motion_but_not_statics() -> None:
    rates = {"states": 5, "away": 1.0, "where": "state 1, j", "error": ""}
    fields = {"statics": {"masses": "a: mass 1e-3"}, "accelerations": rates, "motion": [run_of(moved=1.0)]}
    assert set(results.reasons(result_of("a/x", **fields))) == {"statics", "accelerations", "rests"}
    assert set(results.reasons(result_of("a/x", **fields, serious=["springs"]))) == {"statics"}


def test_lines_are_read_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "results.jsonl"
    for name in ("a/x", "a/y"):
        results.append(path, result_of(name))
    with path.open("a") as stream:
        stream.write(json.dumps(result_of("a/z"))[:40])
    assert list(results.read(path, "key")) == ["a/x", "a/y"]
    assert not results.read(path, "another engine's")


def test_samples_are_spread_and_always_the_same() -> None:
    files = [File(f"{c}/{k:03}", c, Path()) for c, n in (("large", 90), ("small", 9), ("one", 1)) for k in range(n)]
    chosen = sample(files, 20)
    assert len({file.name for file in chosen}) == 20
    assert chosen == sample(list(reversed(files)), 20)
    counts = [sum(file.collection == name for file in chosen) for name in ("large", "small", "one")]
    assert counts[2] == 1
    assert 16 <= counts[0] <= 17
    assert sample(files, 1000) == files


def test_files_are_found_by_parts_and_patterns(tmp_path: Path) -> None:
    for name in ("a/door.xml", "a/b/lock.xml", "a/mesh.stl"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    files = files_in(tmp_path, "own")
    assert [file.name for file in files] == ["own/a/b/lock.xml", "own/a/door.xml"]
    assert [file.name for file in matching(files, ["door", "own/*/lock.xml"])] == [file.name for file in files]
    assert [file.name for file in matching(files, ["door"])] == ["own/a/door.xml"]


def test_alike_messages_count_together() -> None:
    one = alike("MjcfError: /a/b.xml:12: <include> of '/x/y.xml' lies outside '/x', expected 3")
    two = alike("MjcfError: /c/d.xml:7: <include> of '/z.xml' lies outside '/q/r', expected 14")
    assert one == two
    assert "include" in one


def test_baseline_holds_until_another_file_fails(tmp_path: Path) -> None:
    path = tmp_path / "baseline.json"
    failing = result_of("a/x", load={"refused": "MjcfError: x"})
    baseline.write([failing, result_of("a/y")], baseline.read(path), path)
    known = baseline.read(path)
    assert known["loads"] == ["a/x"]
    assert not baseline.beside([failing, result_of("a/y")], known).worse
    assert baseline.beside([result_of("a/y", load={"refused": "no"})], known).worse == {"loads": ["a/y"]}
    assert baseline.beside([result_of("a/x")], known).better == {"loads": ["a/x"]}
    baseline.write([result_of("a/y")], known, path)  # of a/x, which was not run, what was known stays
    assert baseline.read(path)["loads"] == ["a/x"]


def test_figures_count_by_collection_and_contacts() -> None:
    found = summary.figures([result_of("a/x"), result_of("b/y", statics={"masses": "m: mass 1"}), result_of("b/z")])
    assert found["collections"]["b"]["statics"] == [1, 2]
    assert found["collections"]["all"]["loads"] == [3, 3]
    assert found["cost"]["11 to 40"]["median"] == pytest.approx(2.0)
    assert found["causes"]["statics"] == {"masses": ["b/y"]}


def test_a_run_is_resumed_and_judged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("pendulum", "box"):
        (tmp_path / "own-1" / f"{name}.xml").parent.mkdir(exist_ok=True)
        (tmp_path / "own-1" / f"{name}.xml").write_text(PENDULUM if name == "pendulum" else BOX)
    monkeypatch.setattr(command, "WHEELS", (wheels.Wheel("own", "1", (("own", "."),)),))
    monkeypatch.setattr(baseline, "PATH", tmp_path / "baseline.json")
    monkeypatch.setattr(baseline.read, "__defaults__", (tmp_path / "baseline.json",))
    output = tmp_path / "realfiles.json"
    arguments = ["--folder", str(tmp_path), "--output", str(output), "--seconds", "0", "--jobs", "1"]
    assert command.main([*arguments, "--only", "box"]) == 0
    kept = output.with_suffix(".jsonl").read_text()
    assert command.main(arguments) == 0
    assert output.with_suffix(".jsonl").read_text().startswith(kept)
    assert json.loads(output.read_text())["collections"]["own"]["loads"] == [2, 2]
