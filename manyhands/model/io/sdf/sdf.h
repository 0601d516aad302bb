// Loads models and worlds from SDF, the format of Gazebo, and the older files that Bullet ships.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "manyhands/model/io/loaded_model.h"

namespace manyhands {

struct SdfOptions {
  /// Where models and packages lie: the folder itself, or one that holds it. Searched before GZ_SIM_RESOURCE_PATH,
  /// GAZEBO_MODEL_PATH, ROS_PACKAGE_PATH, AMENT_PREFIX_PATH and the folders above the file.
  std::vector<std::filesystem::path> package_paths{};
  /// Whether meshes and included files may lie outside the package (or the folder) of the file that names them.
  bool allow_outside_package = false;
  /// False leaves out all geoms that need a mesh file.
  bool load_meshes = true;
  /// Bullet's rules in place of Gazebo's: a friction of 0.5 unless <contact> says otherwise, combined by the product;
  /// <surface> and the <pose> of joints do not count. Gazebo's are a friction of 1, combined by the minimum.
  bool bullet = false;
};

/// Thrown when a file holds no models that can be loaded: "file:line: what was wrong; expected ...".
class SdfError : public std::runtime_error {
 public:
  SdfError(std::string file, int line, const std::string& message);

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] int line() const { return line_; }  ///< 1-based; 0 if the whole file is meant

 private:
  std::string file_;
  int line_;
};

/// Loads an SDF file (versions 1.4 to 1.12): one model for each <model> and <include> of it and of its <world>, at its
/// place in the world and with the world's gravity and time step. Links follow depth first from the roots, children in
/// the order of their joints. A root link floats by a joint "LINK_free"; static models, and roots without mass, stand
/// in the world. Models in models are part of the outer one, their names "inner::name".
///
/// What cannot be used is defaulted, repaired or left out, and noted in the report of its model; README.md of this
/// layer lists it. What is noted of the world stands in the first model's report. Throws FileNotFound, and SdfError for
/// a file that is malformed or names files outside its package.
[[nodiscard]] std::vector<LoadedModel> load_sdf(const std::filesystem::path& path, const SdfOptions& options = {});

/// The same for a text in memory. `file` names it in messages; `folder` is where its relative paths start.
[[nodiscard]] std::vector<LoadedModel> load_sdf_string(std::string_view text, const std::string& file = "sdf",
                                                       const std::filesystem::path& folder = ".",
                                                       const SdfOptions& options = {});

/// The models of a file as one, with all notes. Of several, parts are called "MODEL/part".
[[nodiscard]] LoadedModel joined(std::vector<LoadedModel> models);

}  // namespace manyhands
