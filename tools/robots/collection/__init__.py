"""Arms, grippers and furniture of the project's own, of the usual kinds: primitive shapes, masses from materials."""
