// Loads scenes from MJCF, MuJoCo's file format.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include "manyhands/model/compliance.h"
#include "manyhands/model/io/loaded_model.h"

namespace manyhands {

struct MjcfOptions {
  /// Whether meshes, height fields and included files may lie outside the package (or the folder) of the file.
  bool allow_outside_package = false;
  /// False leaves out all geoms that need a mesh file; masses that would follow from them are then 0.
  bool load_meshes = true;
  /// Which constraints give way by solref and solimp; none by Bullet's rules.
  MjcfCompliance compliance = MjcfCompliance::kStated;
  /// Bullet's rules where they differ: README.md of this layer lists them.
  bool bullet = false;
};

/// Thrown when a file is not a scene that can be loaded: "file:line: what was wrong; expected ...".
class MjcfError : public std::runtime_error {
 public:
  MjcfError(std::string file, int line, const std::string& message);

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] int line() const { return line_; }  ///< 1-based; 0 if the whole file is meant

 private:
  std::string file_;
  int line_;
};

/// Loads an MJCF file. Links, joints, geoms and actuators follow in MuJoCo's order, so that q is MuJoCo's qpos with
/// quaternions turned from wxyz to xyzw; a free joint's v is (angular, linear), both in world axes, a ball joint's is
/// in the joint frame, where MuJoCo has body axes. `Model::initial_configuration` is MuJoCo's qpos0, `Model::time_step`
/// the file's, `Model::keyframes` its keys.
///
/// What cannot be used is defaulted, repaired or left out, and noted in the report; README.md of this layer lists it.
/// Throws FileNotFound, and MjcfError for a file that is malformed or names files outside its folder.
[[nodiscard]] LoadedModel load_mjcf(const std::filesystem::path& path, const MjcfOptions& options = {});

/// The same for a text in memory. `file` names it in messages; `folder` is where its relative paths start.
[[nodiscard]] LoadedModel load_mjcf_string(std::string_view text, const std::string& file = "mjcf",
                                           const std::filesystem::path& folder = ".", const MjcfOptions& options = {});

}  // namespace manyhands
