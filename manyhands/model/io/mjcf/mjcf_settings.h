// What <compiler> and <option> say, the default classes, and how poses are read under them.
#pragma once

#include <array>
#include <string>

#include "manyhands/math/quaternion.h"
#include "manyhands/model/io/mjcf/mjcf_element.h"

namespace manyhands::io {

/// A limit that is none, where a range needs both: MuJoCo's largest number (mjMAXVAL).
inline constexpr double kMjcfUnlimited = 1e10;

/// What <flag> turns off, of what is there by default.
struct MjcfFlags {
  bool contact = true, equality = true, friction_loss = true, limit = true, gravity = true;
  bool spring = true, damper = true, actuation = true, clamp_ctrl = true, filter_parent = true;

  /// MuJoCo's gravity compensation and drag go with the last of them.
  [[nodiscard]] bool has_passive() const { return spring || damper; }
};

struct MjcfSettings {
  bool degrees = true;
  std::string euler_sequence = "xyz";
  bool autolimits = true;
  std::string mesh_folder, texture_folder;
  bool strip_path = false;
  enum class FromGeoms { kNever, kAlways, kWhereMissing } inertia_from_geoms = FromGeoms::kWhereMissing;
  std::array<int, 2> inertia_groups{0, 5};
  bool balance_inertia = false;
  double bound_mass = 0, bound_inertia = 0;
  double total_mass = -1;  ///< negative: as it comes
  double time_step = 0.002;
  Vec3<double> gravity{0, 0, -9.81};
  Medium medium{};
  bool fit_to_box = false;  ///< shapes fitted to meshes are as large as their box; else they have their inertia
  bool is_global = false;   ///< poses are in the world's frame, where all joints are at 0
  bool align_free = false;  ///< the frames of free bodies become their principal axes
  MjcfFlags flags;

  [[nodiscard]] double radians(double angle) const;
};

/// Reads all <compiler> sections, of the main model the <option> sections, too; what they ask for and is not done is
/// noted.
[[nodiscard]] MjcfSettings read_settings(const MjcfElement& root);

/// Reads all <default> sections of a model.
void read_classes(const MjcfElement& root, MjcfClasses& classes);

/// Whether the element or its class says how it is turned.
[[nodiscard]] bool has_rotation(const MjcfElement& element);
/// quat (wxyz), axisangle, euler, xyaxes or zaxis; the identity without any. Fails on two of them.
[[nodiscard]] Mat3<double> read_rotation(const MjcfElement& element, const MjcfSettings& settings);
/// The rotation of three Euler angles, in the file's unit and sequence.
[[nodiscard]] Mat3<double> rotation_from_euler(const Vec3<double>& angles, const MjcfSettings& settings);
/// What is written in frame F of frame A. Its rotation is one that a quaternion gives to the bit, so that it can be
/// saved.
[[nodiscard]] Transform<double> placed_in(const Transform<double>& X_AF, const Transform<double>& X_FB);
/// pos and rotation.
[[nodiscard]] Transform<double> read_pose(const MjcfElement& element, const MjcfSettings& settings);
/// The rotation of four numbers wxyz, which must not all be 0: the only place where MJCF's order is undone.
[[nodiscard]] Quat<double> quat_from_wxyz(const MjcfElement& element, const double* wxyz);
/// The smallest rotation that takes z along `direction`; half a turn about x if it is -z.
[[nodiscard]] Mat3<double> rotation_from_z(const Vec3<double>& direction);

}  // namespace manyhands::io
