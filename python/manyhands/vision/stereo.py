"""Depth from two cameras: rectification, and disparity by semi-global matching (Hirschmüller, 2008), through OpenCV."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core.render import Camera
from manyhands.arguments import finite_row, finite_rows, float_arrays, instance, real_array, whole, whole_number
from manyhands.extras import needs
from manyhands.rigid_motions import matrix, rigid_matrices

Array = NDArray[np.float64]

_ALIKE = np.pi / 4  # [rad]: two pictures that are turned by more hardly show the same
_DISTORTIONS = (4, 5, 8, 12, 14)  # how many numbers OpenCV takes
_CENTRE = np.array([[0, 0, 0.5], [0, 0, 0.5], [0, 0, 0]])  # of the first pixel, which is 0 in OpenCV


def opencv() -> Any:
    """The module cv2. Raises ModuleNotFoundError, which says how to install it."""
    with needs("vision", "vision"):
        import cv2
    return cv2


@dataclass(frozen=True)
class Lens:
    """How a camera sees, and where it is."""

    size: tuple[int, int]
    """width and height of its pictures [pixels]"""
    K: Array
    """(3, 3): focal lengths and principal point [pixels]"""
    X: Array
    """(4, 4) pose of its optical frame in the world"""
    distortion: Array = field(default_factory=lambda: np.zeros(5))
    """k1, k2, p1, p2, k3 and so on, as OpenCV counts them"""

    def __post_init__(self) -> None:
        if len(sides := finite_row("size", self.size)) != 2:
            raise ValueError(f"size is {self.size}; expected (width, height)")
        for name, pixels in zip(("width", "height"), sides.tolist(), strict=True):
            whole(name, pixels, 1)
        K = finite_rows("K", self.K, 3, 3)
        if K.shape != (3, 3) or not (K[0, 0] > 0 < K[1, 1]) or K[2].tolist() != [0, 0, 1]:
            raise ValueError(f"K is {K}; expected focal lengths above 0 on its diagonal, and 0 0 1 as its last row")
        if (X := rigid_matrices("X", self.X)).ndim != 2:
            raise ValueError(f"X has shape {X.shape}; expected (4, 4)")
        if (count := len(finite_row("distortion", self.distortion))) not in _DISTORTIONS:
            raise ValueError(f"distortion has {count} numbers; expected {', '.join(map(str, _DISTORTIONS))}")

    @classmethod
    def of(cls, camera: Camera) -> "Lens":
        """Of one of our cameras, a perspective one. Raises ValueError for one that is mounted on a frame."""
        if instance("camera", camera, Camera).frame:
            raise ValueError(f"the camera is mounted on '{camera.frame}'; give one that stands in the world")
        K = np.array([[camera.fx, 0, camera.cx], [0, camera.fy, camera.cy], [0, 0, 1.0]])
        return cls((camera.width, camera.height), K, matrix(camera.position, camera.quaternion))

    @classmethod
    def of_opencv(cls, size: tuple[int, int], matrix: Array, X: Array, distortion: Array) -> "Lens":
        """The same with `opencv_matrix` in place of K."""
        return cls(size, finite_rows("matrix", matrix, 3, 3) + _CENTRE, X, distortion)

    @property
    def opencv_matrix(self) -> Array:
        """K where the first pixel's centre is 0."""
        return self.K - _CENTRE


class StereoRig:
    """Two cameras side by side, the left one first. Points nearer than what `disparities` of pixels can tell, which is
    focus times baseline over that number, are not seen. Raises ValueError unless they have pictures of one size, the
    second one stands to the right of the first, and both look the same way and are held alike, to 45 degrees.

    `focus` [pixels], `baseline` [m] and `Q` are of the rectified pictures, `maps` OpenCV's, which make them.

    disparities: how many pixels two pictures of a point may be apart, a multiple of 16 below their width. block: the
    side of what is compared [pixels], odd.
    """

    def __init__(self, left: Lens | Camera, right: Lens | Camera, *, disparities: int = 64, block: int = 5) -> None:
        cv2 = opencv()
        self.left, self.right = (
            lens if isinstance(lens, Lens) else Lens.of(instance(name, lens, Camera, hint="or Lens"))
            for name, lens in (("left", left), ("right", right))
        )
        if self.left.size != self.right.size:
            raise ValueError(f"the pictures are {self.left.size} and {self.right.size} pixels; expected one size")
        width = self.left.size[0]
        if whole_number("disparities", disparities, 16) % 16 or disparities >= width:
            raise ValueError(f"disparities is {disparities}; expected a multiple of 16 below the width, {width}")
        if whole_number("block", block, 1) % 2 == 0:
            raise ValueError(f"block is {block}; expected an odd number")
        X_RL = np.linalg.inv(self.right.X) @ self.left.X
        turned = np.arccos(np.clip((np.trace(X_RL[:3, :3]) - 1) / 2, -1, 1))
        if turned > _ALIKE:
            raise ValueError(f"the cameras are turned by {np.degrees(turned):.0f} degrees; expected 45 at most")
        given = [part for lens in (self.left, self.right) for part in (lens.opencv_matrix, lens.distortion)]
        R_left, R_right, P_left, P_right, self.Q, *_ = cv2.stereoRectify(
            *given, self.left.size, X_RL[:3, :3], X_RL[:3, 3:], flags=cv2.CALIB_ZERO_DISPARITY, alpha=0
        )
        if not -P_right[0, 3] > abs(P_right[1, 3]):
            raise ValueError("the second camera does not stand to the right of the first, which looks where it looks")
        self.focus, self.baseline = float(P_left[0, 0]), float(-P_right[0, 3] / P_right[0, 0])
        self.X_rectified: Array = self.left.X.copy()
        """(4, 4) pose of the left camera, turned as its rectified picture shows"""
        self.X_rectified[:3, :3] = self.left.X[:3, :3] @ R_left.T
        self.maps: list[tuple[Any, Any]] = [
            cv2.initUndistortRectifyMap(K, distortion, R, P, self.left.size, cv2.CV_32FC1)
            for K, distortion, R, P in zip(given[::2], given[1::2], (R_left, R_right), (P_left, P_right), strict=True)
        ]
        area = 3 * block * block  # of three colours
        self._matcher = cv2.StereoSGBM_create(
            minDisparity=0, numDisparities=disparities, blockSize=block, P1=8 * area, P2=32 * area, disp12MaxDiff=1,
            uniquenessRatio=10, speckleWindowSize=100, speckleRange=2, mode=cv2.STEREO_SGBM_MODE_HH,
        )  # fmt: skip

    def rectify(self, left: ArrayLike, right: ArrayLike) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
        """Both pictures turned so that a point has the same row in them, straight where lenses bent them."""
        cv2 = opencv()
        pictures = (self._picture("left", left), self._picture("right", right))
        turned = [
            cv2.remap(picture, *maps, cv2.INTER_LINEAR) for picture, maps in zip(pictures, self.maps, strict=True)
        ]
        return turned[0], turned[1]

    def disparity(self, left: ArrayLike, right: ArrayLike) -> NDArray[np.float32]:
        """By how many pixels rectified pictures are apart (height, width); NaN where nothing fits."""
        found = self._matcher.compute(self._picture("left", left), self._picture("right", right)) / np.float32(16)
        return np.where(found > 0, found, np.float32(np.nan)).astype(np.float32)

    def depth(self, disparity: ArrayLike) -> NDArray[np.float32]:
        """Along the rectified left camera's axis (height, width) [m]: focus times baseline over disparity."""
        return (self.focus * self.baseline / self._disparities(disparity)).astype(np.float32)

    def points(self, disparity: ArrayLike) -> Array:
        """(height, width, 3) in the world [m], NaN where there is no disparity."""
        cv2 = opencv()
        seen = cv2.reprojectImageTo3D(self._disparities(disparity), self.Q.astype(np.float32)).astype(np.float64)
        return seen @ self.X_rectified[:3, :3].T + self.X_rectified[:3, 3]

    def _disparities(self, given: ArrayLike) -> NDArray[np.float32]:
        """One for each pixel, above 0; NaN where there is none. Raises ValueError on anything else."""
        (apart,) = float_arrays(disparity=given)
        if apart.shape != self.left.size[::-1] or (apart <= 0).any():
            raise ValueError(f"disparity has shape {apart.shape}; expected {self.left.size[::-1]}, above 0 or NaN")
        return apart.astype(np.float32)

    def _picture(self, name: str, given: ArrayLike) -> NDArray[np.uint8]:
        picture = real_array(name, given)
        width, height = self.left.size
        if picture.dtype != np.uint8 or picture.shape not in ((height, width, 3), (height, width)):
            raise ValueError(
                f"{name} is {picture.dtype} of shape {picture.shape}; expected uint8 of ({height}, {width}, 3)"
            )
        return np.ascontiguousarray(picture)
