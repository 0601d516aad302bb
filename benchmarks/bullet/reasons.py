"""Why files of pybullet_data are not loaded as Bullet loads them."""

_COUNT = "numbers in the names of joints that Bullet makes up, where joints of the file have no names"
_REFUSED = "the file is sound"

REASONS: dict[str, str] = {
    "gripper/wsg50_one_motor_gripper_free_base.sdf": _REFUSED,
    "husky/husky.urdf": "$(optenv HUSKY_IMU_XYZ 0.19 0 0.149) stands for its default; Bullet reads 0 0 0.19",
    "kuka_iiwa/model2.sdf": _REFUSED,
    "kuka_iiwa/model_for_sdf.urdf": _REFUSED,
    "mjcf/striker.xml": _COUNT,
    "mjcf/thrower.xml": _COUNT,
    "toys/concave_box.urdf": _REFUSED,
}
