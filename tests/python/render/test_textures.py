"""Images on surfaces: of worlds, batches and environments, from arrays, rules and files."""

import math
import resource
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

import manyhands as mh
from manyhands.envs import ArmEnv

RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def cube_world() -> mh.World:
    world = mh.World()
    world.add_box("cube", [0.1, 0.1, 0.1], position=[0, 0, 0.5], colour=[0.7, 0.7, 0.7])
    world.add_box("other", [0.1, 0.1, 0.1], position=[1, 0, 0.5], colour=[0.7, 0.7, 0.7])
    return world


def front(size: int = 32) -> mh.Camera:
    """Sees the cube's face towards -y, and nothing else."""
    return mh.Camera.orthographic(size, size, 0.19).look_at([0, -2, 0.5], [0, 0, 0.5])


def halves() -> NDArray[np.uint8]:
    """Red above blue."""
    image = np.zeros((8, 4, 3), np.uint8)
    image[:4, :, 0] = image[4:, :, 2] = 255
    return image


def dominant(picture: NDArray[Any]) -> NDArray[Any]:
    return picture.astype(int).argmax(axis=-1)


def test_an_image_lies_upright_on_what_is_named() -> None:
    world = cube_world()
    colour = world.render(front(), textures={"cube": mh.Texture(halves())}).colour
    assert (dominant(colour[:14]) == 0).all() and (dominant(colour[18:]) == 2).all()
    stripes = mh.Texture.stripes(RED, BLUE, repeat=(2, 1))
    colour = world.render(front(), textures={"cube": stripes}).colour
    assert dominant(colour[16])[[4, 12, 20, 28]].tolist() == [0, 2, 0, 2]
    np.testing.assert_array_equal(
        world.render(front(), textures={"other": stripes}).colour, world.render(front()).colour
    )
    with pytest.raises(KeyError, match=r"'cub'.*'cube' 'other'"):
        world.render(front(), textures={"cub": stripes})


def test_a_link_names_all_its_geoms() -> None:
    model, _ = mh.load_urdf(mh.asset_path("panda/panda.urdf"))
    camera = mh.Camera.perspective(80, 60, math.radians(50)).orbit([0.2, 0, 0.4], 1.6, 0.8, -0.3)
    look = mh.Look(shadows=False)
    plain = mh.World(model).render(camera, look=look)
    textured = mh.World(model).render(camera, look=look, textures={"panda_link3": mh.Texture.checker(RED, BLUE)})
    there = plain.segmentation == next(i for i, link in enumerate(model.links) if link.name == "panda_link3")
    changed = (plain.colour != textured.colour).any(axis=2)
    assert there.sum() > 20 and changed[there].mean() > 0.9 and not changed[~there].any()


def test_each_picture_may_have_its_own() -> None:
    model = cube_world().model
    batch = mh.Batch(model, 2)
    red, blue = (mh.Texture(np.full((1, 1, 3), colour, np.uint8)) for colour in ((255, 0, 0), (0, 0, 255)))
    both = batch.render(front(4), textures=[{"cube": red}, {"cube": blue}]).colour
    assert dominant(both).reshape(2, -1).tolist() == [[0] * 16, [2] * 16]
    renderer = mh.Renderer(model, 1)
    np.testing.assert_array_equal(
        renderer.render(batch.q[1].astype(np.float64), front(4), textures={"cube": blue}).colour, both[1]
    )
    with pytest.raises(ValueError, match="textures: 1 are given for 2"):
        batch.render(front(4), textures=[{"cube": red}])


def test_noise_is_its_seeds() -> None:
    pictures = [
        cube_world().render(front(), textures={"cube": mh.Texture.noise(RED, BLUE, seed)}).colour for seed in (1, 1, 2)
    ]
    np.testing.assert_array_equal(pictures[0], pictures[1])
    assert (pictures[0] != pictures[2]).mean() > 0.5


def test_files_are_read(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    image.fromarray(halves()).save(tmp_path / "halves.png")
    texture = mh.load_texture(tmp_path / "halves.png", repeat=2)
    assert list(texture.size) == [4, 8] and list(texture.repeat) == [2, 2]
    world = cube_world()
    np.testing.assert_array_equal(
        world.render(front(), textures={"cube": texture}).colour,
        world.render(front(), textures={"cube": mh.Texture(halves(), 2)}).colour,
    )
    image.new("RGBA", (2, 2), (0, 0, 0, 0)).save(tmp_path / "clear.png")
    white = world.render(front(), textures={"cube": mh.load_texture(tmp_path / "clear.png")}).colour
    np.testing.assert_array_equal(
        white, world.render(front(), textures={"cube": mh.Texture(np.full((2, 2, 3), 255, np.uint8))}).colour
    )
    (tmp_path / "text.png").write_text("no image")
    with pytest.raises(ValueError, match="no image"):
        mh.load_texture(tmp_path / "text.png")
    with pytest.raises(FileNotFoundError):
        mh.load_texture(tmp_path / "nowhere.png")


@pytest.mark.parametrize(
    ("image", "repeat", "message"),
    [
        (np.zeros((2, 2), np.uint8), 1, "expected .height, width, 3."),
        (np.zeros((2, 2, 4), np.uint8), 1, "expected .height, width, 3."),
        (np.zeros((2, 2, 3), np.float32), 1, "of uint8"),
        (np.zeros((0, 2, 3), np.uint8), 1, "1 to 4096"),
        (np.zeros((1, 4097, 3), np.uint8), 1, "1 to 4096"),
        (halves(), 0, "repeated"),
        (halves(), (1, math.nan), "repeated"),
    ],
)
def test_textures_that_cannot_be(image: Any, repeat: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        mh.Texture(image, repeat)


def test_strides_of_an_image_do_not_matter() -> None:
    image = np.random.default_rng(0).integers(0, 256, (6, 5, 3), np.uint8)
    for view in (image[::-1, ::2], image.transpose(1, 0, 2), image[..., ::-1]):
        pictures = [
            cube_world().render(front(), textures={"cube": mh.Texture(each)}).colour
            for each in (view, np.ascontiguousarray(view))
        ]
        np.testing.assert_array_equal(*pictures)


def pictures_of(task: str, vary: dict[str, Any], **options: Any) -> dict[str, NDArray[Any]]:
    cameras = {"front": {"vary": vary, "segmentation": True}}
    envs = gymnasium.make_vec(task, num_envs=4, cameras=cameras, **options)
    observation, _ = envs.reset(seed=3)
    return observation


def test_textures_of_environments_vary_from_episode_to_episode() -> None:
    plain, varied = pictures_of("PandaPush-v3", {}), pictures_of("PandaPush-v3", {"texture": 1.0})
    np.testing.assert_array_equal(
        varied["front"], pictures_of("PandaPush-v3", {"texture": 1.0}, num_threads=2)["front"]
    )
    np.testing.assert_array_equal(varied["front_segmentation"], plain["front_segmentation"])
    alone, _ = gymnasium.make(
        "PandaPush-v3", cameras={"front": {"vary": {"texture": 1.0}, "segmentation": True}}
    ).reset(seed=3 + 2)
    np.testing.assert_array_equal(varied["front"][2], alone["front"])
    changed = (varied["front"] != plain["front"]).any(axis=3)
    links = plain["front_segmentation"]
    # The world's table and floor and the object, which is the last link, but nothing of the arm; goals lie over both.
    is_thing = (links == 0) | (links == links.max())
    assert changed[is_thing].mean() > 0.8  # far off, the floor fades
    assert changed[(links > 0) & (links < links.max())].mean() < 0.01
    for i in range(3):
        assert np.abs(varied["front"][i].astype(int) - varied["front"][i + 1]).mean() > 8


def test_textures_of_environments_are_those_given() -> None:
    vary = {"texture": 1.0, "textures": [mh.Texture(np.full((1, 1, 3), (255, 0, 255), np.uint8))]}
    seen = pictures_of("PandaReach-v3", vary)
    table = seen["front"][seen["front_segmentation"] == 0].astype(int)
    assert (
        np.mean((table[:, 0] > table[:, 1] + 60) & (table[:, 2] > table[:, 1] + 60)) > 0.75
    )  # far off, the floor fades
    some = pictures_of("PandaReach-v3", {"texture": 0.3})["front"]
    assert (some == pictures_of("PandaReach-v3", {})["front"]).all(axis=(1, 2, 3)).any()


def test_dice_stay_dice() -> None:
    """Where a rotation is the goal, one must see how the cube is turned."""
    plain, varied = pictures_of("PandaFlip-v3", {}), pictures_of("PandaFlip-v3", {"texture": 1.0})
    links = plain["front_segmentation"]
    np.testing.assert_array_equal(plain["front"][links == links.max()], varied["front"][links == links.max()])


@pytest.mark.parametrize("vary", [{"texture": 1.5}, {"texture": -0.1}, {"textures": [mh.Texture(halves())]}])
def test_textures_that_cannot_vary_so(vary: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"vary|chance"):
        ArmEnv(cameras={"front": {"vary": vary}})


URDF = """<robot name="crate"><link name="crate">
  <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  <visual><origin xyz="0 0 0.5"/><geometry><box size="0.2 0.2 0.2"/></geometry>
    <material name="m"><texture filename="halves.png"/></material></visual></link></robot>"""

MJCF = """<mujoco><asset><texture name="grid" type="2d" builtin="checker" rgb1="1 0 0" rgb2="0 0 1"/>
  <material name="floor" texture="grid" texrepeat="2 2" texuniform="true"/></asset>
  <worldbody><geom name="floor" type="plane" size="0 0 1" material="floor"/></worldbody></mujoco>"""


def test_a_urdf_shows_its_images(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    image.fromarray(halves()).save(tmp_path / "halves.png")
    (tmp_path / "crate.urdf").write_text(URDF)
    model, report = mh.load_urdf(tmp_path / "crate.urdf")
    assert not report.notes
    assert model.geoms[0].texture == str(tmp_path.resolve() / "halves.png")
    expected = cube_world().render(front(), textures={"cube": mh.Texture(halves())}, look=mh.Look(shadows=False))
    world = mh.World(model)
    colour = world.render(front(), look=mh.Look(shadows=False)).colour
    assert (dominant(colour[:14]) == 0).all() and (dominant(colour[18:]) == 2).all()
    np.testing.assert_array_equal(dominant(colour), dominant(expected.colour))
    np.testing.assert_array_equal(mh.Batch(model, 2).render(front(), look=mh.Look(shadows=False)).colour[1], colour)
    renderer = mh.Renderer(model, 1)
    np.testing.assert_array_equal(renderer.render(world.q, front(), look=mh.Look(shadows=False)).colour, colour)
    other = world.render(front(), textures={"crate": mh.Texture.checker(BLUE, BLUE)}).colour
    assert (dominant(other) == 2).all()


def test_an_image_that_cannot_be_read_is_a_warning(tmp_path: Path) -> None:
    (tmp_path / "crate.urdf").write_text(URDF)
    model, report = mh.load_urdf(tmp_path / "crate.urdf")
    assert "halves.png" in str(report) and model.geoms[0].texture == ""
    plain = mh.World(model).render(front()).colour
    (tmp_path / "halves.png").write_bytes(b"no image")
    model, report = mh.load_urdf(tmp_path / "crate.urdf")
    assert not report.notes
    with pytest.warns(UserWarning, match=r"not shown: .*halves\.png is no image"):
        colour = mh.World(model).render(front()).colour
    np.testing.assert_array_equal(colour, plain)


def test_a_checker_floor_of_mjcf() -> None:
    model, _ = mh.load_mjcf_string(MJCF)
    assert model.geoms[0].texture == "checks"
    camera = mh.Camera.orthographic(40, 40, 2).look_at([0, 0, 1], [0, 0, 0], up=[0, 1, 0])
    colour = dominant(mh.World(model).render(camera, look=mh.Look(shadows=False)).colour)
    # The image of 2 x 2 squares twice on every 2 m: squares of 0.5 m, ten pixels wide.
    squares = colour[5::10, 5::10]
    np.testing.assert_array_equal(squares, 2 * (np.indices((4, 4)).sum(axis=0) % 2))


def test_images_that_are_too_large_take_no_memory(tmp_path: Path) -> None:
    Image.new("1", (13000, 13000)).save(tmp_path / "large.png")
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(ValueError, match="13000 x 13000 pixels; expected at most 4096"):
        mh.load_texture(tmp_path / "large.png")
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 50_000  # kB


def test_no_other_program_is_asked(tmp_path: Path) -> None:
    """Pillow has Ghostscript read these."""
    (tmp_path / "page.eps").write_text("%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 10 10\n")
    with pytest.raises(ValueError, match="no image that can be read; formats are PNG"):
        mh.load_texture(tmp_path / "page.eps")


def test_a_damaged_image_is_told_to_be_one(tmp_path: Path) -> None:
    Image.new("RGB", (64, 64), "red").save(tmp_path / "half.png")
    whole = (tmp_path / "half.png").read_bytes()
    (tmp_path / "half.png").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ValueError, match="damaged image"):
        mh.load_texture(tmp_path / "half.png")
