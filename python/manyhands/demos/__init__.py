"""Demonstrations: episodes of experts and policies, and datasets of them."""
