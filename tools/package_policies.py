#!/usr/bin/env python3
"""Trains policies by the shipped recipes and packs the best seed of each: python/manyhands/policies/ID.onnx, its card
ID.yaml, and the table of docs/policies.md.

python tools/package_policies.py [ENV ...] [--seeds N] [--jobs N] [--runs DIR]
python tools/package_policies.py ENV --trained DIR    packs what `manyhands sweep` or `train` has left in a folder

Without ENV all that have a recipe are made. Runs that are done are kept: the same command goes on where it was stopped.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from pathlib import Path

import onnx

from manyhands._core.learn import read_policy
from manyhands.cli import main as manyhands
from manyhands.env_names import resolve_env_id
from manyhands.policies.card import Card, read_card
from manyhands.policies.policy import Policy
from manyhands.training.policy_file import save_model, to_onnx
from manyhands.training.recipe import Recipe, find_recipe, recipe_ids
from manyhands.training.recorder import read_rows
from manyhands.training.run_folder import RunFolder

ROOT = Path(__file__).resolve().parent.parent
POLICIES = ROOT / "python/manyhands/policies"
PAGE = ROOT / "docs/policies.md"
TABLE = "| environment | success | weights | trained in | steps | uses | seed |"
EPISODES, FIRST_SEED = 1000, 2 * 10**9  # those of `manyhands evaluate`, which gives the same figure
MOST_LOST = 0.005  # of success by weights of 16 bits: a standard error of success is 0.4 to 0.9 points


def train(env_id: str, runs: Path, seeds: int, jobs: int) -> Path:
    """The folder with the runs of an environment."""
    folder = runs / env_id
    if manyhands(["sweep", env_id, "--seeds", str(seeds), "--jobs", str(jobs), "--out", str(folder)]) != 0:
        raise SystemExit(f"the sweep of {env_id} has not ended well; the same command goes on")
    return folder


def done_runs(folder: Path) -> list[RunFolder]:
    """The runs that have been evaluated, the best first."""
    found = [RunFolder(path.parent) for path in [*folder.glob("*/config.json"), *folder.glob("config.json")]]
    done = [(run.read_success(), run) for run in found]
    return [run for success, run in sorted(done, key=lambda one: -(one[0] or 0)) if success is not None]


def require_recipe(run: RunFolder, env_id: str) -> Recipe:
    """The recipe by which a run was made. Raises ValueError if it was made by other settings, or for another id; the
    dense reward may be missing, which a policy does not see."""
    settings = run.read_settings()
    recipe = find_recipe(settings.env_id)
    if recipe is None:
        raise ValueError(f"there is no recipe for {settings.env_id}: policies that ship are trained by one")
    if env_id.replace("Dense", "") != settings.env_id.replace("Dense", ""):
        raise ValueError(f"{run.path} was trained for {settings.env_id}, not for {env_id}")
    wanted = recipe.settings(seed=settings.seed, num_threads=settings.num_threads)
    if settings != wanted:
        raise ValueError(f"{run.path} was trained by {settings}, which is not what its recipe says: {wanted}")
    return recipe


def shared_file(model: onnx.ModelProto, env_id: str) -> str | None:
    """The file of another id that holds the same graph, weights and all, if there is one."""
    for card in map(read_card, sorted(POLICIES.glob("*.yaml"))):
        if card.file != f"{env_id}.onnx" and onnx.load(POLICIES / card.file).graph == model.graph:
            return card.file
    return None


def write_file(model: onnx.ModelProto, env_id: str) -> str:
    """The name of the file that holds the policy of `env_id`: its own, or one that is there already."""
    own = POLICIES / f"{env_id}.onnx"
    file = shared_file(model, env_id)
    if file is None:
        save_model(model, own)
        return own.name
    own.unlink(missing_ok=True)
    return file


def package(folder: Path, env_id: str) -> Card:
    """Writes the policy of the best run in a folder, and its card."""
    runs = done_runs(folder)
    if not runs:
        raise ValueError(f"{folder} holds no run of {env_id} that is done")
    run = runs[0]
    recipe, row = require_recipe(run, env_id), read_rows(run)[-1]
    by_float = Policy(run.policy).evaluate(env_id, episodes=EPISODES, first_seed=FIRST_SEED)
    with tempfile.TemporaryDirectory() as place:
        small = Path(place) / "half.onnx"
        save_model(to_onnx(read_policy(run.policy), env_id, half=True), small)
        by_half = Policy(small).evaluate(env_id, episodes=EPISODES, first_seed=FIRST_SEED)
    half = by_half.success_rate >= by_float.success_rate - MOST_LOST
    measured = by_half if half else by_float
    card = Card(
        environment=env_id,
        file=write_file(to_onnx(read_policy(run.policy), env_id, half=half), env_id),
        success=round(measured.success_rate, 4),
        success_float32=round(by_float.success_rate, 4),
        episodes=EPISODES,
        first_seed=FIRST_SEED,
        mean_length=round(measured.mean_length, 2),
        weights="float16" if half else "float32",
        recipe=recipe.path.name,
        beyond=", ".join(recipe.beyond) or "nothing",
        seed=run.read_settings().seed,
        seeds=len(runs),
        training_seconds=round(row.seconds, 1),
        env_steps=row.env_steps,
        version=json.loads(run.config.read_text())["versions"]["manyhands"],
    )
    card.save(POLICIES / f"{env_id}.yaml")
    return card


def row_of(card: Card) -> str:
    """A line of the table."""
    return (
        f"| {card.environment} | {card.success:.1%} | {card.weights} | {card.training_seconds:,.0f} s | "
        f"{card.env_steps:,} | {card.beyond} | {card.seed}{f', best of {card.seeds}' if card.seeds > 1 else ''} |"
    )


def write_table() -> None:
    """Brings the table of the page up to the cards."""
    cards = [read_card(path) for path in sorted(POLICIES.glob("*.yaml"))]
    before, found, rest = PAGE.read_text().partition(TABLE)
    if not found:
        raise ValueError(f"{PAGE} has no table that begins with {TABLE}")
    after = rest.partition("\n\n")[2]
    rows = [TABLE, "|" + " --- |" * (TABLE.count("|") - 1), *map(row_of, cards)]
    PAGE.write_text(before + "\n".join(rows) + "\n\n" + after)


def main() -> int:
    """Trains what is to be trained, and packs it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("envs", nargs="*", metavar="ENV", help="default: all that have a recipe")
    parser.add_argument("--seeds", type=int, default=1, help="runs of each, of which the best is packed (1)")
    parser.add_argument("--jobs", type=int, default=1, help="trainings at a time (1)")
    parser.add_argument("--runs", type=Path, default=ROOT / "build/policies", help="where the runs go")
    parser.add_argument("--trained", type=Path, help="a folder of runs of the one ENV; nothing is trained")
    arguments = parser.parse_args()
    ids = [resolve_env_id(name) for name in arguments.envs] or recipe_ids()
    if arguments.trained is not None and len(ids) != 1:
        parser.error("--trained is of one ENV")
    for env_id in ids:
        folder = arguments.trained or train(env_id, arguments.runs, arguments.seeds, arguments.jobs)
        card = package(folder, env_id)
        print(f"{env_id}: success {card.success:.1%} in {card.weights}, {card.success_float32:.1%} as trained")
    write_table()
    return 0


if __name__ == "__main__":
    sys.exit(main())
