"""A goal for the hand that is dragged, and a plan to it among all that stands there, which the arm then follows."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from manyhands import kinematics, planning
from manyhands.viewer.host import Host
from manyhands.viewer.joints import JointDrive

Array = NDArray[np.float64]

_ACCELERATION = 3.0  # [rad/s^2 or m/s^2]
_SHARE = 0.5  # of the model's velocities
_TIME_LIMIT = 2.0  # [s] of a search
_WAIT = 30.0  # [s] for the simulation to pause between two steps
_POINTS = 60  # of the way that is drawn
_EVERY = 0.01  # [s] of the simulation, between targets of the joints
_COLOUR = (242, 115, 25)
_GOAL, _WAY = "/gizmo/goal", "/gizmo/way"


class Follow(NamedTuple):
    """A motion that joints are driven along."""

    motion: planning.Trajectory
    joints: tuple[str, ...]
    began: float
    """[s] of the simulation"""


def _advice(plan: planning.Plan) -> str:
    """What to do where the arm stands so that no way begins there, as at 0 of all joints many do."""
    return "; move its joints with the sliders first, to where it is free" if plan.status.startswith("start") else ""


class PlanPanel:
    """Controls for plans of the chosen hand, in the folder that is open."""

    def __init__(self, viewer: Host, drive: JointDrive, hand: Callable[[], str | None], take_over: Callable[[], None]):
        """hand: the link that is planned for. take_over: leaves the joints to the page."""
        self._viewer, self._drive, self._hand, self._take_over = viewer, drive, hand, take_over
        self._goal: Any = None
        self._way: Any = None
        self._follow: Follow | None = None
        self._told = -np.inf  # [s] when the joints were driven last
        viewer.player.before_step = self.follow
        gui = viewer.server.gui
        with gui.add_folder("Plan"):
            self._shown = gui.add_checkbox("Drag a goal", False, hint="Where the hand is to go, and how it is turned")
            self._shown.on_update(lambda _: self.show_goal(self._shown.value))
            go = gui.add_button("Plan and go", hint="Finds a way among all that stands there, and follows it")
            go.on_click(lambda _: self.plan_and_go())
            self._status = gui.add_markdown("")

    @property
    def is_following(self) -> bool:
        """Whether the arm is on its way."""
        return self._follow is not None

    @property
    def status(self) -> str:
        """What the page says of the last plan."""
        return self._status.content

    @property
    def goal(self) -> tuple[Array, Array] | None:
        """Position (3,) and quaternion (4,) xyzw of the goal; None while none is shown."""
        if self._goal is None:
            return None
        return np.array(self._goal.position), np.array(self._goal.wxyz)[[1, 2, 3, 0]]

    def show_goal(self, shown: bool, pose: tuple[Array, Array] | None = None) -> None:
        """Shows the goal at a pose, by default where the hand is, or takes it away."""
        self._remove()
        hand = self._hand()
        if not shown or hand is None:
            return
        positions, quaternions = self._viewer.source.poses()
        index = self._viewer.stage.index[hand]
        position, quaternion = pose or (positions[index], quaternions[index])
        self._goal = self._viewer.server.scene.add_transform_controls(
            _GOAL, scale=0.18, line_width=4.0, depth_test=False, position=position, wxyz=quaternion[[3, 0, 1, 2]]
        )

    def plan_and_go(self) -> None:
        """Plans to the goal and begins to follow the plan; says why, if there is none. Not to be called from the
        simulation's thread, which goes on meanwhile."""
        hand, goal = self._hand(), self.goal
        if hand is None or goal is None:
            self._say("Drag a goal first")
            return
        self.stop()
        self._say("Planning")
        try:
            planner = self._planner(hand)
            plan = planner.plan(position=goal[0], quaternion=goal[1], time_limit=_TIME_LIMIT)
            if plan.curve is None:
                self._say("It is there" if plan.success else f"No plan: {plan.message}{_advice(plan)}")
                return
            motion = plan.trajectory(velocity=_SHARE * planner.velocity, acceleration=_ACCELERATION)
        except Exception as reason:  # joints that cannot be planned, and whatever else: the page says it, and goes on
            self._say(f"No plan: {reason}")
            return
        self._draw(planner, motion, hand)
        self._say(f"{motion.duration:.1f} s, found in {1e3 * (plan.search_time + plan.shorten_time):.0f} ms")
        self._take_over()

        def begin() -> None:
            self._told = -np.inf
            self._follow = Follow(motion, planner.joints, self._viewer.source.time)

        self._viewer.player.do(begin)
        self._viewer.play()

    def _planner(self, hand: str) -> planning.Planner:
        """Of the world as it is between two steps."""
        made: list[planning.Planner | Exception] = []

        def make() -> None:
            try:
                world = self._viewer.source.world
                assert world is not None
                made.append(planning.Planner(world, hand))
            except Exception as reason:
                made.append(reason)

        if not self._viewer.player.do(make, wait=_WAIT):
            raise ValueError("the simulation is busy")
        if isinstance(made[0], Exception):
            raise made[0]
        return made[0]

    def _draw(self, planner: planning.Planner, motion: planning.Trajectory, hand: str) -> None:
        rows = planner.configuration(motion.sample(np.linspace(0, motion.duration, _POINTS)).q)
        points, _ = kinematics.forward(planner.model, rows, hand)
        lines = np.stack([points[:-1], points[1:]], axis=1)
        scene = self._viewer.server.scene
        self._way = scene.add_line_segments(_WAY, lines, colors=_COLOUR, thickness=0.006)

    def follow(self) -> None:
        """Drives the joints to where the motion is; resets and rewinding end it. Before each step of the simulation."""
        following, now = self._follow, self._viewer.source.time
        if following is None:
            return
        since = now - following.began
        if since < 0:
            self.stop()
        elif since >= following.motion.duration or now - self._told >= _EVERY:
            self._told = now
            self._drive.move(dict(zip(following.joints, following.motion.sample(since).q.tolist(), strict=True)))
            if since >= following.motion.duration:
                self.stop()

    def stop(self) -> None:
        """Follows no longer; the joints hold where they were driven to."""
        self._follow = None
        if self._way is not None:
            self._way.remove()
            self._way = None

    def close(self) -> None:
        """Takes away what it shows in the scene."""
        self.stop()
        self._remove()

    def _remove(self) -> None:
        if self._goal is not None:
            self._goal.remove()
            self._goal = None

    def _say(self, text: str) -> None:
        self._status.content = text
