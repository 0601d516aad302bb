"""Scripted tasks of other packages, recorded in MuJoCo and replayed in both programs."""
