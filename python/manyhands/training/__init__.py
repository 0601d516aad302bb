"""Training runs: the C++ trainer with a progress bar, checkpoints, and the files a run leaves."""
