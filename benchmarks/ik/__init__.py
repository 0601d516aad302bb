"""Inverse kinematics of random reachable poses: how many are solved, how fast, and by other programs."""
