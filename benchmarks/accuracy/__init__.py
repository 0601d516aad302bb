"""How right the physics is: published and own cases, several engines, speed against accuracy."""
