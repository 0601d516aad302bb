// Saves models as MJCF and URDF.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include "manyhands/model/load_report.h"
#include "manyhands/model/model.h"

namespace manyhands {

struct SaveOptions {
  /// Whether to write a file that moves or touches otherwise than the model; else that is a SaveError.
  bool allow_loss = false;
};

/// Thrown when a format cannot say what the model is, or a file cannot be written; the message says what and why.
class SaveError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct SavedText {  ///< what was written, and what had to be said otherwise
  std::string text;
  LoadReport
      report;  ///< what is said otherwise (kRepaired) and left out (kIgnored); the model's numbers stay as they are
};

/// Writes an MJCF file that `load_mjcf` reads as the same model, to the last bit where MJCF can say it, and MuJoCo as
/// the same scene. Numbers have the fewest digits that are read back as the same double, angles are in radians, masses
/// explicit. Rotations are quaternions: a rotation that none gives to the bit is off by 1e-15 once, and never again.
///
/// Meshes, as OBJ, and images go to the folder STEM_assets beside the file. Each file appears whole or not at all; only
/// `path` itself is overwritten: an asset whose name is taken by another content gets a number.
/// Returns what is said otherwise or left out. Throws SaveError.
LoadReport save_mjcf(const Model& model, const std::filesystem::path& path, const SaveOptions& options = {});

/// The same as a text that needs no other files: meshes lie in it, images are left out.
[[nodiscard]] SavedText save_mjcf_string(const Model& model, const SaveOptions& options = {});

/// Writes a URDF file: a tree of links, their masses, shapes, joints and mimics, PyBullet's <contact> where a surface
/// is not the default. One root that stands at the world's origin, or floats, is the file's; else a link "world" is.
/// What URDF cannot say (loops, actuators, armature, planes, ball joints ...) is a SaveError, or with allow_loss left
/// out. Meshes and images as with `save_mjcf`. Returns what is said otherwise or left out.
LoadReport save_urdf(const Model& model, const std::filesystem::path& path, const SaveOptions& options = {});

/// The same as a text; of meshes, which it cannot hold, shapes that touch are a loss.
[[nodiscard]] SavedText save_urdf_string(const Model& model, const SaveOptions& options = {});

}  // namespace manyhands
