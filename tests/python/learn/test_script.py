"""manyhands.learn in a script with an environment of its own: it ends in silence, whatever refers to what."""

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = """
import gymnasium
import numpy as np
import manyhands.learn as learn


class Walk(gymnasium.Env):
    observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (1,), np.float32)
    action_space = gymnasium.spaces.Box(-1, 1, (1,), np.float32)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.steps = 0
        return np.zeros(1, np.float32), {}

    def step(self, action):
        self.steps += 1
        return action, 0.0, False, self.steps == 5, {}


env = Walk()
model = learn.PPO("MlpPolicy", env, batch_size=2, n_steps=4)
kept = model.learn(20, callback=lambda model: len(str(env)) > 0)
"""


@pytest.mark.parametrize("end", ["", "raise RuntimeError('as it should')", "env.model = model"])
def test_nothing_is_left_when_a_script_ends(tmp_path: Path, end: str) -> None:
    """The model knows the environment, its class the module, and that the model: a cycle through C++."""
    script = tmp_path / "script.py"
    script.write_text(SCRIPT + end)
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=120, check=False)
    assert "leaked" not in done.stderr
    assert done.returncode == ("raise" in end)
