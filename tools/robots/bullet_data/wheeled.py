"""A Husky and a racing car."""

from __future__ import annotations

import itertools

from robots.bullet_data.common import Files, box, model, place, solid
from robots.description import ZERO, Cylinder, Joint, Link, Shape, Sphere, Vec3

Looks = list[tuple[Shape, str]]


def _rail(points: list[Vec3], radius: float) -> Looks:
    """Bent tube with its axis parallel to x, y or z between neighbouring points."""
    looks: Looks = []
    for a, b in itertools.pairwise(points):
        i = max(range(3), key=lambda k: abs(a[k] - b[k]))
        low, high = sorted((a[i], b[i]))
        looks.append((Cylinder("xyz"[i], low, high, radius, a), "slate"))
    return looks + [(Sphere(radius, p), "slate") for p in points]


def _husky() -> Files:
    hull: list[Shape] = [box(1.0074, 0.5709, 0.2675, (0, 0, 0.12498))]
    body: Looks = [(box(0.92, 0.40, 0.20, (0, 0, 0.105)), "graphite"), (box(0.60, 0.46, 0.05, (0, 0, 0.205)), "slate")]
    body += [(box(0.06, 0.30, 0.06, (s * 0.475, 0, 0.13)), "slate") for s in (-1, 1)]
    body += [(box(0.004, 0.05, 0.02, (0.507, y, 0.13)), "shell") for y in (-0.10, 0.10)]
    chassis = solid("base_link", 33.455, hull, looks=body, com=(-0.08748, -0.00085, 0.09947))
    tyre = {"lateral_friction": 1.0, "rolling_friction": 0.0, "stiffness": 30000.0, "damping": 1000.0}
    tread: list[Shape] = [Cylinder("y", -0.05715, 0.05715, 0.17775)]
    # Bullet gives a kilogram to links without inertia, as those of its own file are.
    plate: list[Shape] = [box(0.1, 0.1, 0.01)]
    links = [solid("base_footprint", 1.0, [], like=plate), chassis, solid("imu_link", 1.0, [], like=plate)]
    joints = []
    joints.append(Joint("chassis_joint", "fixed", "base_footprint", "base_link", (0, 0, 0.14493)))
    joints.append(Joint("imu_joint", "fixed", "base_link", "imu_link", (0.19, 0, 0.149), (0, -1.5708, 3.1416)))
    for end, x in (("front", 0.256), ("rear", -0.256)):
        for side, s in (("left", 1), ("right", -1)):
            name = f"{end}_{side}_wheel"
            hub: Looks = [
                (Cylinder("y", -0.0578, 0.0578, 0.10), "yellow"),
                (Cylinder("y", -0.0584, 0.0584, 0.078), "graphite"),
                (Cylinder("y", -0.0600, 0.0600, 0.035), "metal"),
            ]
            links.append(solid(f"{name}_link", 2.637, tread, "slate", looks=hub, contact=tyre))
            at = (x, s * 0.2854, 0.03282)
            joints.append(Joint(name, "continuous", "base_link", f"{name}_link", at, ZERO, (0, 1, 0)))
    top: Looks = [
        (box(0.72, 0.44, 0.008, (0, 0, 0.245)), "yellow"),
        (box(0.56, 0.10, 0.010, (0, 0, 0.247)), "graphite"),
    ]
    bow: Vec3 = (-0.02, 0.23, 0.0)
    rail = _rail([bow, (-0.02, 0.23, 0.16), (-0.02, -0.23, 0.16), (-0.02, -0.23, 0.0)], 0.014)
    bumper = _rail([(-0.04, 0.22, 0.0), (0.06, 0.22, 0.0), (0.06, -0.22, 0.0), (-0.04, -0.22, 0.0)], 0.016)
    wide: list[Shape] = [box(0.72, 0.44, 0.01)]
    links += [
        solid("top_plate_link", 1.0, [], looks=top, like=wide),
        solid("user_rail_link", 1.0, [], looks=rail, like=plate),
    ]
    links += [solid(f"{end}_bumper_link", 1.0, [], looks=bumper, like=plate) for end in ("front", "rear")]
    joints.append(Joint("top_plate", "fixed", "base_link", "top_plate_link", ZERO))
    joints.append(Joint("user_rail", "fixed", "base_link", "user_rail_link", (0.272, 0, 0.245)))
    joints.append(Joint("front_bumper", "fixed", "base_link", "front_bumper_link", (0.48, 0, 0.091)))
    joints.append(Joint("rear_bumper", "fixed", "base_link", "rear_bumper_link", (-0.48, 0, 0.091), (0, 0, 3.14159)))
    return place("husky/husky.urdf", model("husky_robot", links, joints))


BODY: Looks = [
    (box(0.46, 0.13, 0.025, (0.16, 0, 0.0)), "graphite"),
    (box(0.34, 0.15, 0.030, (0.15, 0, 0.030)), "blue"),
    (box(0.16, 0.12, 0.034, (0.10, 0, 0.060)), "blue"),
    (box(0.10, 0.124, 0.022, (0.10, 0, 0.064)), "graphite"),
    (box(0.045, 0.20, 0.010, (-0.06, 0, 0.095)), "accent"),
    (box(0.012, 0.012, 0.07, (-0.055, 0.06, 0.058)), "graphite"),
    (box(0.012, 0.012, 0.07, (-0.055, -0.06, 0.058)), "graphite"),
    (box(0.035, 0.19, 0.012, (0.40, 0, 0.005)), "accent"),
]
LASER: Looks = [(Cylinder("z", -0.02, 0.015, 0.024), "graphite"), (Cylinder("z", 0.015, 0.035, 0.020), "slate")]
EYES: Looks = [(Cylinder("x", 0.012, 0.018, 0.010, (0, y, 0)), "sky") for y in (-0.06, 0.06)]


def _wheel(name: str, side: float, contact: dict[str, float]) -> Link:
    """About z, on the side of its hub that `side` says."""
    low, high = sorted((0.0, side * 0.045))
    tyre = Cylinder("z", low, high, 0.05)
    rim: Looks = [
        (Cylinder("z", low - 0.0008, high + 0.0008, 0.031), "shell"),
        (Cylinder("z", low - 0.002, high + 0.002, 0.009), "accent"),
    ]
    return solid(name, 0.34055, [tyre], "graphite", looks=rim, contact=contact)


def _car_links(grip: bool, camera_masses: tuple[float, float]) -> dict[str, Link]:
    """By name: what both cars have."""

    def tyre(friction: float) -> dict[str, float]:
        return (
            {"lateral_friction": friction, "rolling_friction": 0.0, "stiffness": 300000.0, "damping": 1000.0}
            if grip
            else {}
        )

    links = []
    for end, friction in (("rear", 0.5), ("front", 0.8)):
        links += [_wheel(f"{side}_{end}_wheel", s, tyre(friction)) for side, s in (("left", -1.0), ("right", 1.0))]
    knuckle = box(0.03, 0.03, 0.03)
    links += [
        solid(f"{side}_steering_hinge", 0.1, [], looks=[(knuckle, "metal")], like=[knuckle])
        for side in ("left", "right")
    ]
    links.append(solid("laser", 0.13, [box(0.1, 0.1, 0.1)], looks=LASER))
    zed, eye = camera_masses
    links.append(solid("zed_camera_link", zed, [box(0.033, 0.175, 0.03)], "slate", looks=EYES))
    links += [solid(name, eye, [], like=[box(0.02, 0.02, 0.02)]) for name in ("camera_link", "zed_camera_right_link")]
    return {link.name: link for link in links}


def _front_joints() -> list[Joint]:
    steer, spin, axis = (10.0, 100.0), (10.0, 100.0), (-1, 0, 0)
    hinges = [
        Joint(
            "left_steering_hinge_joint",
            "revolute",
            "chassis",
            "left_steering_hinge",
            (0.325, 0.1, 0),
            (0, 1.5708, 0),
            axis,
            (-1.0, 1.0, *steer),
        ),
        Joint(
            "right_steering_hinge_joint",
            "continuous",
            "chassis",
            "right_steering_hinge",
            (0.325, -0.1, 0),
            (0, 1.5708, 0),
            axis,
            (-1.0, 1.0, *steer),
        ),
    ]
    return hinges + [
        Joint(
            f"{side}_front_wheel_joint",
            "continuous",
            f"{side}_steering_hinge",
            f"{side}_front_wheel",
            ZERO,
            (1.5708, 0, 0),
            (0, 0, -1),
            drive=spin,
        )
        for side in ("left", "right")
    ]


SENSOR_JOINTS = [
    Joint("hokuyo_joint", "fixed", "chassis", "laser", (0.265, 0.0, 0.075)),
    Joint("zed_camera_joint", "fixed", "chassis", "zed_camera_link", (0.390, 0, 0.04)),
    Joint("zed_camera_left_joint", "fixed", "zed_camera_link", "camera_link", (0, 0.06, 0)),
    Joint("zed_camera_right_joint", "fixed", "zed_camera_link", "zed_camera_right_link", (0, -0.06, 0)),
]
ORDER = (
    "left_rear_wheel",
    "right_rear_wheel",
    "left_steering_hinge",
    "right_steering_hinge",
    "left_front_wheel",
    "right_front_wheel",
)
LAST = ("laser", "zed_camera_link", "camera_link", "zed_camera_right_link")


def _racecar() -> Files:
    parts = _car_links(False, (1e-5, 1e-5))
    floor: list[Shape] = [box(0.46, 0.15, 0.05, (0.16, 0, 0))]
    links = [
        solid("base_link", 0.1, [], like=floor, com=ZERO),
        solid("chassis", 0.1, [], looks=BODY, like=floor, com=ZERO),
        solid("chassis_inertia", 4.0, [], like=floor, com=(0.1477, 0, 0)),
        *(parts[name] for name in (*ORDER, *LAST)),
    ]
    rear = [
        Joint(
            f"{side}_rear_wheel_joint",
            "continuous",
            "chassis",
            f"{side}_rear_wheel",
            (0, y, 0),
            (1.5708, 0, 0),
            (0, 0, -1),
            drive=(10.0, 100.0),
        )
        for side, y in (("left", 0.1), ("right", -0.1))
    ]
    first = [
        Joint("base_link_joint", "fixed", "base_link", "chassis", (0, 0, 0.05)),
        Joint("chassis_inertia_joint", "fixed", "chassis", "chassis_inertia", ZERO),
    ]
    return place("racecar/racecar.urdf", model("racecar", links, [*first, *rear, *_front_joints(), *SENSOR_JOINTS]))


def _differential_gear(
    prefix: str, mount: Joint, masses: tuple[float, float], size: float
) -> tuple[list[Link], list[Joint]]:
    """A ring on `mount`, two spiders in it, two sides that turn what they hold; gear constraints tie them.

    `masses`: of the ring and of the others; `size`: the ring's radius.
    """
    hoop = [Cylinder("y", -0.12 * size, 0.12 * size, size)]
    wheels = {
        "spiderA": Cylinder("y", 0.20 * size, 0.55 * size, 0.34 * size),
        "spiderB": Cylinder("y", 0.20 * size, 0.55 * size, 0.34 * size),
        "sideA": Cylinder("y", 0.20 * size, 0.50 * size, 0.42 * size),
        "sideB": Cylinder("y", -0.50 * size, -0.20 * size, 0.42 * size),
    }
    ring = f"{prefix}_ring"
    links = [solid(ring, masses[0], [], looks=[(hoop[0], "metal")], like=[*hoop], com=ZERO)]
    joints = [mount]
    for (name, wheel), yaw in zip(wheels.items(), (1.570795, -1.570795, 0.0, 0.0), strict=True):
        look = "accent" if name.startswith("spider") else "slate"
        links.append(solid(f"{prefix}_{name}", masses[1], [], looks=[(wheel, look)], like=[wheel], com=ZERO))
        child = f"{prefix}_{name}"
        joints.append(Joint(f"{child}_ring", "continuous", ring, child, ZERO, (0, 0, yaw), (0, 1, 0)))
    return links, joints


def _ring_alone() -> Files:
    """The gears of a differential without a car."""
    mount = Joint("diff_ring_world", "continuous", "world", "diff_ring", (0.256, 0.2854, 0.03282), ZERO, (0, 1, 0))
    links, joints = _differential_gear("diff", mount, (2.637, 2.637), 0.0612)
    return place("differential/diff_ring.urdf", model("husky_robot", [Link("world"), *links], joints))


def _differential() -> Files:
    parts = _car_links(True, (0.1, 0.01))
    floor: list[Shape] = [box(0.46, 0.15, 0.05, (0.16, 0, 0))]
    mounts = [
        Joint(f"{prefix}_ring_chassis", "continuous", "chassis", f"{prefix}_ring", (x, 0, 0), ZERO, (0, 1, 0))
        for prefix, x in (("diff", 0.0), ("diff2", 0.32))
    ]
    rear_links, rear_joints = _differential_gear("diff", mounts[0], (0.0637, 0.056), 0.025)
    front_links, front_joints = _differential_gear("diff2", mounts[1], (0.0637, 0.056), 0.025)
    links = [solid("chassis", 4.0, [], looks=BODY, like=floor, com=(0.2, 0, 0)), *(parts[n] for n in (*ORDER, *LAST))]
    rear = [
        Joint(
            f"{side}_rear_wheel_joint", "fixed", f"diff_side{letter}", f"{side}_rear_wheel", (0, y, 0), (1.5708, 0, 0)
        )
        for side, letter, y in (("left", "A", 0.1), ("right", "B", -0.1))
    ]
    joints = [*rear, *_front_joints(), *SENSOR_JOINTS, *rear_joints, *front_joints]
    robot = model("racecar", [*links, *rear_links, *front_links], joints)
    return place("racecar/racecar_differential.urdf", robot)


def files() -> Files:
    return {**_husky(), **_racecar(), **_differential(), **_ring_alone()}
