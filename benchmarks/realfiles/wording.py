"""Messages so that alike ones count together."""

import re

NAMES = re.compile(r"'[^']*'|\"[^\"]*\"")
PLACE = re.compile(r"\S*/\S*")
NUMBER = re.compile(r"-?\d+(\.\d+)?(e[+-]?\d+)?")


def alike(message: str) -> str:
    """A message without what is a file's own: names, places and numbers."""
    return re.sub(r"\s+", " ", NUMBER.sub("#", NAMES.sub("'…'", PLACE.sub("", message)))).strip()
