"""What programs ask of graphics cards: there are none here, and none are needed."""


def check_cuda_availability() -> bool:
    """False: everything runs in the lanes of the processor."""
    return False


CUDA_AVAILABLE = False
