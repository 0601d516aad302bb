"""Random things on a floor, picked up and put into a bin by planning: `python -m benchmarks.pick_and_place`."""
