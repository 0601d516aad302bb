"""Few joints each: a cart with its pole, pendulums, an arm of two joints, a biped, a door, a cabinet, a quadrotor."""

from __future__ import annotations

from robots.bullet_data.common import Files, box, model, place, solid
from robots.description import ZERO, Capsule, Cylinder, Joint, Link, Shape, Sphere, Vec3

Looks = list[tuple[Shape, str]]
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def _cartpole() -> Files:
    rail: Looks = [(Cylinder("x", -15.0, 15.0, 0.025), "slate")]
    wheels: Looks = [(Cylinder("y", -0.26, 0.26, 0.06, (x, 0, -0.06)), "graphite") for x in (-0.15, 0.15)]
    cart = solid("cart", 1.0, [box(0.5, 0.5, 0.2)], "blue", looks=wheels)
    knob: Looks = [(Sphere(0.05, (0, 0, 1.0)), "accent"), (Cylinder("y", -0.27, 0.27, 0.035), "metal")]
    pole = solid("pole", 0.1, [box(0.05, 0.05, 1.0, (0, 0, 0.5))], "shell", looks=knob)
    joints = [
        Joint("slider_to_cart", "prismatic", "slideBar", "cart", ZERO, ZERO, X, (-15.0, 15.0, 1000.0, 5.0)),
        Joint("cart_to_pole", "continuous", "cart", "pole", ZERO, ZERO, Y),
    ]
    links = [solid("slideBar", 0.0, [], looks=rail), cart, pole]
    return place("cartpole.urdf", model("physics", links, joints))


def _pendulum() -> Files:
    """Five balls on rods of 0.5 m that turn about x."""
    links, joints = [Link("world")], []
    for k in range(5):
        ball = Sphere(0.05, (0, 0.5, 0))
        rod: Looks = [(Cylinder("y", 0.0, 0.5, 0.012), "metal"), (ball, "accent" if k == 4 else "sky")]
        links.append(solid(f"link{k}", 1.0 if k == 0 else 2.16, [ball], looks=rod))
        at: Vec3 = (0, 0.5, 0) if k else ZERO
        parent = f"link{k - 1}" if k else "world"
        joints.append(Joint(f"joint{k}", "continuous", parent, f"link{k}", at, ZERO, X, damping=1.0, friction=1.0))
    return place("pendulum5.urdf", model("pendulum", links, joints))


def _two_joints() -> Files:
    def hub(name: str, look: str, z: float = 0.0) -> Link:
        return solid(name, 0.2, [Cylinder("z", z - 0.0375, z + 0.0375, 0.05)], look, com=ZERO)

    def bar(name: str, look: str) -> Link:
        return solid(name, 0.5, [box(1.0, 0.1, 0.05, (0.5, 0, 0))], look, com=ZERO)

    def turn(name: str, parent: str, child: str, at: Vec3, reach: float) -> Joint:
        return Joint(name, "revolute", parent, child, at, ZERO, Z, (-reach, reach, 10000.0, 5.0))

    along: Vec3 = (1.0, 0, 0)
    with_hubs = model(
        "TwoJointRobot",
        [
            hub("base_link", "slate", 0.025),
            hub("link_01_cyl", "blue"),
            bar("link_1", "blue"),
            hub("link_12_cyl", "blue"),
            hub("link_21_cyl", "shell"),
            bar("link_2", "shell"),
            hub("link_23_cyl", "accent"),
        ],
        [
            turn("joint_1", "base_link", "link_01_cyl", (0, 0, 0.075), 3.0),
            Joint("link_01", "fixed", "link_01_cyl", "link_1", ZERO),
            Joint("link_12", "fixed", "link_1", "link_12_cyl", along),
            turn("joint_2", "link_12_cyl", "link_21_cyl", (0, 0, 0.05), 3.0),
            Joint("link_21", "fixed", "link_21_cyl", "link_2", ZERO),
            Joint("link_23", "fixed", "link_2", "link_23_cyl", along),
        ],
    )
    without = model(
        "TwoJointRobot",
        [hub("base_link", "slate", 0.025), bar("link_1", "blue"), bar("link_2", "shell"), hub("link_23_cyl", "accent")],
        [
            turn("joint_1", "base_link", "link_1", (0, 0, 0.075), 3.14),
            turn("joint_2", "link_1", "link_2", (1.0, 0, 0.05), 3.14),
            Joint("link_23", "fixed", "link_2", "link_23_cyl", along),
        ],
    )
    return {
        **place("TwoJointRobot_w_fixedJoints.urdf", with_hubs),
        **place("TwoJointRobot_wo_fixedJoints.urdf", without),
    }


def _biped() -> Files:
    """It walks in the plane x = 0."""
    links = [Link("world"), *(Link(f"{a}_prismatic", 0.01, ZERO, (1e-5, 1e-5, 1e-5)) for a in "yz")]
    face: Looks = [(Sphere(0.09, (0, 0, 0.33)), "shell"), (box(0.08, 0.03, 0.02, (0, 0.08, 0.35)), "graphite")]
    links.append(solid("torso", 70.0, [box(0.1, 0.1, 0.48)], "blue", looks=face))
    shin = -0.21715
    for part, mass, x, width, look in (
        ("upperleg", 5.0, 0.018, 0.05, "slate"),
        ("lowerleg", 4.0, 0.048, 0.05, "shell"),
    ):
        for side, s in (("r", 1), ("l", -1)):
            links.append(solid(f"{side}_{part}", mass, [box(width, 0.1, 0.45, (s * x, 0, shin))], look))
    for side, s in (("l", 1), ("r", -1)):
        links.append(solid(f"{side}_foot", 1.0, [box(0.05, 0.2, 0.04, (s * 0.05, 0.08, -0.038))], "accent"))
    free = (1.0, -1.0, 0.0, 1000.0)

    def hinge(name: str, parent: str, child: str, at: Vec3, reach: float, effort: float = 10.0) -> Joint:
        return Joint(name, "revolute", parent, child, at, ZERO, X, (-reach, reach, effort, 1000.0))

    joints = [
        Joint("y_to_world", "prismatic", "world", "y_prismatic", ZERO, ZERO, Y, free),
        Joint("z_to_y", "prismatic", "y_prismatic", "z_prismatic", ZERO, ZERO, Z, free),
        Joint("torso_to_z", "continuous", "z_prismatic", "torso", (0, 0, 1.4), ZERO, X),
        hinge("torso_to_rightleg", "torso", "r_upperleg", (0.05, 0, -0.17), 1.57, 0.0),
        hinge("torso_to_leftleg", "torso", "l_upperleg", (-0.05, 0, -0.17), 1.57),
        hinge("r_knee", "r_upperleg", "r_lowerleg", (0.015, 0, -0.41), 1.57),
        hinge("l_knee", "l_upperleg", "l_lowerleg", (-0.015, 0, -0.41), 1.57),
        hinge("l_ankle", "l_lowerleg", "l_foot", (-0.05, -0.03, -0.459), 2.0),
        hinge("r_ankle", "r_lowerleg", "r_foot", (0.05, -0.03, -0.459), 2.0),
    ]
    return place("biped/biped2d_pybullet.urdf", model("balance", links, joints))


def _door() -> Files:
    """A leaf of 0.9 m by 2 m in its frame, on a hinge about z, with a lever on both sides."""
    posts: list[Shape] = [box(0.08, 0.10, 2.06, (0, s * 0.5, 1.03)) for s in (-1, 1)]
    frame = solid("frame", 0.0, [*posts, box(0.08, 1.10, 0.06, (0, 0, 2.07))], "slate")
    leaf = box(0.04, 0.89, 2.0, (0, 0.45, 1.02))
    panels: Looks = [(box(0.046, 0.64, h, (0, 0.45, z)), "cream") for z, h in ((0.56, 0.80), (1.50, 0.80))]
    door = solid("door", 12.0, [leaf], "oak", looks=panels)
    stems: list[Shape] = [Cylinder("x", -0.07, 0.07, 0.010)]
    bars: list[Shape] = [Capsule("y", -0.11, 0.0, 0.010, (s * 0.065, 0, 0)) for s in (-1, 1)]
    lever = solid("handle", 0.4, [*stems, *bars], "metal")
    joints = [
        Joint(
            "door_hinge",
            "revolute",
            "frame",
            "door",
            (0, -0.45, 0),
            ZERO,
            Z,
            (0.0, 1.8, 50.0, 4.0),
            damping=0.3,
            friction=0.1,
        ),
        Joint(
            "handle_joint", "revolute", "door", "handle", (0, 0.82, 1.02), ZERO, X, (0.0, 0.8, 10.0, 6.0), damping=0.05
        ),
    ]
    return place("door.urdf", model("door", [frame, door, lever], joints))


def _open_box(size: Vec3, wall: float) -> list[Shape]:
    """Floor, back and sides of a drawer with its front left out; it pulls out along x, its floor at z = 0."""
    x, y, z = size
    sides: list[Shape] = [box(x, wall, z, (0, s * (y - wall) / 2, z / 2)) for s in (-1, 1)]
    return [box(x, y, wall, (0, 0, wall / 2)), *sides, box(wall, y, z, (-(x - wall) / 2, 0, z / 2))]


def _handle(x: float, height: float) -> list[Shape]:
    bars: list[Shape] = [Cylinder("x", x, x + 0.035, 0.006, (0, s * 0.06, height)) for s in (-1, 1)]
    return [*bars, Capsule("y", -0.06, 0.06, 0.007, (x + 0.038, 0, height))]


def _cabinet() -> Files:
    """Two drawers over a cupboard with a door. It stands on z = 0 and opens towards +x."""
    w, d, h, t = 0.50, 0.44, 0.80, 0.018
    sides: list[Shape] = [box(d, t, h, (0, s * (w - t) / 2, h / 2)) for s in (-1, 1)]
    boards: list[Shape] = [box(d, w - 2 * t, t, (0, 0, z)) for z in (0.05, 0.42, 0.61, h - t / 2)]
    back: list[Shape] = [box(t, w - 2 * t, h - 0.05, (-(d - t) / 2, 0, h / 2 + 0.025))]
    body = solid(
        "cabinet",
        25.0,
        [*sides, *boards, *back],
        "shell",
        looks=[(box(d + 0.02, w + 0.02, 0.012, (0.005, 0, h + 0.006)), "oak")],
    )
    links, joints = [body], []
    for name, z in (("top", 0.625), ("bottom", 0.435)):
        tray = _open_box((0.38, w - 2 * t - 0.014, 0.13), 0.010)
        front: list[Shape] = [box(0.018, w - 2 * t - 0.006, 0.158, (0.199, 0, 0.076))]
        grip = _handle(0.208, 0.085)
        looks: Looks = [*((s, "cream") for s in tray), *((s, "sky") for s in front), *((s, "metal") for s in grip)]
        link = solid(f"{name}_drawer", 2.0, [*tray, *front, *grip], looks=looks)
        links.append(link)
        joints.append(
            Joint(
                f"{name}_drawer_joint",
                "prismatic",
                "cabinet",
                link.name,
                (0.012, 0, z),
                ZERO,
                X,
                (0.0, 0.30, 60.0, 1.0),
                damping=2.0,
                friction=1.0,
            )
        )
    leaf: list[Shape] = [box(0.018, w - 2 * t - 0.006, 0.34, (0.009, -(w - 2 * t) / 2, 0))]
    pull: list[Shape] = [Cylinder("x", 0.018, 0.05, 0.006, (0, -0.41, z)) for z in (-0.05, 0.05)]
    pull.append(Capsule("z", -0.05, 0.05, 0.007, (0.053, -0.41, 0)))
    looks = [*((s, "blue") for s in leaf), *((s, "metal") for s in pull)]
    links.append(solid("cabinet_door", 2.5, [*leaf, *pull], looks=looks))
    hinge: Vec3 = (0.202, (w - 2 * t) / 2, 0.235)
    joints.append(
        Joint(
            "cabinet_door_joint",
            "revolute",
            "cabinet",
            "cabinet_door",
            hinge,
            ZERO,
            Z,
            (0.0, 1.9, 20.0, 4.0),
            damping=0.1,
            friction=0.05,
        )
    )
    return place("cabinet/cabinet.urdf", model("cabinet", links, joints))


def _drawer() -> Files:
    """One drawer in its case."""
    case: list[Shape] = [box(0.34, 0.012, 0.16, (0, s * 0.186, 0.08)) for s in (-1, 1)]
    case += [box(0.34, 0.36, 0.012, (0, 0, z)) for z in (0.006, 0.154)]
    case.append(box(0.012, 0.36, 0.136, (-0.164, 0, 0.08)))
    tray = _open_box((0.30, 0.35, 0.11), 0.010)
    front: list[Shape] = [box(0.016, 0.356, 0.130, (0.158, 0, 0.064))]
    grip = _handle(0.166, 0.07)
    looks: Looks = [*((s, "cream") for s in tray), *((s, "teal") for s in front), *((s, "metal") for s in grip)]
    joint = Joint(
        "drawer_joint",
        "prismatic",
        "case",
        "drawer",
        (0.003, 0, 0.0145),
        ZERO,
        X,
        (0.0, 0.24, 60.0, 1.0),
        damping=2.0,
        friction=1.0,
    )
    links = [solid("case", 6.0, case, "shell"), solid("drawer", 1.2, [*tray, *front, *grip], looks=looks)]
    return place("drawer/drawer.urdf", model("drawer", links, [joint]))


def _quadrotor() -> Files:
    """0.5 kg, with rotors 0.175 m from the middle on both axes: thrust is for programs to apply."""
    arms: list[tuple[Shape, str]] = [
        (Cylinder("x", -0.175, 0.175, 0.008), "slate"),
        (Cylinder("y", -0.175, 0.175, 0.008), "slate"),
    ]
    body: Looks = [
        *arms,
        (Cylinder("z", -0.018, 0.022, 0.045), "shell"),
        (Cylinder("z", 0.022, 0.028, 0.032), "graphite"),
    ]
    body.append((box(0.03, 0.012, 0.012, (0.05, 0, 0)), "accent"))
    for x, y, look in ((0.175, 0, "accent"), (-0.175, 0, "sky"), (0, 0.175, "sky"), (0, -0.175, "sky")):
        body += [
            (Cylinder("z", -0.012, 0.020, 0.014, (x, y, 0)), "graphite"),
            (Cylinder("z", 0.020, 0.0225, 0.080, (x, y, 0)), look),
        ]
    hull: list[Shape] = [Cylinder("z", -0.03, 0.03, 0.255)]
    link = solid("base_link", 0.5, hull, looks=body, like=[Cylinder("z", -0.02, 0.02, 0.16)], com=ZERO)
    return place("Quadrotor/quadrotor.urdf", model("quadrotor", [link]))


def files() -> Files:
    return {
        **_cartpole(),
        **_pendulum(),
        **_two_joints(),
        **_biped(),
        **_door(),
        **_cabinet(),
        **_drawer(),
        **_quadrotor(),
    }
