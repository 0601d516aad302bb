"""A gripper that one motor opens and closes by two hinged bars, which programs tie to its fingers by constraints."""

from __future__ import annotations

from robots.bullet_data.common import Files, box, model, solid
from robots.bullet_data.sdf_text import world_text
from robots.description import HALF_PI, ZERO, Cylinder, Joint, Link, Placed, Robot, Shape, Vec3

PI = 3.14159
SLIDE, HINGE = (-0.01, 0.05, 1.0, 1.0), (-20.0, 20.0, 10.0, 10.0)


def _gripper(base_mass: float, motor_lower: float, lift: bool) -> Robot:
    """Its links collide at the fingers only. `lift`: it hangs down and slides along z."""
    small: list[Shape] = [box(0.02, 0.02, 0.02)]
    palm: list[tuple[Shape, str]] = [
        (box(0.146, 0.05, 0.05, (0, 0, 0.0)), "graphite"),
        (Cylinder("z", -0.065, 0.0, 0.036), "metal"),
    ]
    palm += [(box(0.150, 0.030, 0.012, (0, 0, 0.028)), "shell"), (Cylinder("y", -0.0255, 0.0255, 0.012), "accent")]
    links = [
        Link("world", base_mass, inertia=(1e-4, 1e-4, 1e-4) if base_mass else ZERO),
        solid("base_link", 1.2, [], looks=palm, like=[box(0.146, 0.05, 0.09)], com=ZERO),
        solid("motor", 0.1, [], looks=[(box(0.02, 0.02, 0.02, (0, 0, 0.01)), "slate")], like=small, com=ZERO),
    ]
    base_limits = (-0.5, 10.0, 1.0, 1.0)
    joints = [
        Joint(
            "base_joint",
            "prismatic" if lift else "fixed",
            "world",
            "base_link",
            ZERO,
            (3.14, 0, 0) if lift else ZERO,
            (0, 0, 1),
            base_limits if lift else None,
        ),
        Joint(
            "base_joint_motor",
            "prismatic",
            "base_link",
            "motor",
            (0, 0, 0.03),
            ZERO,
            (0, 0, 1),
            (motor_lower, 0.001, 10.0, 10.0),
        ),
    ]
    for side, s in (("left", -1), ("right", 1)):
        bar = Placed(box(0.014, 0.014, 0.07), (0.03 * s, 0, 0.01), (0, 1.2 * s, 0))
        links.append(solid(f"{side}_hinge", 0.1, [], looks=[(bar, "slate")], like=small, com=(0, 0, 0.035)))
        hinge = Joint(
            f"motor_{side}_hinge_joint", "revolute", "motor", f"{side}_hinge", (0, 0, 0.01), ZERO, (0, 1, 0), HINGE
        )
        joints.append(hinge)
    for side, s in (("left", -1), ("right", 1)):
        block: list[tuple[Shape, str]] = [
            (box(0.024, 0.040, 0.030, (0, 0, -0.012)), "metal"),
            (box(0.020, 0.026, 0.058, (0, 0, 0.029)), "slate"),
        ]
        links.append(solid(f"gripper_{side}", 0.2, [], looks=block, like=small, com=(0, 0, 0.0115)))
        turn: Vec3 = (0, 0, PI) if s > 0 else ZERO
        slide = Joint(
            f"gripper_{side}_hinge_joint",
            "prismatic",
            "base_link",
            f"gripper_{side}",
            (0.055 * s, 0, 0.06),
            turn,
            (1, 0, 0),
            SLIDE,
        )
        finger: list[Shape] = [box(0.02, 0.02, 0.15, (0, 0, 0.042))]
        pad: list[tuple[Shape, str]] = [(box(0.018, 0.003, 0.07, (0, 0.0095, 0.078)), "accent")]
        grip = {"lateral_friction": 1.0, "spinning_friction": 1.5}
        links.append(solid(f"finger_{side}", 0.2, finger, "graphite", looks=pad, com=ZERO, contact=grip))
        hold = Joint(
            f"gripper_finger_{side}", "fixed", f"gripper_{side}", f"finger_{side}", (-0.007, 0, 0.085), (0, 0, -HALF_PI)
        )
        joints += [slide, hold]
    return model("wsg50_with_gripper", links, joints)


def files() -> Files:
    free = _gripper(0.1, -0.055, lift=False)
    held = _gripper(0.0, -0.055, lift=True)
    return {
        "gripper/wsg50_one_motor_gripper_new_free_base.sdf": world_text([free], at=(1.4, -0.2, 2.1)),
        "gripper/wsg50_one_motor_gripper_new.sdf": world_text([held], at=(0.0, 0.0, 0.7)),
    }
