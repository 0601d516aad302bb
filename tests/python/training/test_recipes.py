"""Recipes are read line by line, make the settings of a run, and are what `manyhands train` shows first."""

import json
from pathlib import Path

import pytest

from manyhands import cli
from manyhands._core.envs import env_ids, expert_ids, make_env_batch, make_expert
from manyhands._core.learn import Trainer, TrainerConfig
from manyhands.simple_yaml import read_yaml
from manyhands.training.announcement import announce
from manyhands.training.recipe import find_recipe, load_recipe, named_recipe, recipe_ids
from manyhands.training.settings import TrainSettings

MINE = """\
# how I do it
environment: PandaReach-v3
num_envs: 16
max_env_steps: 1600   # few

beyond:
  expert: "shows: the way"

trainer:
  hidden_layers: [24, 16]
  gamma: 0.9
  cloning_filter: false

measured:
  machine: my machine
  seeds: 2
  success: 1
  seconds: 240
  env_steps: 1600
"""


def written(folder: Path, text: str = MINE) -> Path:
    path = folder / "mine.yaml"
    path.write_text(text)
    return path


def test_entries_know_their_lines(tmp_path: Path) -> None:
    entries = read_yaml(written(tmp_path))
    assert (entries["environment"].value, entries["environment"].line) == ("PandaReach-v3", 2)
    assert entries["max_env_steps"].value == 1600
    trainer = entries["trainer"].entries
    assert {name: entry.value for name, entry in trainer.items()} == {
        "hidden_layers": [24, 16], "gamma": 0.9, "cloning_filter": False
    }  # fmt: skip
    assert trainer["gamma"].line == 11
    assert entries["beyond"].entries["expert"].value == "shows: the way"


@pytest.mark.parametrize("path", sorted(Path(find_recipe("PandaReach-v3").path).parent.glob("*.yaml")))  # pyright: ignore
def test_shipped_files_mean_the_same_to_other_readers_of_yaml(path: Path) -> None:
    yaml = pytest.importorskip("yaml")
    ours = {
        name: {inner: one.value for inner, one in entry.entries.items()} or entry.value
        for name, entry in read_yaml(path).items()
    }
    assert yaml.safe_load(path.read_text()) == ours


def test_every_shipped_recipe_can_be_run() -> None:
    assert "PandaReach-v3" in recipe_ids() and "PandaPush-v3" in recipe_ids()
    for env_id in recipe_ids():
        recipe = find_recipe(env_id)
        assert recipe is not None and recipe.env_id == env_id
        config = recipe.settings(seed=3).trainer_config()
        assert config.seed == 3
        assert config.wants_expert == ("expert" in recipe.beyond), "what it uses is stated"
        assert not config.wants_expert or env_id in expert_ids()
    assert find_recipe("PandaPull-v3") is None


def test_a_recipe_may_be_like_another(tmp_path: Path) -> None:
    push = find_recipe("PandaPush-v3")
    assert push is not None
    text = "environment: PandaPushDense-v3\nlike: PandaPush-v3\nnum_envs: 8\ntrainer:\n  gamma: 0.5\n"
    recipe = load_recipe(written(tmp_path, text))
    assert (recipe.env_id, recipe.num_envs, recipe.max_env_steps) == ("PandaPushDense-v3", 8, push.max_env_steps)
    assert recipe.trainer == push.trainer | {"gamma": 0.5}
    assert recipe.beyond == push.beyond
    assert recipe.measured is None
    with pytest.raises(ValueError, match=r"mine.yaml:2: there is no environment 'PandaPull-v3'"):
        load_recipe(written(tmp_path, text.replace("PandaPush-v3", "PandaPull-v3")))


def test_a_recipe_may_be_like_the_shipped_one_of_its_environment(tmp_path: Path) -> None:
    shipped = find_recipe("PandaPush-v3")
    assert shipped is not None
    recipe = load_recipe(written(tmp_path, "environment: PandaPush\nlike: PandaPush\ntrainer:\n  gamma: 0.5\n"))
    assert recipe.env_id == "PandaPush-v3"
    assert recipe.trainer == shipped.trainer | {"gamma": 0.5}


def test_a_recipe_cannot_be_like_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("manyhands.training.recipe._FOLDER", tmp_path)
    (tmp_path / "PandaPush-v3.yaml").write_text("environment: PandaPush\nlike: PandaPush\n")
    with pytest.raises(ValueError, match=r"PandaPush-v3.yaml:2: a recipe cannot be like itself"):
        find_recipe("PandaPush-v3")


@pytest.mark.parametrize(
    "written_otherwise",
    [
        "\ufeff" + MINE,
        "---\n" + MINE,
        MINE.replace("\n", "\r\n"),
        MINE.replace("PandaReach-v3", "PandaReach"),
        MINE.replace("PandaReach-v3", "'PandaReach-v3'  # quoted"),
        MINE.replace("PandaReach-v3", '"PandaReach-v3"  # quoted'),
        MINE.replace("1600", "1.6e3"),
    ],
    ids=["byte order mark", "document", "Windows", "version", "single quotes", "double quotes", "exponent"],
)
def test_what_other_editors_and_people_write_means_the_same(written_otherwise: str, tmp_path: Path) -> None:
    assert load_recipe(written(tmp_path, written_otherwise)) == load_recipe(written(tmp_path))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"environment: \xe9", "byte 13 is not UTF-8; expected a text file in UTF-8"),
        (b"environment\0", "is no text file"),
        (b"", ":1: environment is missing here"),
    ],
)
def test_files_that_are_no_recipes(content: bytes, message: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=message):
        named_recipe(path, "PandaReach-v3")
    with pytest.raises(ValueError, match="is a folder; expected a recipe's file"):
        named_recipe(tmp_path, "PandaReach-v3")


def test_a_recipes_settings_give_way_to_those_of_the_command(tmp_path: Path) -> None:
    recipe = load_recipe(written(tmp_path))
    settings = recipe.settings(num_envs=8, overrides={"gamma": 0.8})
    assert settings == TrainSettings(
        "PandaReach-v3", num_envs=8, max_env_steps=1600,
        overrides={"hidden_layers": [24, 16], "gamma": 0.8, "cloning_filter": False},
    )  # fmt: skip


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("num_envs: 16\n", "num_envs 16\n", 3, "expected 'name: value', found 'num_envs 16'"),
        ("num_envs: 16\n", "num_envs: many\n", 3, "num_envs is 'many', expected a whole number"),
        ("num_envs: 16\n", "num_envs: 0\n", 3, "num_envs is 0"),
        ("num_envs: 16\n", "num_envs: [16\n", 3, "'[16' is no number, list or plain text"),
        ("num_envs: 16\n", "worlds: 16\n", 1, "num_envs is missing here"),
        ("num_envs: 16\n", "num_env: 16\n", 3, "there is no 'num_env'; did you mean num_envs?"),
        ("trainer:\n", "trainr:\n", 9, "a recipe has no 'trainr' here; did you mean trainer?"),
        ("  gamma: 0.9", "\tgamma: 0.9", 11, "the line begins with a tab; YAML indents by spaces"),
        ("beyond:\n", "looks:\n  color: 0.1\nbeyond:\n", 6, "there are no cameras whose looks could vary"),
        ("beyond:\n", 'cameras: ["top"]\nlooks:\n  color: 0.1\nbeyond:\n', 7, "what can vary is position, direction"),
        ("num_envs: 16\n", "num_envs: 16\nworlds: 16\n", 4, "a recipe has no 'worlds' here"),
        ("num_envs: 16\n", "num_envs: 16\nnum_envs: 17\n", 4, "num_envs is there twice, first on line 3"),
        ("num_envs: 16\n", "num_envs: 16\n  gamma: 1\n", 4, "gamma is indented"),
        ("PandaReach-v3", "PandaReech-v3", 2, "there is no environment 'PandaReech-v3'"),
        ("gamma: 0.9", "gama: 0.9", 11, "'gama' is no trainer setting; did you mean gamma?"),
        ("gamma: 0.9", "seed: 3", 11, "'seed' is no trainer setting"),
        ("gamma: 0.9", "gamma: 1.5", 11, "gamma is 1.5"),
        ("gamma: 0.9", "gamma: high", 11, "gamma is 'high', expected a number"),
        ("seeds: 2", "seeds: 2\n  cores: 3", 17, "a recipe has no 'cores' here"),
        ("  seeds: 2\n", "", 14, "seeds is missing here"),
        ("trainer:\n", "trainer: fast\n", 10, "hidden_layers is indented"),
    ],
)
def test_errors_name_the_line(old: str, new: str, line: int, message: str, tmp_path: Path) -> None:
    assert old in MINE
    path = written(tmp_path, MINE.replace(old, new))
    with pytest.raises(ValueError) as caught:
        load_recipe(path)
    assert str(caught.value).startswith(f"{path}:{line}: ")
    assert message in str(caught.value)


def test_the_first_screen_says_what_it_will_take(tmp_path: Path) -> None:
    recipe = load_recipe(written(tmp_path))
    text = "\n".join(announce(recipe, recipe.settings()))
    assert f"Recipe: {recipe.path}" in text and "expert: shows: the way" in text
    assert "Expect 100.0% success after at most 4 min and 1,600 steps" in text
    assert "the worst of 2 seeds on my machine" in text
    text = "\n".join(announce(recipe, recipe.settings(overrides={"gamma": 0.5})))
    assert "Expect" not in text and "settings of yours" in text


def test_without_a_recipe_the_first_screen_says_what_to_try() -> None:
    text = "\n".join(announce(None, TrainSettings("PandaReachJoints-v3")))
    assert "No recipe is known for PandaReachJoints-v3" in text
    assert "PandaPush-v3" in text and "--recipe" in text and "--set" in text


def test_train_takes_a_recipe_of_ones_own(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    runs = tmp_path / "runs"
    recipe = written(tmp_path)
    assert cli.main(["train", "PandaReach", "--recipe", str(recipe), "--episodes", "20", "--runs", str(runs)]) == 0
    assert f"Recipe: {recipe}" in capsys.readouterr().out
    (folder,) = runs.iterdir()
    config = json.loads((folder / "config.json").read_text())
    assert config["trainer"]["hidden_layers"] == [24, 16]
    assert config["settings"]["num_envs"] == 16
    assert cli.main(["train", "PandaPush", "--recipe", str(recipe), "--runs", str(runs)]) == 2
    assert "is a recipe for PandaReach-v3, not for PandaPush-v3" in capsys.readouterr().err
    assert cli.main(["train", "PandaPush", "--recipe", str(tmp_path / "none.yaml"), "--runs", str(runs)]) == 2
    assert "none.yaml" in capsys.readouterr().err


def test_a_trainer_is_led_by_the_expert() -> None:
    config = TrainerConfig()
    config.expert_rate, config.exploration_noise, config.warmup_transitions = 1.0, 0.0, 10**6
    with pytest.raises(ValueError, match="ask for an expert of PandaPush-v3"):
        Trainer(make_env_batch("PandaPush-v3", 16), None, config)
    trainer = Trainer(make_env_batch("PandaPush-v3", 64), None, config, make_expert("PandaPush-v3"))
    assert trainer.advance(60).success_rate > 0.95


def test_an_environment_without_an_expert_is_told() -> None:
    """Of this package's own each has one."""
    assert set(expert_ids()) == set(env_ids())
    with pytest.raises(ValueError, match="no expert for 'PandaPull-v3'"):
        TrainSettings("PandaPull-v3", overrides={"expert_rate": 0.5}).trainer_config()
