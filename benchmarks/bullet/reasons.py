"""Why files of pybullet_data are not loaded as Bullet loads them."""

_MIDDLE = (
    "Bullet takes the middle of the last geom that has a fromto for a body's centre of mass, and puts a free base's "
    "where the file has its frame; here it is where the mass is"
)
_REFUSED = "the file is sound"

REASONS: dict[str, str] = {
    "gripper/wsg50_one_motor_gripper_free_base.sdf": _REFUSED,
    "husky/husky.urdf": "$(optenv HUSKY_IMU_XYZ 0.19 0 0.149) stands for its default; Bullet reads 0 0 0.19",
    "kuka_iiwa/model2.sdf": _REFUSED,
    "kuka_iiwa/model_for_sdf.urdf": _REFUSED,
    "mjcf/humanoid_fixed.xml": "a joint of type fixed, which MJCF has not, makes one body of two here",
    "toys/concave_box.urdf": _REFUSED,
} | {
    f"mjcf/{name}.xml": _MIDDLE
    for name in (
        "half_cheetah",
        "humanoid",
        "humanoid_symmetric",
        "humanoid_symmetric_no_ground",
        "pusher",
        "striker",
        "thrower",
    )
}
