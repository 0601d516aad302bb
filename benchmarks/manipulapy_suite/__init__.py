"""ManipulaPy's own tests on our modules: `python -m benchmarks.manipulapy_suite`."""

OUTCOMES = "MANIPULAPY_SUITE_OUTCOMES"
"""The environment variable that names the file for {test: outcome}."""
