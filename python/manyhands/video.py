"""Pictures as MP4 and GIF files; needs the extra `video`."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from manyhands.extras import needs
from manyhands.files import replacing


def write_video(pictures: Iterable[NDArray[np.uint8]], path: str | Path, fps: int = 25) -> Path:
    """Writes pictures (h, w, 3) as MP4 or GIF, as the name of the file ends. A file that was there before stays
    as it is unless all goes well.

    Raises ValueError on another ending or without pictures, FileNotFoundError without the file's folder, OSError where
    a disk is full, ModuleNotFoundError without the extra `video`.
    """
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
