"""The robots of the project's own making, their generator, and what draws them."""
