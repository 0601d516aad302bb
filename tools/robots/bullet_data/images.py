"""The pictures: PNG without compression, so that the bytes do not depend on the machine's zlib, and a plain JPEG."""

from __future__ import annotations

import struct
import zlib

import numpy as np
import numpy.typing as npt

from robots.bullet_data.common import Files

Image = npt.NDArray[np.uint8]
BLUE, PALE, WHITE = (118, 148, 178), (205, 217, 228), (245, 247, 249)


def _chunk(tag: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + tag + data + struct.pack(">I", zlib.crc32(tag + data))


def png(image: Image, palette: list[tuple[int, int, int]] | None = None) -> bytes:
    """Grey (h, w), or numbers of at most four colours (h, w) with their palette."""
    height, width = image.shape
    depth, kind = (2, 3) if palette else (8, 0)
    if palette:
        pixels = image.reshape(height, width // 4, 4) << np.array([6, 4, 2, 0], np.uint8)
        image = pixels.sum(axis=-1).astype(np.uint8)
    rows = b"".join(b"\0" + row.tobytes() for row in image)
    chunks = [_chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, 0))]
    if palette:
        chunks.append(_chunk(b"PLTE", bytes(v for rgb in palette for v in rgb)))
    chunks += [_chunk(b"IDAT", zlib.compress(rows, 0)), _chunk(b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


def checker(size: int, checks: int) -> Image:
    """Squares numbered 0 and 1 in turn, 0 at the upper left."""
    at = np.arange(size) * checks // size
    return ((at[:, None] + at[None, :]) % 2).astype(np.uint8)


def _tiles() -> Image:
    """Checks of two kinds with a frame of a third, for boxes."""
    image = checker(128, 8)
    edge = 4
    image[:edge], image[-edge:], image[:, :edge], image[:, -edge:] = 2, 2, 2, 2
    return image


def _ball() -> Image:
    """Longitude and latitude of a ball in gores, with two bands."""
    image = checker(128, 2) * 0
    image[:, (np.arange(128) // 16) % 2 == 1] = 1
    image[12:20], image[-20:-12] = 2, 2
    return image


def _stone() -> Image:
    """Wandering veins of a shade deeper, from sums of triangle waves."""
    y, x = np.mgrid[0:128, 0:128] / 128

    def wave(t: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        return np.abs((t % 1.0) * 2 - 1)

    bent = x + y + 0.18 * wave(3 * y + x) + 0.10 * wave(5 * x - 2 * y) + 0.05 * wave(11 * y + 7 * x)
    vein = wave(2 * bent)
    return np.where(vein < 0.05, 2, np.where(vein < 0.16, 1, 0)).astype(np.uint8)


def heights(size: int = 128) -> Image:
    """Rolling hills that meet at the edges, of products of parabolas that stand in for sines."""
    t = np.arange(size) / size

    def hump(periods: int, shift: float) -> npt.NDArray[np.float64]:
        u = (periods * t + shift) % 1.0
        return 4 * u * (1 - u)

    total = 0.55 * hump(1, 0.1)[:, None] * hump(1, 0.35)[None, :]
    total = total + 0.30 * hump(2, 0.4)[:, None] * hump(3, 0.2)[None, :] + 0.15 * hump(5, 0.7)[:, None] * hump(4, 0.0)
    return np.round(255 * total / total.max()).astype(np.uint8)


# The tables that the JPEG standard gives as examples: luminance's DC codes, and of the AC codes the end of a block.
_DC_LENGTHS = [0, 1, 5, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0]


def grey_jpeg(blocks: Image) -> bytes:
    """JPEG of 8 x 8 pixels for each grey value of `blocks`."""
    height, width = blocks.shape
    codes, code = [], 0
    for length, count in enumerate(_DC_LENGTHS, 1):
        for _ in range(count):
            codes.append(f"{code:0{length}b}")
            code += 1
        code <<= 1
    bits, before = [], 0
    for value in blocks.ravel():
        now = int(value) - 128
        step, before = now - before, now
        size = abs(step).bit_length()
        bits.append(codes[size])
        if size:
            bits.append(f"{step if step > 0 else step + (1 << size) - 1:0{size}b}")
        bits.append("0")  # the only AC code: end of block
    text = "".join(bits)
    text += "1" * (-len(text) % 8)
    scan = bytes(int(text[i : i + 8], 2) for i in range(0, len(text), 8)).replace(b"\xff", b"\xff\0")

    def segment(tag: int, data: bytes) -> bytes:
        return struct.pack(">BBH", 0xFF, tag, len(data) + 2) + data

    header = segment(0xE0, b"JFIF\0\1\1\0\0\1\0\1\0\0") + segment(0xDB, b"\0" + bytes([8] + [1] * 63))
    frame = segment(0xC0, struct.pack(">BHHBBBB", 8, 8 * height, 8 * width, 1, 1, 0x11, 0))
    tables = segment(0xC4, b"\0" + bytes(_DC_LENGTHS) + bytes(range(12)))
    tables += segment(0xC4, b"\x10" + bytes([1] + [0] * 15) + b"\0")
    return b"\xff\xd8" + header + frame + tables + segment(0xDA, bytes([1, 1, 0, 0, 63, 0])) + scan + b"\xff\xd9"


def files() -> Files:
    three = [PALE, BLUE, WHITE]
    grid = np.where(checker(32, 16) == 0, 235, 150).astype(np.uint8)
    return {
        "checker_blue.png": png(checker(64, 2), [WHITE, BLUE]),
        "checker_grid.jpg": grey_jpeg(grid),
        "tex256.png": png(_tiles(), [(226, 196, 150), (203, 166, 115), (110, 80, 54)]),
        "uvmap.png": png(_tiles(), [(240, 200, 90), (70, 140, 170), (40, 50, 60)]),
        "cube.png": png(_tiles(), [*three]),
        "ball.png": png(_ball(), [(238, 240, 243), (60, 120, 180), (250, 120, 40)]),
        "marble.png": png(_stone(), [(240, 240, 238), (205, 207, 208), (150, 155, 160)]),
        "heightmaps/wm_height_out.png": png(heights()),
        "heightmaps/gimp_overlay_out.png": png(_stone(), [(120, 150, 90), (150, 140, 100), (110, 100, 80)]),
    }
