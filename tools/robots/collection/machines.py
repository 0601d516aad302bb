"""Arms that are no chains of six or seven turning axes: a printed one for the desk, a SCARA, a gantry."""

from __future__ import annotations

from robots.bullet_data.common import box
from robots.collection.common import Entry, Part, frame, link, robot
from robots.description import HALF_PI, UP, ZERO, Box, Cylinder, Joint, Vec3

X: Vec3 = (1.0, 0.0, 0.0)
Y: Vec3 = (0.0, 1.0, 0.0)
HALF_TURN: Vec3 = (3.141592653589793, 0.0, 0.0)  # about x: a tool that points down


def desktop() -> Entry:
    """Five axes and a gripper of one moving jaw, printed, on hobby servos; straight up at zero angles."""

    def printed(shape: Box | Cylinder, colour: str = "yellow") -> Part:
        return Part(shape, "print", colour)

    def servo(at: Vec3) -> Part:
        return Part(box(0.045, 0.035, 0.025, at), "servo", "graphite")

    links = [
        link(
            "base",
            [
                printed(box(0.11, 0.10, 0.012, (-0.02, 0, 0.006))),
                printed(box(0.06, 0.06, 0.048, (0, 0, 0.036))),
                servo((-0.045, 0, 0.03)),
            ],
        ),
        link(
            "link1",
            [
                printed(Cylinder("z", 0.0, 0.014, 0.030)),
                printed(box(0.040, 0.052, 0.056, (0, 0, 0.040))),
                servo((0.0, 0, 0.055)),
            ],
        ),
        link(
            "link2",
            [
                printed(box(0.028, 0.062, 0.030, (0, 0, 0.0))),
                printed(box(0.024, 0.030, 0.116, (0, 0, 0.058))),
                servo((0.0, 0, 0.100)),
            ],
        ),
        link(
            "link3",
            [
                printed(box(0.026, 0.052, 0.028)),
                printed(box(0.022, 0.028, 0.135, (0, 0, 0.0675))),
                servo((0.0, 0, 0.115)),
            ],
        ),
        link("link4", [printed(box(0.026, 0.052, 0.026)), servo((0, 0, 0.030))]),
        link(
            "link5",
            [
                printed(Cylinder("z", 0.0, 0.010, 0.020)),
                servo((0.012, 0, 0.022)),
                printed(Box((-0.012, -0.014, 0.034), (0.0, 0.014, 0.110))),
            ],
            friction=1.0,
        ),
        link(
            "jaw",
            [
                printed(Cylinder("y", -0.016, 0.016, 0.009)),
                printed(Box((-0.030, -0.012, 0.006), (0.0, 0.012, 0.022))),
                printed(Box((-0.030, -0.014, 0.022), (-0.020, 0.014, 0.070))),
            ],
            friction=1.0,
        ),
    ]
    places: list[tuple[Vec3, Vec3, float, float]] = [
        ((0, 0, 0.060), UP, -1.92, 1.92),
        ((0, 0, 0.056), Y, -1.75, 1.75),
        ((0, 0, 0.116), Y, -1.75, 2.60),
        ((0, 0, 0.135), Y, -1.66, 1.75),
        ((0, 0, 0.046), UP, -2.79, 2.79),
    ]
    names = ["base", "link1", "link2", "link3", "link4", "link5"]
    joints = [
        Joint(f"joint{k + 1}", "revolute", names[k], names[k + 1], xyz, ZERO, axis, (low, high, 1.9, 5.0), damping=0.05)
        for k, (xyz, axis, low, high) in enumerate(places)
    ]
    joints.append(
        Joint("jaw_joint", "revolute", "link5", "jaw", (0.030, 0, 0.040), ZERO, Y, (0.0, 1.74, 1.9, 5.0), damping=0.05)
    )
    tool, mount = frame("tool", "link5", (0.012, 0, 0.095), (0, 0, -HALF_PI))  # the jaw opens along y
    home = {"joint1": 0.0, "joint2": -0.4, "joint3": 1.9, "joint4": 1.641593, "joint5": 0.0, "jaw_joint": 0.6}
    return Entry(
        robot("desktop", [*links, tool], [*joints, mount]),
        "arm",
        "printed arm of five axes and a jaw on hobby servos, of the SO-101's class",
        home,
        tool="tool",
        closed={"jaw_joint": 0.0},
        width=(0.0, 0.031),
        payload=0.15,
    )


def scara() -> Entry:
    """Two arms that swing flat, and a quill that goes down and turns."""
    base = [
        Part(box(0.20, 0.20, 0.02, (0, 0, 0.01)), "aluminium", "slate"),
        Part(box(0.13, 0.13, 0.25, (-0.02, 0, 0.145)), "drive", "shell"),
    ]
    arm1 = [
        Part(Cylinder("z", 0.0, 0.070, 0.070), "drive", "shell"),
        Part(box(0.325, 0.090, 0.060, (0.1625, 0, 0.035)), "tube", "shell"),
        Part(Cylinder("z", 0.005, 0.070, 0.058, (0.325, 0, 0)), "tube", "shell"),
        Part(Cylinder("z", 0.070, 0.073, 0.050), "plastic", "accent", seen_only=True),
    ]
    arm2 = [
        Part(Cylinder("z", 0.0, 0.120, 0.058), "drive", "shell"),
        Part(box(0.275, 0.096, 0.130, (0.1375, 0, 0.075)), "tube", "shell"),
        Part(Cylinder("z", 0.0, 0.16, 0.055, (0.275, 0, 0)), "tube", "shell"),
        Part(box(0.16, 0.06, 0.003, (0.14, 0, 0.141)), "plastic", "accent", seen_only=True),
    ]
    quill = [Part(Cylinder("z", -0.06, 0.30, 0.012), "steel", "metal")]
    spindle = [Part(Cylinder("z", -0.020, 0.0, 0.022), "steel", "graphite")]
    links = [link("base", base), link("link1", arm1), link("link2", arm2), link("link3", quill), link("link4", spindle)]
    joints = [
        Joint("joint1", "revolute", "base", "link1", (0, 0, 0.272), ZERO, UP, (-2.27, 2.27, 90.0, 7.0)),
        Joint("joint2", "revolute", "link1", "link2", (0.325, 0, 0.074), ZERO, UP, (-2.53, 2.53, 40.0, 11.0)),
        Joint("joint3", "prismatic", "link2", "link3", (0.275, 0, 0.0), ZERO, UP, (-0.20, 0.0, 250.0, 1.1)),
        Joint("joint4", "revolute", "link3", "link4", (0, 0, -0.060), ZERO, UP, (-6.28, 6.28, 5.0, 20.0)),
    ]
    flange, mount = frame("flange", "link4", (0, 0, -0.020), HALF_TURN)
    home = {"joint1": -0.6, "joint2": 1.4, "joint3": -0.05, "joint4": 0.0}
    about = "SCARA of 600 mm: two flat axes, a stroke of 200 mm and a turn"
    return Entry(robot("scara", [*links, flange], [*joints, mount]), "arm", about, home, "flange", payload=5.0)


def gantry() -> Entry:
    """A bridge over a cell of 1.2 m by 0.9 m: x, y, z and a turn. It stands with its middle over the origin."""
    long, wide, high, beam = 1.2, 0.9, 0.9, 0.06
    posts = [
        Part(box(beam, beam, high, (x, y, high / 2)), "profile", "metal")
        for x in (-long / 2, long / 2)
        for y in (-wide / 2, wide / 2)
    ]
    rails = [
        Part(box(long - beam, beam, beam, (0, y, high - beam / 2)), "profile", "metal") for y in (-wide / 2, wide / 2)
    ]
    ties = [
        Part(box(beam, wide - beam, beam, (x, 0, high - 1.5 * beam)), "profile", "slate") for x in (-long / 2, long / 2)
    ]
    bridge = [
        Part(box(0.08, wide + 0.06, 0.08, (0, 0, 0.045)), "profile", "shell"),
        *(Part(box(0.12, 0.07, 0.05, (0, y, 0.026)), "drive", "graphite") for y in (-wide / 2, wide / 2)),
    ]
    carriage = [
        Part(box(0.05, 0.14, 0.14, (0.067, 0, 0)), "drive", "graphite"),
        Part(box(0.003, 0.08, 0.08, (0.0935, 0, 0)), "plastic", "teal", seen_only=True),
    ]
    column = [
        Part(box(0.05, 0.06, 0.75, (0, 0, 0.275)), "profile", "shell"),
        Part(box(0.07, 0.07, 0.07, (0, 0, -0.135)), "drive", "graphite"),
    ]
    spindle = [Part(Cylinder("z", -0.025, 0.0, 0.032), "aluminium", "metal")]
    links = [
        link("base", [*posts, *rails, *ties]),
        link("bridge", bridge),
        link("carriage", carriage),
        link("column", column),
        link("spindle", spindle),
    ]
    joints = [
        Joint("joint1", "prismatic", "base", "bridge", (0, 0, high), ZERO, X, (-0.45, 0.45, 500.0, 1.5)),
        Joint("joint2", "prismatic", "bridge", "carriage", (0, 0, 0.045), ZERO, Y, (-0.32, 0.32, 300.0, 1.5)),
        Joint("joint3", "prismatic", "carriage", "column", (0.120, 0, 0), ZERO, UP, (-0.65, 0.0, 400.0, 1.0)),
        Joint("joint4", "revolute", "column", "spindle", (0, 0, -0.170), ZERO, UP, (-6.28, 6.28, 10.0, 6.0)),
    ]
    flange, mount = frame("flange", "spindle", (0, 0, -0.025), HALF_TURN)
    home = {"joint1": 0.0, "joint2": 0.0, "joint3": -0.15, "joint4": 0.0}
    about = "gantry over a cell of 1.2 m by 0.9 m: three slides and a turn"
    return Entry(robot("gantry", [*links, flange], [*joints, mount]), "arm", about, home, "flange", payload=10.0)


def entries() -> list[Entry]:
    return [desktop(), scara(), gantry()]
