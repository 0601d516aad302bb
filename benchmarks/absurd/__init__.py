"""Thousands of scenes without reason, from a seed: the engine bounds the energy of each, or names its error."""
