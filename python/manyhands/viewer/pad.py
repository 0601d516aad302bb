"""Buttons that drive a hand or joints: each is held, has a key, and lies on the page as its key on the keyboard."""

from collections.abc import Callable
from typing import NamedTuple

import viser

_RATE = 20.0  # [Hz] at which a button that is held is heard of


class Move(NamedTuple):
    """A direction of an action."""

    key: str
    label: str
    axis: int
    sign: float
    icon: viser.IconName | None = None


# The camera has W A S D and the arrows.
_MOVES = (
    (
        Move("U", "Up", 2, 1.0, viser.Icon.ARROW_BAR_TO_UP),
        Move("I", "Forward", 0, 1.0, viser.Icon.ARROW_UP),
        Move("O", "Down", 2, -1.0, viser.Icon.ARROW_BAR_TO_DOWN),
    ),
    (
        Move("J", "Left", 1, 1.0, viser.Icon.ARROW_LEFT),
        Move("K", "Back", 0, -1.0, viser.Icon.ARROW_DOWN),
        Move("L", "Right", 1, -1.0, viser.Icon.ARROW_RIGHT),
    ),
)
_TURNS = (
    (Move("1", "Roll +", 3, 1.0), Move("3", "Pitch +", 4, 1.0), Move("5", "Yaw +", 5, 1.0)),
    (Move("2", "Roll -", 3, -1.0), Move("4", "Pitch -", 4, -1.0), Move("6", "Yaw -", 5, -1.0)),
)
_JOINT_KEYS = (("I", "K"), ("J", "L"), ("U", "O"), ("1", "2"), ("3", "4"), ("5", "6"), ("7", "8"), ("9", "0"))

# viser lays one control under another; a folder that begins with our mark is a grid. Whatever is no button, and what
# comes last, takes a whole row.
_STYLE = """<style>
div:has(> div > .mh-pad) { display: grid; grid-template-columns: repeat(COLUMNS, minmax(0, 1fr)); gap: 0.4em;
  padding: 0.6em !important }
div:has(> div > .mh-pad) > * { margin: 0 !important; padding: 0 !important }
div:has(> div > .mh-pad) > :last-child, div:has(> div > .mh-pad) > :has(input) { grid-column: 1 / -1 }
div:has(> .mh-pad) { display: none }
div:has(> div > .mh-pad) button { width: 100%; --button-padding-x: 0.3em !important; --button-bg: #eef2f5 !important;
  --button-hover: #dde5ec !important; --button-color: #24323e !important; border: 1px solid #cfd8e0 }
div:has(> div > .mh-pad) button:active { --button-bg: #9fc4de !important; --button-hover: #9fc4de !important }
</style><span class="mh-pad"></span>"""


def hand_moves(size: int) -> list[list[Move]]:
    """Rows of buttons for an action of so many numbers: where the hand goes and, beyond three, how it turns."""
    rows = [[move for move in row if move.axis < size] for row in (*_MOVES, *_TURNS)]
    return [row for row in rows if row]


def joint_moves(joints: int) -> list[list[Move]]:
    """A row of two buttons for each joint."""
    return [
        [Move(plus, f"Joint {joint + 1} +", joint, 1.0), Move(minus, f"Joint {joint + 1} -", joint, -1.0)]
        for joint, (plus, minus) in zip(range(joints), _JOINT_KEYS, strict=False)
    ]


def add_pad(gui: viser.GuiApi, rows: list[list[Move]], press: Callable[[int, float], None]) -> None:
    """Buttons and keys, at the beginning of a folder with a label; `press` hears of each over and over while it is
    held: axis and sign."""
    gui.add_html(_STYLE.replace("COLUMNS", str(len(rows[0]))))
    for move in (move for row in rows for move in row):
        button = gui.add_button(f"{move.label} ({move.key})", icon=move.icon, hint="Hold it, or its key")
        button.on_hold(callback_hz=_RATE)(lambda _, move=move: press(move.axis, move.sign))
        command = gui.add_command(move.label, hotkey=move.key)  # pyright: ignore[reportArgumentType]
        command.on_trigger(lambda _, move=move: press(move.axis, move.sign))
