// Loads robots from URDF files as they are in the wild, PyBullet's extensions included.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "manyhands/model/io/loaded_model.h"

namespace manyhands {

struct UrdfOptions {
  /// True: the root link is fixed to the world. False: it floats by a joint "root_joint", whose q and v come first.
  /// A root link that is called "world" is the world itself and stays fixed.
  bool fixed_base = true;
  /// Where a fixed root link stands in the world.
  Transform<double> base_pose = Transform<double>::identity();
  /// Where packages lie: a package's own folder, or a folder that holds it. Searched before ROS_PACKAGE_PATH,
  /// AMENT_PREFIX_PATH and the folders above the file.
  std::vector<std::filesystem::path> package_paths{};
  /// Whether meshes may lie outside the package (or the file's folder) that they are looked up in.
  bool allow_outside_package = false;
  /// False leaves out all geoms that need a mesh file.
  bool load_meshes = true;
  /// Whether the robot's links touch each other, joint neighbours excepted; PyBullet's default is no.
  bool self_collision = false;
  /// Bullet's rules where they differ: README.md of this layer lists them.
  bool bullet = false;
  /// Whether links keep the order of the file, but for parents, which come first.
  bool file_order = false;
  /// By which lengths are multiplied: of origins, shapes and the ranges of prismatic joints. Masses stay as they are.
  double scale = 1;
};

/// Thrown when a file is not a robot that can be loaded: "file:line: what was wrong; expected ...".
class UrdfError : public std::runtime_error {
 public:
  UrdfError(std::string file, int line, const std::string& message);

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] int line() const { return line_; }  ///< 1-based; 0 if the whole file is meant

 private:
  std::string file_;
  int line_;
};

/// Loads a URDF file. Unless options say otherwise, links follow one another depth first from the root, children in the
/// order of their joints in the file: the order of PyBullet's link indices. Units and frames are URDF's own (SI, rpy
/// about fixed axes).
///
/// What cannot be used or simulated as it stands is defaulted, repaired or left out, and noted in the report: for
/// example a mesh that is missing (its geom is dropped), or an inertia that no rigid body can have.
/// Throws FileNotFound, and UrdfError for a file that is malformed or whose meshes lie outside their package.
[[nodiscard]] LoadedModel load_urdf(const std::filesystem::path& path, const UrdfOptions& options = {});

/// The same for a text in memory. `file` names it in messages; `folder` is where its relative paths start.
[[nodiscard]] LoadedModel load_urdf_string(std::string_view text, const std::string& file = "urdf",
                                           const std::filesystem::path& folder = ".", const UrdfOptions& options = {});

}  // namespace manyhands
