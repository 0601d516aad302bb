"""Episodes as MP4 and GIF files, and the command `manyhands record`; needs `pip install 'manyhands[video]'`."""

import argparse
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from manyhands._core.envs import make_env_batch, max_episode_steps
from manyhands.envs.experts import Expert
from manyhands.envs.registration import variant_of
from manyhands.envs.single import PandaEnv
from manyhands.envs.spaces import RENDER_FPS

EXAMPLES = """\
examples:
  manyhands record PandaPickAndPlace                          three episodes of the scripted expert, as MP4
  manyhands record PandaPush --out push.gif --episodes 1
  manyhands record PandaReach --policy runs/PandaReach-v3-...  of what was learned
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


def run(arguments: argparse.Namespace) -> int:
    """Writes the video."""
    from manyhands.training.settings import resolve_env_id

    name = resolve_env_id(arguments.env)
    out = arguments.out or Path(f"{name}.mp4")
    if arguments.episodes < 1:
        raise ValueError(f"--episodes is {arguments.episodes}; expected 1 or more")
    act = _policy(arguments.policy, name)
    width, height = arguments.size
    env = PandaEnv(**variant_of(name), render_mode="rgb_array", render_width=width, render_height=height)
    seeds = range(arguments.seed, arguments.seed + arguments.episodes)
    write_video(episodes(env, act, seeds, max_episode_steps(name)), out)
    print(f"manyhands: {arguments.episodes} episodes of {name} are in {out}")
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
    if path.suffix == ".gif":
        from PIL import Image

        first, *others = (Image.fromarray(picture).convert("P", palette=Image.Palette.ADAPTIVE) for picture in pictures)
        first.save(path, save_all=True, append_images=others, duration=1000 / fps, loop=0)
        return path
    if path.suffix != ".mp4":
        raise ValueError(f"{path} ends with {path.suffix!r}; expected .mp4 or .gif")
    import imageio_ffmpeg

    writer: Any = None
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
    if writer is None:
        raise ValueError("there are no pictures to write")
    writer.close()
    return path


def _picture(env: PandaEnv) -> NDArray[np.uint8]:
    picture = env.render()
    assert picture is not None
    return picture


def _policy(path: Path | None, name: str) -> Callable[[], Callable[[Any], Any]]:
    if path is None:
        return lambda: Expert(name)
    from manyhands.training.evaluation import PolicyFile
    from manyhands.training.run_folder import RunFolder

    policy = PolicyFile(RunFolder(path).policy if path.is_dir() else path)
    policy.require_fit(make_env_batch(name, 1).spec)

    def act(observation: Any) -> Any:
        return policy({key: observation[key][None] for key in policy.inputs})[0]

    return lambda: act
