"""Plans among obstacles: how long they take, how long they are, and that none collides."""
