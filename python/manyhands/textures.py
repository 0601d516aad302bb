"""Image files as textures."""

import warnings
from os import PathLike

import numpy as np

from manyhands._core.render import Texture
from manyhands.extras import pip_install

# What decodes inside this process; Pillow would hand others to programs such as Ghostscript.
FORMATS = ("PNG", "JPEG", "BMP", "GIF", "TIFF", "WEBP", "TGA", "PPM", "DDS")
_MOST = 4096  # pixels along a side, of a texture


def load_texture(path: str | PathLike[str], repeat: float | tuple[float, float] = 1) -> Texture:
    """The image of a file: PNG, JPEG, BMP, GIF, TIFF, WebP, TGA, PPM or DDS; what is see-through there is white.

    repeat: how often it lies where it else lies once (see `Texture`). Raises FileNotFoundError, ValueError on what is
    no such image, is damaged, or has more than 4096 pixels along a side, ModuleNotFoundError without Pillow.
    """
    try:
        from PIL import Image, UnidentifiedImageError
    except ModuleNotFoundError as reason:
        raise ModuleNotFoundError(f"images are read by Pillow: {pip_install('pillow')}", name=reason.name) from reason
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            image = Image.open(path, formats=FORMATS)
        with image:
            if max(image.size) > _MOST:  # before its pixels take memory
                width, height = image.size
                raise ValueError(
                    f"{path}: an image of {width} x {height} pixels; expected at most {_MOST} along a side"
                )
            whole = image.convert("RGBA")
    except (UnidentifiedImageError, Image.DecompressionBombError) as reason:
        raise ValueError(f"{path} is no image that can be read; formats are {', '.join(FORMATS)}") from reason
    except (FileNotFoundError, ValueError):
        raise
    except Exception as reason:  # decoders raise errors of many kinds
        raise ValueError(f"{path} is a damaged image: {reason}") from reason
    white = Image.new("RGBA", whole.size, "white")
    return Texture(np.asarray(Image.alpha_composite(white, whole).convert("RGB")), repeat)


def texture_or_warning(path: str) -> Texture | None:
    """The image that a model's file names for a geom; where it cannot be shown, a warning says why."""
    try:
        return load_texture(path)
    except Exception as reason:  # decoders raise errors of many kinds; a model is more than its looks
        warnings.warn(f"a texture is not shown: {reason}", stacklevel=2)
        return None
