"""What docs/learn.md writes comes true."""

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from manyhands import learn

GUIDE = (Path(__file__).resolve().parents[3] / "docs" / "learn.md").read_text()
BLOCKS = re.findall(r"```python\n(.*?)```", GUIDE, re.DOTALL)


def mean_return(env: Any, act: Any) -> float:
    """Over 100 episodes, as `evaluate_policy` begins them."""
    total = 0.0
    for seed in range(100):
        observation, _ = env.reset(seed=seed)
        over = False
        while not over:
            observation, reward, terminated, truncated, _ = env.step(act(observation))
            total += reward
            over = terminated or truncated
    return total / 100


@pytest.mark.parametrize("block", range(len(BLOCKS)))
def test_each_block_is_a_program_of_its_own(block: int, tmp_path: Path) -> None:
    """With fewer steps than the guide takes."""
    program = re.sub(r"\d+_000", "500", BLOCKS[block])
    run = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr


@pytest.fixture(scope="module")
def park() -> dict[str, Any]:
    """What the block with an environment of one's own defines, before it trains."""
    (block,) = (block for block in BLOCKS if "class Park" in block)
    names: dict[str, Any] = {}
    exec(block[: block.index("model = ")], names)
    return names | {"training": block[block.index("model = ") :]}


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_own_environment_is_learned_nearly_as_well_as_by_hand(park: dict[str, Any], seed: int) -> None:
    names = dict(park)
    exec(names["training"].replace("seed=1", f"seed={seed}"), names)
    assert learn.evaluate_policy(names["model"], names["Park"](), 100)[0] > -6, "five seeds came to -4.4 to -5.1"


def test_what_nothing_and_a_law_by_hand_are_worth(park: dict[str, Any]) -> None:
    env = park["Park"]()
    nothing = mean_return(env, lambda observation: np.zeros(1))
    by_hand = mean_return(env, lambda observation: np.clip([-3 * observation[0] - 3 * observation[1]], -1, 1))
    assert f"worth {nothing:.0f} in" in GUIDE
    assert f"{by_hand:.1f};" in GUIDE


def test_the_goal_example_learns_to_reach() -> None:
    """With smaller networks than the guide takes."""
    model = learn.DDPG("MultiInputPolicy", "PandaReach-v3", policy_kwargs={"net_arch": [64, 64]}).learn(20_000)
    assert model.metrics.success_rate > 0.9
