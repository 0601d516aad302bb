"""manyhands.learn: it learns what is easy, takes any environment, and says plainly what it cannot."""

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import manyhands  # noqa: F401  registers the environments
from manyhands.learn import DDPG, PPO, SAC, TD3, TQC, Model, evaluate_policy

SMALL: dict[str, Any] = {"policy_kwargs": {"net_arch": [32, 32]}, "batch_size": 64}


class Corridor(gymnasium.Env[np.ndarray, np.ndarray]):
    """Walk right: the reward is the step; actions in a lopsided box, observations a dict of three kinds."""

    observation_space = gymnasium.spaces.Dict(
        place=gymnasium.spaces.Box(-np.inf, np.inf, (1,)),
        lamp=gymnasium.spaces.Discrete(3),
        flags=gymnasium.spaces.MultiBinary(2),
    )
    action_space = gymnasium.spaces.Box(np.array([-1.0]), np.array([3.0]), dtype=np.float64)

    def __init__(self) -> None:
        self.x, self.t, self.seen = 0.0, 0, []

    def _show(self) -> Any:
        return {"place": np.array([self.x], np.float32), "lamp": self.t % 3, "flags": np.array([1, 0], np.int8)}

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.x, self.t = float(self.np_random.uniform(-1, 1)), 0
        return self._show(), {}

    def step(self, action: np.ndarray) -> Any:
        assert self.action_space.contains(action)
        self.seen.append(float(action[0]))
        self.t += 1
        self.x += 0.1 * float(action[0])
        return self._show(), float(action[0]), False, self.t >= 20, {}


def test_cartpole_is_balanced() -> None:
    model = PPO("MlpPolicy", "CartPole-v1", n_steps=512, learning_rate=1e-3, seed=1).learn(30_000)
    assert model.num_timesteps >= 30_000
    mean, _ = evaluate_policy(model, gymnasium.make("CartPole-v1"), 20)
    assert mean > 400


@pytest.mark.parametrize("algorithm", [SAC, TQC])
def test_the_pendulum_swings_up(algorithm: Any) -> None:
    few: dict[str, Any] = {"n_quantiles": 5, "top_quantiles_to_drop_per_net": 1} if algorithm is TQC else {}
    model = algorithm("MlpPolicy", "Pendulum-v1", learning_rate=3e-3, seed=2, **SMALL, **few).learn(6_000)
    mean, _ = evaluate_policy(model, gymnasium.make("Pendulum-v1"), 10)
    assert mean > -300, "doing nothing is worth -1200"


@pytest.mark.parametrize("algorithm", [TD3, DDPG, PPO])
def test_a_users_own_environment_is_learned(algorithm: Any) -> None:
    env = Corridor()
    more: dict[str, Any] = {"n_steps": 256, "learning_rate": 3e-3} if algorithm is PPO else {"gamma": 0.9}
    model = algorithm("MultiInputPolicy", env, **SMALL, **more)
    model.learn(4_000)
    mean, _ = evaluate_policy(model, env, 5)
    assert mean > 45, "60 at best, -20 at worst"
    assert -1 <= min(env.seen) < 0 < max(env.seen) <= 3, "actions come in the environment's own bounds"


def test_environments_of_this_package_run_in_cpp() -> None:
    small = {"net_arch": [64, 64]}
    model = DDPG("MultiInputPolicy", "PandaReach-v3", gamma=0.95, tau=0.05, policy_kwargs=small)
    assert model._worlds.native
    assert model.n_envs == 8
    assert PPO("MultiInputPolicy", "PandaReach-v3").n_envs == 64
    model.learn(16_000)
    env = gymnasium.make("PandaReach-v3")
    successes = 0
    for seed in range(20):
        observation, info = env.reset(seed=seed)
        over = False
        while not over:
            action, state = model.predict(observation, deterministic=True)
            observation, _, terminated, truncated, info = env.step(action)
            over = terminated or truncated
            assert state is None
        successes += bool(info["is_success"])
    assert successes >= 18


def test_hindsight_serves_a_users_goal_environment() -> None:
    """The same task behind a wrapper of the user's is stepped in Python, and its compute_reward is asked."""
    asked: list[int] = []

    class Watched(gymnasium.Wrapper[Any, Any, Any, Any]):
        def __init__(self, env: Any) -> None:
            super().__init__(env)

    env = Watched(gymnasium.make("PandaReach-v3"))
    inner = env.unwrapped
    original = inner.compute_reward  # pyright: ignore[reportAttributeAccessIssue]

    def compute_reward(achieved: Any, desired: Any, info: Any) -> Any:
        asked.append(len(achieved))
        return original(achieved, desired, info)

    inner.compute_reward = compute_reward  # pyright: ignore[reportAttributeAccessIssue]
    model = TD3("MultiInputPolicy", env, learning_starts=50, **SMALL)
    assert not model._worlds.native
    model.learn(200)
    assert model.metrics.gradient_steps > 100
    assert asked and set(asked) == {round(0.8 * 64)}


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP, AutoresetMode.DISABLED])
def test_vectors_are_taken_in_every_mode_of_sync_vector_env(mode: AutoresetMode) -> None:
    envs = SyncVectorEnv([Corridor] * 3, autoreset_mode=mode)
    model = PPO("MlpPolicy", envs, n_steps=64, batch_size=64)
    model.learn(64 * 3 * 2)
    assert model.n_envs == 3
    assert model.metrics.episodes == 3 * (128 // 20)


@pytest.mark.parametrize("mode", [AutoresetMode.SAME_STEP, AutoresetMode.DISABLED])
def test_a_vectors_last_observations_are_seen(mode: AutoresetMode) -> None:
    """Of a vector that is no list of environments: where each episode ended, not where the next begins."""
    envs = gymnasium.make_vec("PandaReachDense-v3", num_envs=4, autoreset_mode=mode, max_episode_steps=7)
    model = PPO("MultiInputPolicy", envs, n_steps=20, batch_size=40)
    assert not model._worlds.native
    batch = model._worlds.batch
    ends: list[Any] = []
    for _ in range(7):
        batch.step(np.full((4, 3), 0.3, np.float32))
    ends, cut = batch.observations()[1].copy(), batch.truncated
    assert cut.all() or batch.terminated.any()
    moved = np.linalg.norm(ends - np.array([0.0384, 0.0, 0.1975], np.float32), axis=1)
    assert (moved > 0.03).all(), "the arm starts an episode near there"


def test_the_same_seed_gives_the_same_weights(tmp_path: Path) -> None:
    def trained(**changes: Any) -> Any:
        model = SAC("MlpPolicy", Corridor(), **({"seed": 3, **SMALL} | changes)).learn(300)
        return model.policy.layers[0][0]

    first = trained()
    np.testing.assert_array_equal(first, trained(num_threads=1))
    np.testing.assert_array_equal(first, trained(replay_folder=str(tmp_path)))
    assert not np.array_equal(first, trained(n_steps=3))
    assert not np.array_equal(first, trained(seed=4))


@pytest.mark.parametrize("algorithm", [PPO, SAC, TQC, TD3, DDPG])
def test_a_saved_model_acts_the_same_and_learns_on(algorithm: Any, tmp_path: Path) -> None:
    def made() -> Model:
        more: dict[str, Any] = {"n_steps": 64} if algorithm is PPO else {}
        return algorithm("MlpPolicy", "Pendulum-v1", seed=5, **SMALL, **more)

    model = made().learn(450)
    model.save(tmp_path / "model", include_replay=True)
    again = algorithm.load(tmp_path / "model")
    states = np.random.default_rng(0).normal(size=(6, 3)).astype(np.float32)
    np.testing.assert_array_equal(
        model.predict(states, deterministic=True)[0], again.predict(states, deterministic=True)[0]
    )
    model.learn(300)
    again.learn(300)
    assert again.num_timesteps == 750
    for (weight, bias), (weight_again, bias_again) in zip(model.policy.layers, again.policy.layers, strict=True):
        np.testing.assert_array_equal(weight, weight_again)
        np.testing.assert_array_equal(bias, bias_again)


def test_predictions_are_drawn_or_best() -> None:
    model = SAC("MlpPolicy", "Pendulum-v1", **SMALL)
    state = np.zeros(3, np.float32)
    assert len({float(model.predict(state)[0][0]) for _ in range(5)}) == 5
    assert len({float(model.predict(state, deterministic=True)[0][0]) for _ in range(5)}) == 1
    several, _ = model.predict(np.zeros((4, 3), np.float32))
    assert several.shape == (4, 1)
    assert np.abs(several).max() <= 2


def test_the_onnx_file_acts_as_the_model(tmp_path: Path) -> None:
    onnxruntime = pytest.importorskip("onnxruntime")
    for model in (PPO("MlpPolicy", "CartPole-v1"), PPO("MlpPolicy", "Pendulum-v1"), SAC("MlpPolicy", "Pendulum-v1")):
        model.learn(300)
        model.save_onnx(tmp_path / "policy.onnx")
        session = onnxruntime.InferenceSession(tmp_path / "policy.onnx")
        states = np.random.default_rng(1).normal(size=(8, model.policy.observation_dim)).astype(np.float32)
        (actions,) = session.run(["action"], {"observation": states})
        expected, _ = model.predict(states, deterministic=True)
        if expected.ndim == 1:
            np.testing.assert_array_equal(actions[:, 0], expected)
        else:
            np.testing.assert_allclose(2 * actions, expected, atol=1e-5)  # the pendulum's torque is in [-2, 2]


def test_a_callback_ends_the_training() -> None:
    calls: list[int] = []

    def callback(model: Model) -> bool:
        calls.append(model.num_timesteps)
        return len(calls) < 10

    PPO("MlpPolicy", "Pendulum-v1").learn(1000, callback=callback)
    assert calls == list(range(1, 11))


class Broken(Corridor):
    """Goes wrong in its own way after a few steps."""

    def __init__(self, way: str) -> None:
        super().__init__()
        self.way = way

    def step(self, action: np.ndarray) -> Any:
        observation, reward, terminated, truncated, info = super().step(action)
        if self.t > 3:
            if self.way == "raises":
                raise OSError("the motor is on fire")
            if self.way == "observation":
                observation["place"][0] = np.nan
            reward = np.inf if self.way == "reward" else reward
        return observation, reward, terminated, truncated, info


@pytest.mark.parametrize(
    ("way", "error", "says"),
    [
        ("raises", OSError, "the motor is on fire"),
        ("observation", ValueError, r"Broken.step\(\) returned an observation that is not finite"),
        ("reward", ValueError, r"Broken.step\(\) returned a reward that is not finite"),
    ],
)
def test_errors_of_an_environment_come_through(way: str, error: type[Exception], says: str) -> None:
    with pytest.raises(error, match=says):
        PPO("MlpPolicy", Broken(way)).learn(100)


BAD: list[tuple[Any, dict[str, Any], str]] = [
    (PPO, {"policy": "CnnPolicy"}, "policy is 'CnnPolicy', expected 'MlpPolicy'"),
    (PPO, {"env": 3}, "env is 3, expected an id"),
    (PPO, {"batch_size": 4096}, "batch_size is 4096, but 1 worlds make 2048"),
    (PPO, {"gamma": 1.5}, "gamma is 1.5"),
    (PPO, {"clip_range": lambda left: left}, "clip_range is a schedule; give a number"),
    (PPO, {"policy_kwargs": {"net_arch": {"pi": [3], "vf": [4]}}}, "layers of the same sizes"),
    (PPO, {"policy_kwargs": {"activation_fn": "elu"}}, "activation_fn is 'elu', expected 'relu' or 'tanh'"),
    (PPO, {"policy_kwargs": {"ortho_init": True}}, "policy_kwargs has no 'ortho_init'"),
    (PPO, {"seed": -1}, "seed is -1"),
    (SAC, {"env": "CartPole-v1"}, "CartPole-v1 has discrete actions.*use PPO"),
    (PPO, {"n_envs": 0}, "n_envs is 0, expected 1 or more"),
    (PPO, {"policy_kwargs": {"net_arch": "big"}}, "net_arch is 'big', expected the units of each layer"),
    (SAC, {"buffer_size": 0}, "buffer_size is 0, expected 1 or more"),
    (SAC, {"target_entropy": "low"}, "target_entropy is 'low', expected a number or 'auto'"),
    (SAC, {"ent_coef": "none"}, "ent_coef is 'none', expected a number, 'auto'"),
    (SAC, {"n_steps": 0}, "n_steps is 0, it must be in"),
    (TD3, {"replay_folder": "/nowhere"}, "MB in a file in '/nowhere'"),
    (SAC, {"train_freq": 4}, "train_freq is 4.*gradient_steps"),
    (DDPG, {"policy_delay": 2}, "DDPG has no policy_delay; TD3 has"),
    (TQC, {"top_quantiles_to_drop_per_net": 25}, "top_quantiles_to_drop_per_net is 25"),
]


@pytest.mark.parametrize(("algorithm", "changes", "says"), BAD)
def test_what_makes_no_sense_is_said(algorithm: Any, changes: dict[str, Any], says: str) -> None:
    with pytest.raises((ValueError, TypeError, OSError), match=says):
        algorithm(**({"policy": "MlpPolicy", "env": "Pendulum-v1"} | changes))


def test_pictures_are_refused() -> None:
    env = gymnasium.make("PandaReach-v3", cameras={"front": {}})
    with pytest.raises(ValueError, match="hold pictures"):
        PPO("MultiInputPolicy", env)


def test_wrong_observations_are_refused() -> None:
    model = PPO("MlpPolicy", "Pendulum-v1")
    with pytest.raises(ValueError, match=r"the observation has shape \(4,\), expected \(3,\) or \(n, 3\)"):
        model.predict(np.zeros(4))
    goal = PPO("MultiInputPolicy", "PandaReach-v3")
    with pytest.raises(ValueError, match="expected a dict"):
        goal.predict(np.zeros(6))
    with pytest.raises(ValueError, match=r"^the observation holds nan, expected finite numbers"):
        model.predict(np.array([0, np.nan, 0]))
    whole = {"observation": np.zeros(6), "achieved_goal": np.zeros(3), "desired_goal": np.full(3, -np.inf)}
    with pytest.raises(ValueError, match=r"^the desired_goal holds -inf, expected finite numbers"):
        goal.predict(whole)
    with pytest.raises(ValueError, match="lacks desired_goal"):
        goal.predict({"observation": np.zeros(6), "achieved_goal": np.zeros(3)})


def test_what_reset_and_step_return_is_no_observation() -> None:
    env = gymnasium.make("Pendulum-v1")
    model = PPO("MlpPolicy", env)
    for returned in (env.reset(), env.step(np.zeros(1))):
        with pytest.raises(ValueError, match=rf"a tuple of {len(returned)}: reset returns \(observation, info\), step"):
            model.predict(returned)


def test_an_evaluation_tells_of_each_episode() -> None:
    env = gymnasium.make("Pendulum-v1")
    model = PPO("MlpPolicy", env)
    returns, lengths = evaluate_policy(model, env, 3, return_episode_rewards=True)
    assert lengths == [200] * 3
    assert evaluate_policy(model, env, 3) == (np.mean(returns), np.std(returns))


@pytest.mark.parametrize("path", [".", "", "..", "/", "folder/.."])
def test_a_model_needs_the_name_of_a_file(path: str) -> None:
    with pytest.raises(ValueError, match=r"^the path of the model is '.*', a folder; name a file, for example 'model'"):
        PPO("MlpPolicy", "Pendulum-v1").save(path)


@pytest.mark.parametrize("path", [".", "", ".."])
def test_an_onnx_file_needs_a_name(path: str) -> None:
    with pytest.raises(IsADirectoryError, match=r"^\.+ is a folder; name a file$"):
        PPO("MlpPolicy", "Pendulum-v1").save_onnx(path)


def test_bad_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="no saved model"):
        PPO.load(tmp_path / "nothing")
    (tmp_path / "text.zip").write_text("no zip")
    with pytest.raises(ValueError, match="is no saved model, or damaged"):
        PPO.load(tmp_path / "text")
    model = PPO("MlpPolicy", "Pendulum-v1")
    model.save(tmp_path / "model")
    with pytest.raises(ValueError, match="holds a PPO, not a SAC"):
        SAC.load(tmp_path / "model")
    with pytest.raises(ValueError, match=r"model.zip does not fit CartPole-v1: its task is Pendulum-v1") as refusal:
        PPO.load(tmp_path / "model", env="CartPole-v1")
    assert str(refusal.value).count("model.zip") == 1, "no other path is named"
    PPO("MlpPolicy", Corridor()).save(tmp_path / "own")
    with pytest.raises(ValueError, match=r"own.zip was trained on Corridor, which .* give it as env"):
        PPO.load(tmp_path / "own")
    PPO.load(tmp_path / "own", env=Corridor())
    whole = (tmp_path / "model.zip").read_bytes()
    (tmp_path / "half.zip").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ValueError, match="damaged"):
        PPO.load(tmp_path / "half")
    with pytest.raises(FileNotFoundError, match="there is no folder"):
        model.save(tmp_path / "no" / "folder" / "model")
