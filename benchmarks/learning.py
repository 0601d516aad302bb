"""Learning beside Stable-Baselines3 in one run: gradient steps a second at its network sizes, and what of the
environment's own rate PPO keeps.

    build/interop/bin/python -m benchmarks.learning     # after `make interop`; five minutes on an idle machine

Off-policy: both fill their replay with 2,000 steps of one environment, and are timed over gradient steps, in turn,
the best of three. Both use all cores. PPO: steps of the environment a second with learning and without.
"""

import argparse
import time
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import stable_baselines3 as sb3  # pyright: ignore[reportMissingImports]
import torch  # pyright: ignore[reportMissingImports]

import manyhands  # noqa: F401  registers the environments
from manyhands import learn

ENV = "PandaPushDense-v3"
PPO_ENVS, PPO_WORLDS = ("PandaReachDense-v3", "PandaPushDense-v3"), 256


def best_rate(one: Callable[[], float], other: Callable[[], float], rounds: int) -> tuple[float, float]:
    """The best of several rates, taken in turn."""
    pairs = [(one(), other()) for _ in range(rounds)]
    return max(pair[0] for pair in pairs), max(pair[1] for pair in pairs)


def theirs(algorithm: str, layers: list[int], steps: int) -> Callable[[], float]:
    """Gradient steps a second of Stable-Baselines3."""
    env = gymnasium.make(ENV)
    model = getattr(sb3, algorithm)("MultiInputPolicy", env, policy_kwargs={"net_arch": layers}, seed=0)
    model.learn(2_000)

    def rate() -> float:
        begin = time.perf_counter()
        model.train(gradient_steps=steps, batch_size=256)
        return steps / (time.perf_counter() - begin)

    return rate


def ours(algorithm: str, layers: list[int], steps: int) -> Callable[[], float]:
    """Gradient steps a second here."""
    given: Any = {"policy_kwargs": {"net_arch": layers}, "n_envs": 16, "hindsight_fraction": 0.0}
    model = getattr(learn, algorithm)("MultiInputPolicy", ENV, gradient_steps=50, **given)
    model.learn(2_000)

    def rate() -> float:
        before = model.metrics
        model.learn(16 * (steps // 50))
        after = model.metrics
        return (after.gradient_steps - before.gradient_steps) / (after.learn_seconds - before.learn_seconds)

    return rate


def show_off_policy(steps: int, rounds: int) -> None:
    """A table of gradient steps a second."""
    print(f"gradient steps/s, batch 256, {ENV}, torch {torch.__version__} on {torch.get_num_threads()} threads")
    print("| algorithm | layers | here | Stable-Baselines3 | ratio |\n| --- | --- | --- | --- | --- |")
    for algorithm, sizes in (("SAC", [256, 256]), ("TD3", [400, 300]), ("DDPG", [400, 300]), ("TD3", [64, 64])):
        here, there = best_rate(ours(algorithm, sizes, steps), theirs(algorithm, sizes, steps), rounds)
        print(f"| {algorithm} | {sizes} | {here:.0f} | {there:.0f} | {here / there:.1f} |", flush=True)


def environment_rate(env_id: str, steps: int) -> float:
    """Steps of all worlds a second, under random actions."""
    envs: Any = gymnasium.make_vec(env_id, num_envs=PPO_WORLDS, autoreset_mode="SameStep")
    envs.reset(seed=0)
    actions = np.random.default_rng(0).uniform(-1, 1, (steps, *envs.action_space.shape)).astype(np.float32)
    begin = time.perf_counter()
    for action in actions:
        envs.step(action)
    return steps * PPO_WORLDS / (time.perf_counter() - begin)


def show_ppo(iterations: int) -> None:
    """What PPO keeps of the environment's rate."""
    print("\n| PPO | environment steps/s | with learning | share |\n| --- | --- | --- | --- |")
    for env_id in PPO_ENVS:
        model = learn.PPO("MultiInputPolicy", env_id, n_steps=32, batch_size=1024, n_envs=PPO_WORLDS)
        model.learn(PPO_WORLDS * 32)
        alone = environment_rate(env_id, iterations)
        before = model.num_timesteps
        begin = time.perf_counter()
        model.learn(PPO_WORLDS * iterations)
        rate = (model.num_timesteps - before) / (time.perf_counter() - begin)
        print(f"| {env_id} | {alone:,.0f} | {rate:,.0f} | {rate / alone:.2f} |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=500, help="gradient steps of a measurement (default 500)")
    parser.add_argument("--rounds", type=int, default=3, help="measurements of which the best counts (default 3)")
    given = parser.parse_args()
    show_off_policy(given.steps, given.rounds)
    show_ppo(10 * 32)


if __name__ == "__main__":
    main()
