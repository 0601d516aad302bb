"""Trained policies that ship with the package: an ONNX file and a card for each id."""

from manyhands.policies.card import Card
from manyhands.policies.policy import Policy, policy, policy_ids

__all__ = ["Card", "Policy", "policy", "policy_ids"]
