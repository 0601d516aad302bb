"""Every file of PyBullet's data folder beside PyBullet: names, types, order, limits, masses and places.

PyBullet's numbers went through 32 bits.
"""

import math
import warnings

import numpy as np
import pytest

import manyhands as mh

pytest.importorskip("pybullet")
pytest.importorskip("pybullet_data")
bullet_files = pytest.importorskip("bullet_files")

TYPES = {0: ("revolute", "continuous"), 1: ("prismatic",), 2: ("spherical",), 3: ("planar",), 4: ("fixed",)}
BULLETS_OWN = {  # where Bullet is not followed
    "husky/husky.urdf": "imu_link",  # its place is a $(optenv ...), of which Bullet reads other numbers
}
FALLBACK = 10.0  # [kg], which Bullet gives to the feet of half_cheetah.xml, whatever their geoms
TOLERANCE = 2e-5  # [m, kg relative]: of 32 bits after chains of rotations


def loaded(path: str) -> list[mh.Model]:
    file = bullet_files.ROOT / path
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mh.LoadWarning)  # of meshes that are not there
        if path.endswith(".urdf"):
            return [mh.load_urdf(file, fixed_base=False, bullet=True)[0]]
        if path.endswith(".sdf"):
            return [model for model, _ in mh.load_sdf(file, bullet=True)]
        return [mh.load_mjcf(file, bullet=True)[0]]


def expect_limits(joint: mh.Joint, theirs) -> None:
    lower, upper = theirs[8], theirs[9]
    if lower > upper or joint.type == "continuous":  # none
        assert math.isinf(joint.lower) or joint.type == "continuous", joint.name
    else:
        assert (joint.lower, joint.upper) == pytest.approx((lower, upper), abs=1e-5), joint.name
    if theirs[10] > 0:
        assert joint.effort == pytest.approx(theirs[10], rel=1e-6), joint.name


def expect_same(model: mh.Model, body, path: str) -> None:
    links = model.links[1:]
    theirs = [body.base, *(joint[12].decode() for joint in body.joints)]
    ours = ["world" if link.name == "world_" else link.name for link in links]
    assert ours == theirs
    joints = [joint for joint in model.joints if joint.type != "floating"]  # the root's own
    assert [joint.name for joint in joints] == [joint[1].decode() for joint in body.joints]
    for joint, info in zip(joints, body.joints, strict=True):
        assert joint.type in TYPES[info[2]], joint.name
        if info[2] in (0, 1):
            expect_limits(joint, info)
        assert joint.damping == pytest.approx(max(info[6], 0), rel=1e-6), joint.name
    for link, mass in zip(links, body.masses, strict=True):
        if mass > 0:  # a fixed base has none there
            assert link.mass == pytest.approx(mass, rel=TOLERANCE), link.name
    for i, shapes in enumerate(body.shapes):
        touching = [geom for geom in model.geoms if geom.link == i + 1 and not geom.is_visual]
        solid = [geom for geom in touching if geom.shape not in ("mesh", "convex")]
        expected = [(kind, sizes) for kind, sizes in shapes if all(x > 0 for x in sizes)]
        assert [geom.shape for geom in solid] == [kind for kind, _ in expected], ours[i]
        for geom, (_, sizes) in zip(solid, expected, strict=True):
            assert geom.size[: len(sizes)] == pytest.approx(sizes, rel=1e-5), ours[i]
    world = mh.World(model)
    for joint, state in zip(body.joints, body.links, strict=True):
        name = joint[12].decode()
        if name == BULLETS_OWN.get(path):
            continue
        position, quaternion = world.body_pose(name)
        assert np.allclose(position, state[4], atol=TOLERANCE), joint[12]
        assert min(np.abs(quaternion - state[5]).max(), np.abs(quaternion + state[5]).max()) < 1e-3, joint[12]


@pytest.mark.parametrize("path", [*bullet_files.files("urdf"), *bullet_files.files("sdf")])
def test_robots_load_as_in_bullet(path: str) -> None:
    bodies = bullet_files.bullet_bodies(path)
    if isinstance(bodies, str):
        try:
            loaded(path)
        except ValueError as error:
            assert path in str(error)  # one clear line
        pytest.skip(f"PyBullet: {bodies}")
    models = loaded(path)
    assert len(models) == len(bodies)
    for model, body in zip(models, bodies, strict=True):
        expect_same(model, body, path)


@pytest.mark.parametrize("path", bullet_files.files("xml"))
def test_scenes_load_as_in_bullet(path: str) -> None:
    """Bullet adds fixed joints, and links between joints, of its own."""
    bodies = bullet_files.bullet_bodies(path)
    assert not isinstance(bodies, str)
    (model,) = loaded(path)
    ours = [joint for joint in model.joints if joint.type not in ("fixed", "floating")]
    theirs = [joint for body in bodies for joint in body.joints if joint[2] != 4]
    assert [joint.name for joint in ours] == [joint[1].decode() for joint in theirs]
    for joint, info in zip(ours, theirs, strict=True):
        assert joint.type in TYPES[info[2]]
        expect_limits(joint, info)
    masses = [mass for body in bodies for mass in body.masses if mass > 0]
    ours_masses = [link.mass for link in model.links if link.mass > 0]
    assert len(ours_masses) == len(masses)
    pairs = [(a, b) for a, b in zip(ours_masses, masses, strict=True) if b != FALLBACK]
    assert [a for a, _ in pairs] == pytest.approx([b for _, b in pairs], rel=1e-5)
