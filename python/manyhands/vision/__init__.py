"""Pictures and what they show: two cameras that see depth, networks that detect things, boards that calibrate cameras.

Pictures are uint8 arrays (height, width, 3), as `Picture.colour` is, or of any other camera. A camera's axes are x to
the right, y down, z ahead; pixels are counted from the picture's upper left corner, where the first pixel's centre is
(0.5, 0.5). Stereo and calibration need OpenCV, networks onnxruntime: `pip install manyhands[vision]`.
"""

from manyhands.vision.calibration import Calibration, Chessboard, calibrate
from manyhands.vision.detection import Detections, Detector, things
from manyhands.vision.stereo import Lens, StereoRig

__all__ = [
    "Calibration",
    "Chessboard",
    "Detections",
    "Detector",
    "Lens",
    "StereoRig",
    "calibrate",
    "things",
]
