"""Pictures as MP4 and GIF files; needs the extra `video`."""

import subprocess
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import suppress
from itertools import chain, islice
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from manyhands.extras import needs
from manyhands.files import replacing


def write_video(pictures: Iterable[NDArray[np.uint8]], path: str | Path, fps: float = 25) -> Path:
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


def captioned(pictures: Iterable[NDArray[np.uint8]], text: str) -> Iterator[NDArray[np.uint8]]:
    """The same pictures with a text in the lower left corner, as high as a twentieth of the picture."""
    from PIL import Image, ImageDraw, ImageFont

    for picture in pictures:
        if not text:
            yield picture
            continue
        size = max(picture.shape[0] // 20, 10)
        image = Image.fromarray(picture)
        place = (size // 2, picture.shape[0] - 3 * size // 2)
        font = ImageFont.load_default(size)
        ImageDraw.Draw(image).text(place, text, (240, 243, 246), font, stroke_width=1, stroke_fill=(30, 34, 40))
        yield np.asarray(image)


def _write_gif(pictures: Iterable[NDArray[np.uint8]], path: Path, fps: float) -> None:
    from PIL import Image

    frames = [Image.fromarray(picture).convert("P", palette=Image.Palette.ADAPTIVE) for picture in pictures]
    _require_some(frames)
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=1000 / fps, loop=0)


def _write_mp4(pictures: Iterable[NDArray[np.uint8]], path: Path, fps: float) -> None:
    """Raises OSError unless ffmpeg has written all pictures."""
    import imageio_ffmpeg

    rest = iter(pictures)
    first = list(islice(rest, 1))
    _require_some(first)
    height, width = (side // 2 * 2 for side in first[0].shape[:2])  # H.264 wants even sides
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(fps), "-i", "-"]
    h264 = ["-c:v", "libx264", "-crf", "10", "-pix_fmt", "yuv420p"]
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-v", "error", *raw, *h264, str(path)]
    with tempfile.TemporaryFile() as said:
        # In a session of its own: Ctrl-C is told to this program alone.
        ffmpeg = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=said, start_new_session=True)
        assert ffmpeg.stdin is not None
        try:
            for picture in chain(first, rest):
                if not _take(ffmpeg.stdin, np.ascontiguousarray(picture[:height, :width])):
                    break
        except BaseException:
            ffmpeg.kill()
            raise
        finally:
            with suppress(BrokenPipeError):  # the exit status tells more
                ffmpeg.stdin.close()
            ffmpeg.wait()
        if ffmpeg.returncode:
            said.seek(0)
            lines = said.read().decode(errors="replace").split("\n")
            reason = next((line for line in reversed(lines) if line), f"ffmpeg ended with {ffmpeg.returncode}")
            raise OSError(f"the video cannot be written: {reason}")


def _take(encoder: IO[bytes], picture: NDArray[np.uint8]) -> bool:
    """Gives a picture to an encoder; False if it has ended."""
    try:
        encoder.write(picture.data)
    except BrokenPipeError:
        return False
    return True


def _require_some(frames: object) -> None:
    if not frames:
        raise ValueError("there are no pictures to write")
