"""The tab with joints: sliders, the hand's gizmo, plans and the gripper."""

import time
from itertools import takewhile
from typing import Any

import numpy as np
import viser

from manyhands.measures import chain, hand_of
from manyhands.viewer.controls import SharedSlider
from manyhands.viewer.host import Host
from manyhands.viewer.joints import JointDrive, Knob
from manyhands.viewer.plan_panel import PlanPanel
from manyhands.viewer.player import Frame
from manyhands.viewer.teleop_panel import TeleopPanel

_DRAGGED_FOR = 1.0  # [s] for which the gizmo belongs to the one who moved it


def labels(joints: list[str]) -> list[str]:
    """Names of joints as words, without the robot's name, which all have before their own."""
    own = [name.rpartition("/")[2] for name in joints]
    alike = takewhile(lambda letters: len({*letters}) == 1, zip(*own, strict=False))
    shared = "".join(letters[0] for letters in alike).partition("joint")[0]
    length = shared.rfind("_") + 1 if len(own) > 1 else 0
    return [name[length:].replace("_", " ") for name in own]


class RobotPanel:
    """Sliders drive joints while time passes, and put them in place while it stands still."""

    def __init__(self, viewer: Host, tabs: viser.GuiTabGroupHandle, teleop: TeleopPanel | None) -> None:
        """teleop: the tab of who acts, in an environment."""
        self._viewer, self._player, self._teleop = viewer, viewer.player, teleop
        assert viewer.source.joints is not None
        self._drive: JointDrive = viewer.source.joints
        self.sliders: dict[str, SharedSlider] = {}
        self._gizmo: Any = None
        self.plan: PlanPanel | None = None
        self._dragging = -np.inf
        self._tab = tabs.add_tab("Robot")
        self._folder: Any = None
        self.rebuild()

    def rebuild(self) -> None:
        """Controls for the joints that there are now."""
        if self._folder is not None:
            self._folder.remove()
        if self._gizmo is not None:
            self._gizmo.remove()
            self._gizmo = None
        if self.plan is not None:
            self.plan.close()
            self.plan = None
        model = self._viewer.source.model
        links = [link.name for link in model.links if len(chain(model, link.name)) > 1]
        with self._tab:
            self._folder = self._viewer.server.gui.add_folder(None)
        with self._folder:
            self._make_hand(links, hand_of(model))
            self._make_sliders()

    @property
    def hand(self) -> str | None:
        """The link that the gizmo moves."""
        return self._hand.value if self._hand is not None else None

    def _make_hand(self, links: list[str], hand: str | None) -> None:
        gui, self._hand = self._viewer.server.gui, None
        self._grip: SharedSlider | None = None
        if hand is not None:
            self._handle = gui.add_checkbox("Drag the hand", False, hint="A gizmo that the joints follow")
            self._handle.on_update(lambda _: self._show_gizmo(self._handle.value))
            self._hand = gui.add_dropdown("Hand", links, initial_value=hand)
            self._hand.on_update(lambda _: self._show_gizmo(self._handle.value))
            self.plan = PlanPanel(self._viewer, self._drive, lambda: self.hand, self._hand_over)
        if self._drive.opening is not None:
            grip = gui.add_slider("Gripper", 0.0, 1.0, 0.01, float(np.clip(self._drive.opening, 0, 1)))
            self._grip = SharedSlider(grip, self._move_grip)
        pull = gui.add_number(
            "Pull [N/m]", self._viewer.pull, min=0.0, step=10.0,
            hint="Hold Ctrl (or Cmd) and drag a body with the mouse: it is pulled by a spring this stiff",
        )  # fmt: skip
        pull.on_update(lambda _: setattr(self._viewer, "pull", float(pull.value)))

    def _make_sliders(self) -> None:
        gui, self.sliders = self._viewer.server.gui, {}
        knobs, joints = [k for k in self._drive.knobs if not k.follows], self._viewer.source.model.joints
        slides = {joint.name for joint in joints if joint.type == "prismatic"}
        self._units = {knob.name: 1e3 if knob.name in slides else float(np.degrees(1.0)) for knob in knobs}
        for knob, label in zip(knobs, labels([knob.name for knob in knobs]), strict=True):
            unit = self._units[knob.name]
            slider = gui.add_slider(
                f"{label} [{'mm' if knob.name in slides else '°'}]", round(unit * knob.lower, 1),
                round(unit * knob.upper, 1), 0.1, self._shown(knob, self._drive.value(knob)),
            )  # fmt: skip
            self.sliders[knob.name] = SharedSlider(
                slider, lambda value, name=knob.name, unit=unit: self._move(name, value / unit)
            )

    def _shown(self, knob: Knob, value: float) -> float:
        """What a slider says of a joint's place [degrees or mm]."""
        return round(self._units[knob.name] * float(np.clip(value, knob.lower, knob.upper)), 1)

    def take_over(self) -> None:
        """Hands move the joints from now on, not a plan, and in an environment not a policy."""
        if self.plan is not None:
            self.plan.stop()
        self._hand_over()

    def _hand_over(self) -> None:
        if self._teleop is not None:
            self._teleop.choose_sliders()

    def _move(self, name: str, value: float) -> None:
        self.take_over()
        self._player.do(lambda: self._drive.move({name: value}, place=not self._player.playing))

    def _move_grip(self, opening: float) -> None:
        self.take_over()
        self._player.do(lambda: self._drive.grip(opening, place=not self._player.playing))

    def refresh(self, _: Frame) -> None:
        """Sliders follow the joints, or what drives them."""
        for knob in self._drive.knobs:
            slider = self.sliders.get(knob.name)
            if slider is not None:
                slider.show(self._shown(knob, self._drive.target(knob.name)))
        opening = self._drive.opening
        if self._grip is not None and opening is not None:
            self._grip.show(round(float(np.clip(opening, 0, 1)), 2), tolerance=0.005)

    # ---- the gizmo -----------------------------------------------------------------------------------------------

    def _show_gizmo(self, shown: bool) -> None:
        if self._gizmo is not None:
            self._gizmo.remove()
            self._gizmo = None
        if not shown or self.hand is None:
            return
        position, quaternion = self._hand_pose()
        self._gizmo = self._viewer.server.scene.add_transform_controls(
            "/gizmo", scale=0.22, line_width=3.0, depth_test=False, position=position, wxyz=quaternion[[3, 0, 1, 2]]
        )
        self._gizmo.on_update(self._on_gizmo)

    def _hand_pose(self) -> tuple[Any, Any]:
        positions, quaternions = self._viewer.source.poses()
        index = self._viewer.stage.index[self.hand or ""]
        return positions[index], quaternions[index]

    def _on_gizmo(self, event: Any) -> None:
        self._dragging = time.perf_counter()
        target, hand = event.target, self.hand
        position, quaternion = np.array(target.position), np.array(target.wxyz)[[1, 2, 3, 0]]
        self.take_over()

        def reach() -> None:
            if hand is not None:
                self._drive.reach(hand, position, quaternion, place=not self._player.playing)

        self._player.do(reach)

    def follow(self, frame: Frame) -> None:
        """The gizmo stays at the hand when nobody drags it, and nothing is driven to it."""
        if self._gizmo is None or time.perf_counter() - self._dragging < _DRAGGED_FOR or self.hand is None:
            return
        index = self._viewer.stage.index.get(self.hand)
        if index is not None:
            self._gizmo.position = frame.positions[index]
            self._gizmo.wxyz = frame.quaternions[index][[3, 0, 1, 2]]
