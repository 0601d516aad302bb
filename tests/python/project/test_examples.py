"""The Python examples do what they say."""

import runpy
from pathlib import Path

import numpy as np

import manyhands as mh
from manyhands import kinematics, planning

EXAMPLES = Path(__file__).parents[3] / "examples"


def test_two_arms_hand_over_a_bar() -> None:
    example = runpy.run_path(str(EXAMPLES / "two_arms.py"))
    arms = example["TwoArms"]()
    arms.grip("right", 0.08)
    arms.move(left=[-0.2, 0, 0.015], right=[0.25, 0, 0.3])
    arms.grip("left", 0)
    arms.move(left=[-0.1, 0, 0.25])
    assert example["held_by"](arms.world) == {"left"}
    assert arms.world.body_pose("bar")[0][2] > 0.24

    world = example["hand_over"]().world
    assert example["held_by"](world) == {"right"}
    position, quaternion = world.body_pose("bar")
    np.testing.assert_allclose(position, [0.1, -0.1, 0.2], atol=5e-3)
    assert abs(quaternion[3]) > 0.999  # level
    world.step(500)
    np.testing.assert_allclose(world.body_pose("bar")[0], position, atol=1e-3)


def test_an_arm_puts_into_a_bin_what_a_camera_sees() -> None:
    example = runpy.run_path(str(EXAMPLES / "pick_and_place.py"))
    world = example["station"]()
    world.add_box("brick", [0.02, 0.04, 0.03], 0.2, [0.45, 0.1, 0.03])
    world.add_cylinder("can", 0.025, 0.04, 0.2, [0.5, -0.15, 0.04])
    seen = example["see"](world)
    things = sorted((seen.body_pose(f"thing{k}")[0] for k in range(2)), key=lambda p: -p[1])
    for thing, name in zip(things, ("brick", "can"), strict=True):
        np.testing.assert_allclose(thing, world.body_pose(name)[0], atol=5e-3)
    _, down, away = example["plan_pick"](seen)
    assert least_distance_of_held(world, example["TOOL"], down, away) > 0.8 * example["MARGIN"]
    example["clear"](world)
    for name in ("brick", "can"):
        assert (np.abs(world.body_pose(name)[0] - [0, 0.52, 0.103]) < [0.2, 0.15, 0.103]).all()
    assert example["plan_pick"](example["see"](world)) == []


def least_distance_of_held(world: mh.World, tool: str, down: planning.Plan, away: planning.Plan) -> float:
    """Of the thing as it is, not as it is seen, and of the arm that carries it, from all else but the floor."""
    q = planning.Planner(world, tool).configuration(down.waypoints[-1])
    at, _ = kinematics.forward(world.model, q, tool)
    name = min(("brick", "can"), key=lambda name: float(np.linalg.norm(world.body_pose(name)[0] - at)))
    held, allowed = {name: "arm/gripper/palm"}, [(name, "floor")]
    carrier = planning.Planner(world.model, tool, q=q, attached=held, allowed=allowed)
    return carrier.least_distance(away.waypoints).distance


def test_a_cup_is_carried_upright() -> None:
    example = runpy.run_path(str(EXAMPLES / "upright_cup.py"))
    planner = planning.Planner(example["scene"](), example["HAND"], attached={"cup": "panda_hand"})
    plan = planner.plan(example["RIGHT"], keep=planning.upright("cup", within=example["WITHIN"]), time_limit=10.0)
    assert example["most_tilt"](planner, plan.trajectory(acceleration=5.0)) < example["WITHIN"]
