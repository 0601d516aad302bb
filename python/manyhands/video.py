"""Episodes as MP4 and GIF files, and the command `manyhands record`; needs `pip install 'manyhands[video]'`."""

import argparse
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from manyhands.envs.named import NamedEnv, given_options
from manyhands.envs.named import add_arguments as add_env_arguments
from manyhands.envs.single import PandaEnv
from manyhands.envs.spaces import RENDER_FPS
from manyhands.files import replacing

EXAMPLES = """\
examples:
  manyhands record PandaPickAndPlace                          three episodes of the scripted expert, as MP4
  manyhands record PandaPush --out push.gif --episodes 1
  manyhands record PandaReach --policy runs/PandaReach-v3-...  of what was learned
  manyhands record PandaPush --robot arm6 --option render_yaw=90
"""
_AFTER_SUCCESS = 8  # steps for which a reached goal is looked at


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What comes after `manyhands record`."""
    parser.add_argument("env", metavar="ENV", help="environment, with or without its version")
    parser.add_argument("--policy", type=Path, metavar="RUN_DIR|POLICY.onnx", help="default: the scripted expert")
    parser.add_argument("--out", type=Path, help="FILE.mp4 or FILE.gif; default: ENV.mp4")
    parser.add_argument("--episodes", type=int, default=3, metavar="N")
    parser.add_argument("--seed", type=int, default=0, help="of the first episode; the others count up")
    parser.add_argument("--size", type=int, nargs=2, default=(640, 480), metavar=("WIDTH", "HEIGHT"), help="[pixels]")
    add_env_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Writes the video."""
    from rich.console import Console
    from rich.progress import track

    from manyhands.training.settings import resolve_env_id

    env = NamedEnv(resolve_env_id(arguments.env), given_options(arguments))
    out = arguments.out or Path(f"{env.id}.mp4")
    if arguments.episodes < 1:
        raise ValueError(f"--episodes is {arguments.episodes}; expected 1 or more")
    width, height = arguments.size
    filmed = env.make(render_mode="rgb_array", render_width=width, render_height=height)
    act = _policy(arguments.policy, env)
    seeds = range(arguments.seed, arguments.seed + arguments.episodes)
    console = Console(stderr=True)
    shown = track(seeds, f"Filming {env.title}", console=console, transient=True, disable=not console.is_terminal)
    write_video(episodes(filmed, act, shown, env.max_steps), out)
    print(f"manyhands: {arguments.episodes} episodes of {env.title} are in {out}")
    return 0


def episodes(
    env: PandaEnv, act: Callable[[], Callable[[Any], Any]], seeds: Iterable[int], max_steps: int
) -> Iterator[NDArray[np.uint8]]:
    """The pictures of episodes, each under a fresh policy, until shortly after success or max_steps."""
    for seed in seeds:
        policy, left = act(), max_steps
        observation, _ = env.reset(seed=seed)
        yield _picture(env)
        while left > 0:
            observation, _, _, _, info = env.step(policy(observation))
            left = min(left - 1, _AFTER_SUCCESS) if info["is_success"] else left - 1
            yield _picture(env)


def write_video(pictures: Iterable[NDArray[np.uint8]], path: str | Path, fps: int = RENDER_FPS) -> Path:
    """Writes pictures (h, w, 3) as MP4 or GIF, as the name of the file ends. Raises ValueError on another ending,
    FileNotFoundError without the file's folder, ModuleNotFoundError without the extra `video`."""
    path = Path(path)
    if not path.parent.is_dir():
        raise FileNotFoundError(f"there is no folder {path.parent} to write {path.name} to")
    write = {".gif": _write_gif, ".mp4": _write_mp4}.get(path.suffix)
    if write is None:
        raise ValueError(f"{path} ends with {path.suffix!r}; expected .mp4 or .gif")
    with replacing(path) as temporary:
        write(pictures, temporary, fps)
    return path


def _write_gif(pictures: Iterable[NDArray[np.uint8]], path: Path, fps: int) -> None:
    from PIL import Image

    frames = [Image.fromarray(picture).convert("P", palette=Image.Palette.ADAPTIVE) for picture in pictures]
    _require_some(frames)
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=1000 / fps, loop=0)


def _write_mp4(pictures: Iterable[NDArray[np.uint8]], path: Path, fps: int) -> None:
    import imageio_ffmpeg

    writer: Any = None
    try:
        for picture in pictures:
            # H.264 wants even sides.
            frame = np.ascontiguousarray(picture[: picture.shape[0] // 2 * 2, : picture.shape[1] // 2 * 2])
            if writer is None:
                size = frame.shape[1], frame.shape[0]
                writer = imageio_ffmpeg.write_frames(
                    str(path), size, fps=fps, quality=8, macro_block_size=2, ffmpeg_log_level="error"
                )
                writer.send(None)
            writer.send(frame)
        _require_some(writer)
    finally:
        if writer is not None:
            writer.close()


def _require_some(frames: object) -> None:
    if not frames:
        raise ValueError("there are no pictures to write")


def _picture(env: PandaEnv) -> NDArray[np.uint8]:
    picture = env.render()
    assert picture is not None
    return picture


def _policy(path: Path | None, env: NamedEnv) -> Callable[[], Callable[[Any], Any]]:
    if path is None:
        env.expert()
        return env.expert
    from manyhands.training.evaluation import policy_for

    policy = policy_for(path, env.spec())
    return lambda: policy.act
