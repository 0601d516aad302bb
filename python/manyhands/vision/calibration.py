"""A camera's numbers, from pictures of a chessboard (Zhang, 2000), through OpenCV; and such boards for worlds."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core.render import Texture
from manyhands.arguments import instance, listed, number, real_array, whole_number
from manyhands.vision.stereo import Lens, opencv

Array = NDArray[np.float64]

_PIXELS = 32  # of a square's side in the texture
_MARGIN = 1  # squares of white around
_NOISE = 0.05  # [pixels] by which corners are found wrong
_OPEN = 0.05  # of a focal length, that it may be wrong


class Chessboard:
    """A board with `columns` x `rows` corners between its squares, of `side` [m], white around. Its frame is at its
    middle, x along the columns' count, y along the rows', and z out of it. Raises ValueError unless one of both is odd
    and the other even: else it looks the same upside down."""

    def __init__(self, columns: int = 9, rows: int = 6, side: float = 0.03) -> None:
        whole_number("columns", columns, 3)
        whole_number("rows", rows, 3)
        length = number("side", side, above=0)
        if (columns + rows) % 2 == 0:
            raise ValueError(f"a board of {columns} x {rows} corners looks the same upside down; make one of them odd")
        self.columns, self.rows, self.side = columns, rows, length

    @property
    def size(self) -> tuple[float, float]:
        """Along x and y [m]."""
        x, y = (count + 1 + 2 * _MARGIN for count in (self.columns, self.rows))
        return x * self.side, y * self.side

    @property
    def corners(self) -> Array:
        """(columns rows, 3) in the board's frame [m], row by row from its upper left, where y is largest."""
        x = (np.arange(self.columns) - (self.columns - 1) / 2) * self.side
        y = ((self.rows - 1) / 2 - np.arange(self.rows)) * self.side
        columns, rows = np.meshgrid(x, y)
        return np.array([columns, rows, np.zeros_like(rows)], np.float64).reshape(3, -1).T.copy()

    def texture(self) -> Texture:
        """For the upper side of a box of half extents (size[0] / 2, size[1] / 2, anything)."""
        squares = np.full((self.rows + 1 + 2 * _MARGIN, self.columns + 1 + 2 * _MARGIN), 255, np.uint8)
        inside = squares[_MARGIN:-_MARGIN, _MARGIN:-_MARGIN]
        inside[(np.add.outer(np.arange(self.rows + 1), np.arange(self.columns + 1)) % 2) == 0] = 0
        return Texture(np.repeat(squares.repeat(_PIXELS, 0).repeat(_PIXELS, 1)[..., None], 3, axis=2))

    def find(self, picture: ArrayLike) -> Array | None:
        """Where the corners are in a picture (columns rows, 2) [pixels], in the order of `corners`; None if the board
        is not seen whole."""
        cv2 = opencv()
        grey = _grey(picture)
        found, corners = cv2.findChessboardCorners(grey, (self.columns, self.rows))
        if not found:
            return None
        end = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_MAX_ITER, 50, 1e-4)
        at = cv2.cornerSubPix(grey, corners, (5, 5), (-1, -1), end).reshape(self.rows, self.columns, 2)
        outer = at[0, 0] + 0.5 * (at[0, 0] - at[1, 1])  # of the first square: black, unless the board is upside down
        inner = 0.5 * (at[0, 0] + at[0, 1]) + 0.5 * (at[0, 0] - at[1, 0])  # of its white neighbour
        height, width = grey.shape
        (x0, y0), (x1, y1) = (np.clip(np.round(p), 0, (width - 1, height - 1)).astype(int) for p in (outer, inner))
        if grey[y0, x0] > grey[y1, x1]:
            at = at[::-1, ::-1]
        return at.reshape(-1, 2).astype(np.float64) + 0.5


class Calibration(NamedTuple):
    """A camera's numbers."""

    lens: Lens
    """its K and distortion; X is where the board was in the first picture's stead: the camera's pose in the board"""
    X: Array
    """(pictures, 4, 4) poses of the camera in the board's frame"""
    error: float
    """root mean square of what is left at the corners [pixels]"""


def calibrate(board: Chessboard, pictures: Sequence[ArrayLike]) -> Calibration:
    """K, distortion and poses from pictures of one size in which a board is seen from many sides, three or more.
    Raises ValueError where that is not so, and where the board is tilted too little between them: from straight ahead,
    a far board through a long lens looks as a near one does through a short one."""
    cv2 = opencv()
    instance("board", board, Chessboard)
    given: list[Any] = listed("pictures", pictures, object)
    found = [board.find(picture) for picture in given]
    seen = [np.asarray(at - 0.5, np.float32)[:, None] for at in found if at is not None]
    if len(seen) < 3:
        raise ValueError(f"the board is seen whole in {len(seen)} of {len(found)} pictures; expected 3 or more")
    sizes = {np.shape(picture)[:2] for picture in given}
    if len(sizes) > 1:
        raise ValueError(f"the pictures have shapes {sorted(sizes)}; expected one size")
    height, width = sizes.pop()
    if _left_open(board, [at for at in found if at is not None], width, height) > _OPEN:
        raise ValueError(
            f"the {len(seen)} pictures leave the focal length open: the board is turned too little from one to the "
            "next; tilt it by 20 to 45 degrees, in each picture about another axis"
        )
    places = board.corners.astype(np.float32)[:, None]
    # The third radial term is left at 0: corners that do not reach the picture's edge leave it open.
    error, K, distortion, turns, shifts = cv2.calibrateCamera(
        [places] * len(seen), seen, (width, height), None, None, flags=cv2.CALIB_FIX_K3
    )
    poses = np.array([_pose(cv2.Rodrigues(turn)[0], shift) for turn, shift in zip(turns, shifts, strict=True)])
    return Calibration(Lens.of_opencv((width, height), K, poses[0], distortion.ravel()), poses, float(error))


def _left_open(board: Chessboard, seen: list[Array], width: int, height: int) -> float:
    """By about which share of it the focal length is wrong if corners are wrong by _NOISE. Each picture gives two
    linear equations of what K is (Zhang, 2000, section 3.1); where they have more than one solution, the second least
    singular value vanishes."""
    cv2 = opencv()
    centred = np.array([[2 / width, 0, -1], [0, 2 / width, -height / width], [0, 0, 1]])
    rows: list[Array] = []
    for at in seen:
        H = centred @ cv2.findHomography(board.corners[:, :2], at)[0]
        a, b = H[:, :2].T / np.sqrt(np.prod(np.linalg.norm(H[:, :2], axis=0)))
        rows += [_products(a, b), _products(a, a) - _products(b, b)]
    extent = np.median([np.linalg.norm(np.ptp(at, axis=0)) for at in seen])
    second = np.linalg.svd(np.array(rows), compute_uv=False)[4] / np.sqrt(len(rows))
    return float(_NOISE / extent / max(second, 1e-12))


def _products(a: Array, b: Array) -> Array:
    """What a symmetric matrix B (6 numbers) is multiplied by in aᵀ B b."""
    (a1, a2, a3), (b1, b2, b3) = a, b
    return np.array([a1 * b1, a1 * b2 + a2 * b1, a2 * b2, a3 * b1 + a1 * b3, a3 * b2 + a2 * b3, a3 * b3])


def _pose(R: Array, p: Array) -> Array:
    """Of the camera in the board, from the board's in the camera."""
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = R.T, -R.T @ p.ravel()
    return X


def _grey(picture: ArrayLike) -> NDArray[np.uint8]:
    given = real_array("picture", picture)
    if given.dtype != np.uint8 or given.ndim not in (2, 3):
        raise ValueError(f"the picture is {given.dtype} of shape {given.shape}; expected uint8 of (height, width, 3)")
    return given if given.ndim == 2 else np.ascontiguousarray(given[..., :3].mean(-1).round().astype(np.uint8))
