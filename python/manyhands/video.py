"""Episodes as MP4 and GIF files, and the command `manyhands record`; needs the extra `video`."""

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
from manyhands.extras import needs
from manyhands.files import replacing
from manyhands.interrupts import INTERRUPTED, Interrupts

EXAMPLES = """\
examples:
  manyhands record PandaPickAndPlace                          three episodes of the scripted expert, as MP4
  manyhands record PandaPush --out push.gif --episodes 1
  manyhands record PandaReach --policy runs/PandaReach-v3-...  of what was learned
  manyhands record PandaPush --robot arm6 --option render_yaw=90

Ctrl-C ends the video after the episode that is being filmed.
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
    """Writes the video; with the first interrupt it ends after the episode that is being filmed."""
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
    wanted = arguments.episodes
    seeds = range(arguments.seed, arguments.seed + wanted)
    console = Console(stderr=True)
    begun: list[int] = []
    with Interrupts() as interrupts:
        shown = track(
            _until(interrupts, seeds, begun), f"Filming {env.title}", total=wanted, console=console, transient=True,
            disable=not console.is_terminal,
        )  # fmt: skip
        write_video(episodes(filmed, act, shown, env.max_steps), out)
    n = len(begun)
    is_whole = n == wanted
    count = f"{n} {'episode' if n == 1 else 'episodes'}" if is_whole else f"stopped; {n} of {wanted} episodes"
    print(f"manyhands: {count} of {env.title} {'is' if n == 1 else 'are'} in {out}")
    return 0 if is_whole else INTERRUPTED


def _until(interrupts: Interrupts, seeds: Iterable[int], begun: list[int]) -> Iterator[int]:
    """At least one seed, and no other after an interrupt; `begun` tells which."""
    for seed in seeds:
        begun.append(seed)
        yield seed
        if interrupts.requested:
            return


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
    write = {".gif": _write_gif, ".mp4": _write_mp4}.get(path.suffix)
    if write is None:
        raise ValueError(f"{path} ends with {path.suffix!r}; expected .mp4 or .gif")
    with needs("video", "a video"), replacing(path) as temporary:
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
