"""`make accuracy`: its closed forms, its file, its verdicts; and a fast part of the cases with their bounds."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[3]
sys.path.insert(0, str(ROOT))

pytest.importorskip("mujoco")
pytest.importorskip("pybullet")

import manyhands as mh  # noqa: E402
from benchmarks.accuracy import __main__ as command  # noqa: E402
from benchmarks.accuracy import loops, measures, motor, rolling, rows, spin, stacking, table, verdicts  # noqa: E402
from benchmarks.accuracy.case import BULLET, LANES, MUJOCO, OURS, Best, Case, Figure, Measurement, Settings  # noqa: E402
from benchmarks.accuracy.cases import CASES  # noqa: E402
from benchmarks.accuracy.document import BEGIN, END, write_document  # noqa: E402
from benchmarks.accuracy.engines import build  # noqa: E402
from benchmarks.accuracy.runner import Task, measure, run_all  # noqa: E402
from benchmarks.accuracy.scene import Body, Geom, Scene, ground  # noqa: E402

HAVE_OURS = hasattr(mh, "load_mjcf_string")
NEEDS_OURS = pytest.mark.skipif(not HAVE_OURS, reason="the installed manyhands loads no MJCF")

# Cases of a second or two, and those of their figures that must hold. Slow ones are for `make accuracy`.
FAST = (
    "rolling",
    "free fall",
    "pinch",
    "incline",
    "painleve",
    "jam",
    "pendulum",
    "double pendulum",
    "motor",
    "impulse",
)


@NEEDS_OURS
@pytest.mark.parametrize("name", FAST)
def test_bounds(name: str) -> None:
    case = CASES[name]
    (settings, *_) = case.quick(OURS)
    kind, result = measure(name, replace(settings, budget=60.0))
    assert kind == "done", result
    for figure in result.figures:
        if figure.bound is not None:
            assert figure.value is not None and figure.value <= figure.bound, f"{figure.metric}: {figure.value}"


def test_elliptic_period_of_small_and_wide_swings() -> None:
    assert loops.elliptic_period(2.0, 1e-6) == pytest.approx(np.pi, rel=1e-12)
    # 1 + a^2 / 16 + 11 a^4 / 3072 + ...
    assert loops.elliptic_period(2 * np.pi, 0.1) == pytest.approx(1 + 0.01 / 16 + 11e-4 / 3072, rel=1e-9)


def test_flip_period_by_eulers_equations() -> None:
    a, b, c = spin.MOMENTS

    def rate(w: np.ndarray) -> np.ndarray:
        return np.array([(b - c) / a * w[1] * w[2], (c - a) / b * w[2] * w[0], (a - b) / c * w[0] * w[1]])

    w, h, crossings, t = np.array(spin.OMEGA), 1e-3, [], 0.0
    while len(crossings) < 2:
        k1 = rate(w)
        k2 = rate(w + h / 2 * k1)
        k3 = rate(w + h / 2 * k2)
        k4 = rate(w + h * k3)
        new = w + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        if w[1] < 0 <= new[1]:
            crossings.append(t + h * w[1] / (w[1] - new[1]))
        w, t = new, t + h
    assert spin.flip_period() == pytest.approx(crossings[1] - crossings[0], rel=1e-6)


def test_rolling_balances_momentum() -> None:
    box, ball = rolling.accelerations()
    pushed = rolling.FORCE - rolling.GROUND_FRICTION * (rolling.BOX + rolling.BALLS * rolling.BALL) * 9.81
    assert rolling.BOX * box + rolling.BALLS * rolling.BALL * ball == pytest.approx(pushed)


def test_stone_weighs_what_its_corners_hold() -> None:
    stone = stacking.arch_scene().moving()[0]
    points = np.array(stone.geoms[0].vertices)
    random = np.random.default_rng(0).uniform(points.min(0), points.max(0), (400_000, 3))
    half = np.pi / stacking.STONES / 2
    middle = np.hypot(stone.pos[0], stone.pos[2])
    x, y = random[:, 0] + middle, random[:, 1]
    inner, outer = stacking.INNER * np.cos(half), stacking.OUTER * np.cos(half)
    inside = random[(x > inner) & (x < outer) & (np.abs(y) < x * np.tan(half))]
    volume = np.ptp(points, 0).prod() * len(inside) / len(random)
    assert stone.mass == pytest.approx(stacking.DENSITY * volume, rel=0.01)
    assert inside.mean(0) == pytest.approx([0, 0, 0], abs=3e-4)
    squares = (inside**2).mean(0)
    assert stone.moments == pytest.approx(stone.mass * (squares.sum() - squares), rel=0.02)


@pytest.mark.parametrize("engine", [MUJOCO, BULLET, pytest.param(OURS, marks=NEEDS_OURS)])
def test_engines_describe_a_resting_box_alike(engine: str) -> None:
    scene = Scene((ground(0.5), Body("box", (Geom("box", (0.1, 0.2, 0.05), 0.5),), 3.0, (0.3, 0, 0.05))))
    sim = build(scene, Settings(engine, 0.002))
    sim.set_force("box", (4.0, 0, 0))
    sim.step(500)
    contacts = sim.contacts()
    assert {frozenset((c.body_a, c.body_b)) for c in contacts} == {frozenset(("ground", "box"))}
    sign = [1 if c.body_b == "box" else -1 for c in contacts]
    total = sum(s * (c.normal_force * c.normal + c.friction_force) for s, c in zip(sign, contacts, strict=True))
    assert total == pytest.approx([-4, 0, 3 * 9.81], abs=0.02)
    assert sim.position("box")[0] == pytest.approx(0.3, abs=1e-3)


@pytest.mark.parametrize("engine", [MUJOCO, BULLET, pytest.param(OURS, marks=NEEDS_OURS)])
def test_engines_start_and_measure_alike(engine: str) -> None:
    moving = Body("top", (Geom("box", (0.1, 0.2, 0.05)),), 3.0, (0, 0, 5), velocity=(1, 2, 3), omega=(0.3, -0.2, 0.5))
    scene = Scene((moving,), contacts=False)
    sim = build(scene, Settings(engine, 0.001))
    mass = measures.Mass(scene)
    moments = np.array(moving.moments)
    energy = 0.5 * 3 * 14 + 0.5 * float(moments @ np.array([0.09, 0.04, 0.25])) + 3 * 9.81 * 5
    assert mass.energy(sim) == pytest.approx(energy, rel=1e-12)
    assert mass.momentum(sim) == pytest.approx([3, 6, 9])
    sim.step(100)
    assert mass.momentum(sim) == pytest.approx([3, 6, 9 - 3 * 9.81 * 0.1])
    assert sim.time == pytest.approx(0.1)


@NEEDS_OURS
def test_motors_of_every_joint_reach_their_targets() -> None:
    _, turns, sim = motor.path(Settings(OURS, 0.002), motor.STRONG)
    assert np.isfinite(turns).all()
    assert sim.steps == 500


def row(engine: str, error: float | None, rtf: float = 10.0, **more: object) -> rows.Row:
    """One of a case called "test"."""
    bound = more.pop("bound", 1.0)
    verdict = "pass" if error is not None and bound is not None and error <= bound else "fail"  # type: ignore[operator]
    fields = {"time_step": 0.002, "variant": "", "note": "", "metric": "error", "bound_rtf": None} | more
    return rows.Row(
        case="test", engine=engine, number_type="double", integrator="", iterations=None, error=error, unit="m",
        rtf=rtf, bound=bound, verdict=verdict, **fields,  # type: ignore[arg-type]
    )  # fmt: skip


def case(judge: str = "steps", published: tuple[Best, ...] = ()) -> Case:
    """Runs nothing."""
    return Case("test", "", lambda _: Measurement([], 1.0), lambda _: [], published=published, judge=judge)


def test_both_steps_must_hold() -> None:
    good = [row(OURS, 0.5), row(OURS, 0.7, time_step=0.004)]
    assert verdicts.of(case(), good, OURS, "error").word == "pass"
    bad = [row(OURS, 0.5), row(OURS, 1.7, time_step=0.004)]
    verdict = verdicts.of(case(), bad, OURS, "error")
    assert (verdict.word, verdict.figure) == ("fail", bad[1])
    stopped = [row(OURS, 0.5), row(OURS, None, metric="", note="stopped at 3 s", time_step=0.004)]
    assert verdicts.of(case(), stopped, OURS, "error").word == "fail"


def test_best_variant_counts() -> None:
    two = [row(MUJOCO, 3.0, variant="a"), row(MUJOCO, 0.1, variant="b")]
    assert verdicts.of(case(), two, MUJOCO, "error").word == "pass"


def test_curve_needs_one_point_that_is_fast_enough() -> None:
    points = [row(OURS, 1e-9, 1.0, bound_rtf=5.0), row(OURS, 0.5, 9.0, bound_rtf=5.0)]
    points[0].verdict = "fail"
    verdict = verdicts.of(case("curve"), points, OURS, "error")
    assert (verdict.word, verdict.figure) == ("pass", points[1])
    assert verdicts.of(case("curve"), points[:1], OURS, "error").word == "fail"
    assert verdicts.beyond(case("curve"), points, OURS, Best("somebody", 1.0, 8.0)) == points[1]
    assert verdicts.beyond(case("curve"), points, OURS, Best("somebody", 1.0, None)) == points[0]


def test_without_a_bound_the_least_error_wins() -> None:
    both = [row(OURS, 2.0, bound=None), row(BULLET, 3.0, bound=None)]
    assert verdicts.of(case("curve"), both, OURS, "error").word == "pass"
    assert verdicts.of(case("curve"), [both[0], row(MUJOCO, 1.0, bound=None)], OURS, "error").word == "fail"


def test_nothing_finite_is_a_failure() -> None:
    figure = Figure("error", measures.finite(float("nan")), "m", 1.0)
    (made,) = rows.rows_of(CASES["pinch"], Settings(MUJOCO, 0.002), Measurement([figure], 5.0))
    assert (made.error, made.verdict) == (None, "fail")
    assert json.dumps(made.error) == "null"


def test_run_writes_rows_and_keeps_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    output = tmp_path / "out" / "accuracy.json"
    arguments = ["--quick", "--case", "pinch", "--engine", MUJOCO, "--output", str(output), "--jobs", "1"]
    assert command.main(arguments) == 0
    assert "1 runs, 0 kept" in capsys.readouterr().out
    written = json.loads(output.read_text())
    assert {"cpu", "date"} <= written.keys()
    (creep, _) = written["rows"]
    assert creep["metric"] == "creep"
    assert creep["error"] == pytest.approx(177.8, rel=0.01)  # what the issue that the case is made after reports
    assert creep["verdict"] == "fail"
    assert (output.parent / "accuracy" / "pinch.png").stat().st_size > 10_000
    assert command.main(arguments) == 0
    assert "0 runs, 1 kept" in capsys.readouterr().out
    assert command.main([*arguments, "--fresh"]) == 0
    assert "1 runs, 0 kept" in capsys.readouterr().out


def test_what_ends_badly_is_a_row() -> None:
    made: list[rows.Row] = []
    impossible = Task("impulse", Settings(MUJOCO, 0.002))
    failing = Task("pinch", Settings(MUJOCO, 0.002, options={"cone": "square"}))
    short = Task("tower", Settings(MUJOCO, 0.002, budget=0.0))
    run_all([impossible, failing, short], 2, lambda _, new: made.extend(new), lambda _: None)
    notes = {row.case: (row.note, row.verdict) for row in made}
    assert notes["impulse"] == ("cannot: MuJoCo has no coefficient of restitution", "")
    assert notes["pinch"][0].startswith("failed: ")
    assert notes["tower"][0].startswith("stopped at ")
    assert notes["tower"][1] == "fail"


def test_tables_go_between_the_markers(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n")
    about = {"cpu": "a cpu", "cores": 2, "compiler": "c++", "date": "2026-11-21T00:00:00"}
    made = case("curve", (Best("somebody", 1.0, 2.0),))
    for _ in range(2):
        write_document(page, [made], [row(OURS, 0.5), row(LANES, 0.6)], about)
    text = page.read_text()
    assert text.startswith("before\n") and text.endswith("after\n")
    assert "old" not in text
    assert text.count("| test |") == 2
    assert f"0.5 ✓ ({table.setting(row(OURS, 0.5))}; 10x)" in text
    with pytest.raises(ValueError, match="must hold one line"):
        write_document(ROOT / "README.md", [], [], about)
