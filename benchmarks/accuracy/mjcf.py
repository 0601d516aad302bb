"""A scene as MJCF text, which MuJoCo and manyhands both read."""

from collections.abc import Iterable
from dataclasses import dataclass

from benchmarks.accuracy.scene import ORIGIN, UPRIGHT, Body, Geom, Quaternion, Scene


@dataclass(frozen=True)
class Options:
    """What only MuJoCo reads: its contact model and solver."""

    time_step: float = 0.002
    integrator: str = "implicitfast"
    cone: str = "elliptic"
    impratio: float = 1.0
    iterations: int = 100
    noslip: int = 0
    tolerance: float = 1e-8
    solref: str = ""  # of every geom
    solimp: str = ""
    loop_solref: str = ""
    multiccd: bool = False
    servos: bool = False  # written as position actuators: manyhands and PyBullet have motors for them


def numbers(values: Iterable[float]) -> str:
    """With all digits."""
    return " ".join(repr(float(v)) for v in values)


def wxyz(quat: Quaternion) -> str:
    """MJCF's order."""
    return numbers((quat[3], *quat[:3]))


def mjcf(scene: Scene, options: Options | None = None) -> str:
    """The document."""
    o = options or Options()
    flags = "" if scene.contacts else '<flag contact="disable"/>'
    if o.multiccd:
        flags = flags or '<flag multiccd="enable"/>'
    lines = [
        '<mujoco model="accuracy">',
        '<compiler angle="radian" autolimits="true"/>',
        f'<option timestep="{o.time_step!r}" gravity="{numbers(scene.gravity)}" integrator="{o.integrator}" '
        f'cone="{o.cone}" impratio="{o.impratio!r}" iterations="{o.iterations}" tolerance="{o.tolerance!r}" '
        f'noslip_iterations="{o.noslip}" noslip_tolerance="1e-10">{flags}</option>',
        *assets(scene),
        "<worldbody>",
        *(line for body in scene.bodies for line in body_lines(body, o)),
        "</worldbody>",
        *contact_lines(scene, o),
        *loop_lines(scene, o),
        *motor_lines(scene, o),
        "</mujoco>",
    ]
    return "\n".join(lines) + "\n"


def assets(scene: Scene) -> list[str]:
    """The hulls, one mesh each."""
    meshes = [
        f'<mesh name="{mesh_name(body, k)}" vertex="{numbers(x for vertex in geom.vertices for x in vertex)}"/>'
        for body, _ in scene.walk()
        for k, geom in enumerate(body.geoms)
        if geom.shape == "hull"
    ]
    return ["<asset>", *meshes, "</asset>"] if meshes else []


def mesh_name(body: Body, k: int) -> str:
    """Of the k-th geom, a hull."""
    return f"{body.name}_hull{k}"


def body_lines(body: Body, o: Options) -> list[str]:
    """A body, its joint, inertia, geoms and children; what is fixed to the world has no inertia."""
    place = "" if body.pos == ORIGIN else f' pos="{numbers(body.pos)}"'
    place += "" if body.quat == UPRIGHT else f' quat="{wxyz(body.quat)}"'
    lines = [f'<body name="{body.name}"{place}>']
    if body.joint == "free":
        lines.append(f'<freejoint name="{body.name}"/>')
    elif body.joint != "fixed":
        axis = "" if body.joint == "ball" else f' axis="{numbers(body.axis)}"'
        damping = "" if body.damping == 0 else f' damping="{body.damping!r}"'
        lines.append(f'<joint name="{body.name}" type="{body.joint}"{axis}{damping}/>')
    if body.mass > 0:
        lines.append(
            f'<inertial pos="{numbers(body.com)}" mass="{body.mass!r}" diaginertia="{numbers(body.moments)}"/>'
        )
    lines += [geom_line(body, k, geom, o) for k, geom in enumerate(body.geoms)]
    for child in body.children:
        lines += body_lines(child, o)
    return [*lines, "</body>"]


def geom_line(body: Body, k: int, geom: Geom, o: Options) -> str:
    """One shape with its friction."""
    name = f' name="{body.name}"' if k == 0 else ""
    if geom.shape == "hull":
        shape = f'type="mesh" mesh="{mesh_name(body, k)}"'
    elif geom.shape == "plane":
        shape = 'type="plane" size="0 0 1"'
    else:
        shape = f'type="{geom.shape}" size="{numbers(geom.size)}"'
    place = "" if geom.pos == ORIGIN else f' pos="{numbers(geom.pos)}"'
    place += "" if geom.quat == UPRIGHT else f' quat="{wxyz(geom.quat)}"'
    dimensions = 6 if geom.roll > 0 else 4 if geom.spin > 0 else 1 if geom.friction == 0 else 3
    soft = f' solref="{o.solref}"' if o.solref else ""
    soft += f' solimp="{o.solimp}"' if o.solimp else ""
    friction = numbers((geom.friction, geom.spin, geom.roll))
    return f'<geom{name} {shape}{place} condim="{dimensions}" friction="{friction}"{soft}/>'


def contact_lines(scene: Scene, o: Options) -> list[str]:
    """Pairs of the first geoms, with a friction of their own."""
    soft = f' solref="{o.solref}"' if o.solref else ""
    soft += f' solimp="{o.solimp}"' if o.solimp else ""
    pairs = [
        f'<pair geom1="{p.first}" geom2="{p.second}" condim="3" '
        f'friction="{numbers((p.friction, p.friction, 0, 0, 0))}"{soft}/>'
        for p in scene.pairs
    ]
    return ["<contact>", *pairs, "</contact>"] if pairs else []


def loop_lines(scene: Scene, o: Options) -> list[str]:
    """Closed loops: each a point held. MJCF gives the point in the first body; where they coincide says the rest."""
    soft = f' solref="{o.loop_solref}"' if o.loop_solref else ""
    loops = [
        f'<connect body1="{loop.first}" body2="{loop.second}" anchor="{numbers(loop.point)}"{soft}/>'
        for loop in scene.loops
    ]
    loops += [f'<joint joint1="{m.first}" joint2="{m.second}" polycoef="0 1 0 0 0"{soft}/>' for m in scene.mimics]
    return ["<equality>", *loops, "</equality>"] if loops else []


def motor_lines(scene: Scene, o: Options) -> list[str]:
    """Position actuators."""
    motors = [f'<position name="{m.body}" joint="{m.body}" kp="{m.kp!r}"/>' for m in scene.motors]
    if o.servos:
        motors += [
            f'<position name="{s.body}" joint="{s.body}" kp="{s.kp!r}" kv="{s.kv!r}" '
            f'forcelimited="true" forcerange="{-s.most!r} {s.most!r}"/>'
            for s in scene.servos
        ]
    return ["<actuator>", *motors, "</actuator>"] if motors else []
