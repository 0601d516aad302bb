"""Packages of the extra `train` without which a training does all the same, and what it leaves out."""

from importlib.util import find_spec

from manyhands.extras import install_extra

_GIVES = {
    "rich": "no progress bar",
    "matplotlib": "no learning_curve.png",
    "onnx": "no policy.onnx",
    "tensorboard": "no TensorBoard events",
}


def has(package: str) -> bool:
    """Whether one of them is installed."""
    return find_spec(package) is not None


def left_out() -> list[str]:
    """A line that says what is left out and how to have it, if anything is."""
    missing = [package for package in _GIVES if not has(package)]
    if not missing:
        return []
    return [f"There will be {', '.join(_GIVES[package] for package in missing)}: {install_extra('train')}"]
