"""Policies to and from Stable-Baselines3, where the networks are of one kind: `from_sb3` and `to_sb3`.

Not imported by the rest of `manyhands`, which does without Stable-Baselines3.
"""

from pathlib import Path
from typing import Any

import numpy as np

from manyhands._core.learn import Policy, read_policy
from manyhands.extras import pip_install
from manyhands.training.policy_file import differences, save_model
from manyhands.training.policy_graph import INPUTS, PolicyGraph
from manyhands.training.run_folder import RunFolder

try:
    import torch  # pyright: ignore[reportMissingImports]
    from gymnasium.spaces import Box, Dict
    from stable_baselines3 import TD3  # pyright: ignore[reportMissingImports]
    from stable_baselines3.common.torch_layers import (  # pyright: ignore[reportMissingImports]
        BaseFeaturesExtractor,
        CombinedExtractor,
    )
except ImportError as error:
    hint = pip_install("stable-baselines3")
    raise ImportError(f"manyhands.training.sb3 needs Stable-Baselines3: {hint}") from error

_ACTIVATIONS = {"ReLU": "Relu", "Tanh": "Tanh"}


class GoalFeatures(BaseFeaturesExtractor):
    """What our networks see of an observation: [o, g, g - achieved, differences within o], normalised and clipped.

    A clip cannot become part of a linear layer, so that this stands before the network's first. It learns nothing.
    """

    def __init__(self, observation_space: Dict, pairs: Any, mean: Any, scale: Any, clip: float) -> None:
        """pairs (observation_dim, n) takes the differences; mean and scale (inputs): as in `Policy`."""
        super().__init__(observation_space, features_dim=len(mean))
        self.clip = clip
        for name, value in (("pairs", pairs), ("mean", mean), ("scale", scale)):
            self.register_buffer(name, torch.tensor(np.array(value, np.float32)))

    def forward(self, observations: dict[str, Any]) -> Any:
        """(n, inputs) from rows of a goal environment's observations."""
        seen, achieved, goal = (observations[name] for name in INPUTS)
        x = torch.cat([seen, goal, goal - achieved, seen @ self.pairs], dim=1)
        return ((x - self.mean) * self.scale).clamp(-self.clip, self.clip)


def to_sb3(policy: Path | str, env: Any, **arguments: Any) -> TD3:
    """A TD3 whose `predict` acts as a policy that was trained here by DDPG, TD3, SAC or TQC: a file or a run's folder.

    `env` is a goal environment or vector of them with the policy's sizes; `arguments` go to TD3. The critics are new:
    who trains on lets them learn before the actor moves. Raises ValueError if it is another network or does not fit.
    """
    policy = Path(policy)
    arrays = read_policy(RunFolder(policy).policy if policy.is_dir() else policy)
    if arrays.output != "tanh" or arrays.goal_dim == 0:
        raise ValueError(f"{policy} is no policy that reaches goals and ends with tanh")
    if arrays.cube_rotation >= 0:
        raise ValueError(f"{policy} sees a cube's rotation, which no network of Stable-Baselines3 does")
    _require_fit(arrays, env)
    hidden = [len(bias) for _, bias in arrays.layers[:-1]]
    seen = {"pairs": differences(arrays), "mean": arrays.mean, "scale": arrays.scale, "clip": arrays.clip}
    kwargs = {
        "net_arch": hidden,
        "activation_fn": torch.nn.ReLU if arrays.activation == "relu" else torch.nn.Tanh,
        "features_extractor_class": GoalFeatures,
        "features_extractor_kwargs": seen,
    }
    model = TD3("MultiInputPolicy", env, **{"policy_kwargs": kwargs, "device": "cpu", **arguments})
    for actor in (model.actor, model.actor_target):
        linear = [module for module in actor.mu if isinstance(module, torch.nn.Linear)]
        for module, (weight, bias) in zip(linear, arrays.layers, strict=True):
            module.weight.data.copy_(torch.tensor(weight))
            module.bias.data.copy_(torch.tensor(bias))
    return model


def _require_fit(arrays: Policy, env: Any) -> None:
    sizes = (arrays.observation_dim, arrays.goal_dim, arrays.goal_dim)
    wanted = {name: (size,) for name, size in zip(INPUTS, sizes, strict=True)}
    space = env.observation_space
    found = {name: one.shape for name, one in space.spaces.items()} if isinstance(space, Dict) else space.shape
    if found != wanted or env.action_space.shape != arrays.layers[-1][1].shape:
        raise ValueError(
            f"the policy takes {wanted} and gives {arrays.layers[-1][1].shape}, the environment gives {found} and "
            f"takes {env.action_space.shape}"
        )
    _require_unit_box(env.action_space)


def _require_unit_box(space: Any) -> None:
    if not (isinstance(space, Box) and np.all(space.low == -1) and np.all(space.high == 1)):
        raise ValueError(f"actions are {space}; only those between -1 and 1 can be converted")


def from_sb3(model: Any, env_id: str, path: Path | str) -> None:
    """Writes the deterministic policy of a DDPG, TD3, SAC or TQC model on a goal environment as an ONNX file, which
    `manyhands evaluate`, `view` and `record` take as one of ours. The statistics of a VecNormalize around the model's
    environment go along. Raises ValueError, with the reason, on a model that cannot be converted; OSError if the file
    cannot be written.
    """
    actor, spaces = getattr(model, "actor", None), getattr(model.observation_space, "spaces", None)
    if actor is None or not hasattr(actor, "mu"):
        raise ValueError(f"{type(model).__name__} has no deterministic actor: DDPG, TD3, SAC and TQC can be converted")
    if spaces is None or sorted(spaces) != sorted(INPUTS):
        raise ValueError(f"the model sees {model.observation_space}, expected a goal environment's {', '.join(INPUTS)}")
    _require_unit_box(model.action_space)
    graph = PolicyGraph()
    seen = _normalised_inputs(graph, model.get_vec_normalize_env(), list(spaces))
    x = _features(graph, actor.features_extractor, seen)
    latent = getattr(actor, "latent_pi", None)  # of SAC and TQC
    modules = [*_leaves(latent), *_leaves(actor.mu)] if latent is not None else _leaves(actor.mu)
    for number, module in enumerate(modules):
        x = _apply(graph, module, x, number)
    graph.apply("Identity" if latent is None else "Tanh", [x], "action")
    sizes = {name: space.shape[0] for name, space in spaces.items()}
    actions = model.action_space.shape[0]
    save_model(graph.model(sizes["observation"], sizes["desired_goal"], (actions,), env_id), Path(path))


def _normalised_inputs(graph: PolicyGraph, statistics: Any, names: list[str]) -> dict[str, str]:
    """What the model sees of each input, under whose name."""
    seen = {name: name for name in names}
    if statistics is not None and statistics.norm_obs:
        for name in statistics.norm_obs_keys or names:
            known = statistics.obs_rms[name]
            scale = 1 / np.sqrt(known.var + statistics.epsilon)
            seen[name] = graph.normalised(name, known.mean, scale, statistics.clip_obs, of=f"_{name}")
    return seen


def _features(graph: PolicyGraph, extractor: Any, seen: dict[str, str]) -> str:
    if type(extractor) is CombinedExtractor:
        return graph.apply("Concat", [seen[name] for name in extractor.extractors], "features", axis=1)
    if type(extractor) is GoalFeatures and all(name == inner for name, inner in seen.items()):
        pairs, mean, scale = (buffer.cpu().numpy() for buffer in (extractor.pairs, extractor.mean, extractor.scale))
        return graph.goal_features(pairs, mean, scale, extractor.clip)
    raise ValueError(f"the features extractor {type(extractor).__name__} cannot be converted")


def _leaves(module: Any) -> list[Any]:
    """The layers of a Sequential, and of those within it, in order."""
    return [inner for inner in module.modules() if not isinstance(inner, torch.nn.Sequential)]


def _apply(graph: PolicyGraph, module: Any, x: str, number: int) -> str:
    output = f"layer_{number}"
    match type(module).__name__:
        case "Linear":
            weight, bias = (parameter.detach().cpu().numpy() for parameter in (module.weight, module.bias))
            return graph.linear(x, weight, bias, number)
        case "Hardtanh" if module.min_val == -module.max_val:
            return graph.clipped(x, module.max_val, output)
        case name if name in _ACTIVATIONS:
            return graph.apply(_ACTIVATIONS[name], [x], output)
        case name:
            raise ValueError(f"the actor's layer {name} cannot be converted")
