"""The tab of an environment: who acts in it, and how to act by hand."""

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from manyhands._core.envs import expert_ids
from manyhands.env_names import versioned
from manyhands.experts import Expert
from manyhands.viewer.environments import EnvSource, Outcome
from manyhands.viewer.episodes import EpisodeWriter
from manyhands.viewer.host import Host
from manyhands.viewer.pad import add_pad, hand_moves, joint_moves
from manyhands.viewer.player import Frame

_HELD_FOR = 0.15  # [s] that a key acts: longer than a keyboard takes to repeat it
_HANDS, _SLIDERS, _STILL, _RANDOM = "keys and buttons", "sliders and gizmo", "nobody", "random actions"
_EXPERT = "scripted expert"
_RED = (188, 62, 62)
_BY_HAND = (_HANDS, _SLIDERS)  # they take the time they want

Act = Callable[[Any], Any]
"""Gives an action for an observation."""


class TeleopPanel:
    """Turns keys and buttons into actions."""

    def __init__(self, viewer: Host, tabs: viser.GuiTabGroupHandle) -> None:
        self._viewer = viewer
        assert isinstance(viewer.source, EnvSource)
        self._source = viewer.source
        self._until: dict[tuple[int, float], float] = {}
        self._grip = 0.0
        self._writer = EpisodeWriter(self._source)
        gui = viewer.server.gui
        with tabs.add_tab("Drive"):
            self._actors = self._usual()
            hands = [_HANDS, *((_SLIDERS,) if self._source.joints is not None else ())]
            first = _EXPERT if _EXPERT in self._actors else _HANDS
            self._actor: Any = gui.add_dropdown("Who acts", [*hands, *self._actors], initial_value=first)
            self._actor.on_update(lambda _: self._choose())
            self._status = gui.add_markdown("")
            ends = gui.add_checkbox(
                "Episodes end", True,
                hint="With success, and after as many steps as the environment allows unless somebody drives by hand; "
                "then another one begins",
            )  # fmt: skip
            ends.on_update(lambda _: setattr(self._source, "ends", ends.value))
            with gui.add_folder("By hand"):
                self._add_buttons(gui)
                self._strength = gui.add_slider("Strength", 0.05, 1.0, 0.05, 0.6, hint="Of an action by key or button")
                self._add_grip(gui)
            self._keep = gui.add_button(
                "Record episodes", icon=viser.Icon.PLAYER_RECORD, color=_RED, hint="Every step from now on (key B)"
            )
            self._keep.on_click(lambda _: self._record())
            gui.add_command("Record episodes", hotkey="B").on_trigger(lambda _: self._record())
        self._source.on_reset.append(lambda _: self._renew())
        self._choose()

    # ---- who acts ------------------------------------------------------------------------------------------------

    def choose_sliders(self) -> None:
        """Leaves the joints to sliders and the gizmo."""
        if self._actor.value != _SLIDERS:
            self._actor.value = _SLIDERS

    def add(self, name: str, act: Act) -> None:
        """Offers somebody who acts, and lets them."""
        self._actors[name] = lambda: act
        self._actor.options = (*dict.fromkeys((*self._actor.options, name)),)
        if self._actor.value == name:
            self._choose()
        else:
            self._actor.value = name

    def _usual(self) -> dict[str, Callable[[], Act]]:
        """What makes those who act without hands, anew for each episode."""
        space, still = self._source.env.action_space, np.zeros(self._source.action_size, np.float32)
        actors: dict[str, Callable[[], Act]] = {
            _STILL: lambda: lambda _: still,
            _RANDOM: lambda: lambda _: space.sample(),
        }
        name = self._source.env_id
        if self._source.control_type == "ee" and versioned(name) in expert_ids():
            actors[_EXPERT] = lambda: Expert(name)
        return actors

    def _choose(self) -> None:
        actor = self._actor.value

        def choose() -> None:
            by_hand = actor in _BY_HAND
            self._source.limit = None if by_hand else self._source.max_steps
            if not (by_hand or self._viewer.player.is_driven) and self._source.outcome.length:
                self._source.reset()  # an episode that somebody else began would count as theirs
            self._source.count_anew()
            self._renew()
            if actor != _SLIDERS and self._source.joints is not None:
                self._source.joints.forget()

        self._viewer.player.do(choose)

    def _renew(self) -> None:
        """Who acts begins anew, as with each episode: experts remember what they did."""
        actor = self._actor.value
        if actor in _BY_HAND:
            self._source.policy = self._by_hand if actor == _HANDS else None
        else:
            act = self._actors[actor]()
            self._source.policy = lambda outcome: act(outcome.observation)

    # ---- by hand -------------------------------------------------------------------------------------------------

    def press(self, axis: int, sign: float) -> None:
        """A key or button is held: it acts a little longer than the next such call takes to come."""
        self._until[axis, sign] = time.perf_counter() + _HELD_FOR
        self._take_over()

    def _take_over(self) -> None:
        """Hands act from now on, and time passes."""
        if self._actor.value != _HANDS:
            self._actor.value = _HANDS
        if not self._viewer.player.playing and not self._viewer.player.problem:
            self._viewer.play()

    def _by_hand(self, _: Outcome) -> NDArray[np.float32]:
        action = np.zeros(self._source.action_size, np.float32)
        now = time.perf_counter()
        for (axis, sign), until in list(self._until.items()):
            if until > now:
                action[axis] += sign * self._strength.value
        if self._has_grip:
            action[-1] = self._grip
        return action

    def _add_buttons(self, gui: viser.GuiApi) -> None:
        self._has_grip = self._source.has_grip
        size = self._source.action_size - self._has_grip
        rows = joint_moves(size) if self._source.control_type.startswith("joint") else hand_moves(size)
        add_pad(gui, rows, self.press)

    def _add_grip(self, gui: viser.GuiApi) -> None:
        if not self._has_grip:
            return
        button = gui.add_button("Open or close the gripper  (G)")
        button.on_click(lambda _: self._toggle_grip())
        gui.add_command("Open or close the gripper", hotkey="G").on_trigger(lambda _: self._toggle_grip())

    def _toggle_grip(self) -> None:
        self._grip = -1.0 if self._grip > 0 else 1.0
        self._take_over()

    # ---- episodes ------------------------------------------------------------------------------------------------

    def _record(self) -> None:
        def switch() -> None:
            if self._writer.is_writing:
                self._writer.stop()
            else:
                self._writer.start()
            self._keep.label = "Stop recording" if self._writer.is_writing else "Record episodes"

        self._viewer.player.do(switch)

    def refresh(self, _: Frame) -> None:
        """Says how the episode goes, and how those before it went."""
        is_driven = self._viewer.player.is_driven
        text = "A loop of the program's acts." if is_driven else _story(self._source.outcome)
        if self._writer.where is not None:
            text += f"\n\n{'Recording to' if self._writer.is_writing else 'Recorded:'} `{self._writer.where}`"
        if self._status.content != text:
            self._status.content = text


def _story(outcome: Outcome) -> str:
    state = "**Reached!**" if outcome.success else "**Not reached.**" if outcome.ended else "on the way"
    text = f"{state} &nbsp; step {outcome.length}, return {outcome.total:.1f}"
    if outcome.episodes:
        rate = outcome.successes / outcome.episodes
        text += f"\n\nEpisodes: {outcome.episodes}, of which {outcome.successes} reached the goal ({rate:.0%})"
    return text
