// The contents of an SDF file before they become models, and the functions that read them.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "manyhands/model/description.h"
#include "manyhands/model/io/sdf/sdf.h"
#include "manyhands/model/io/sdf/sdf_frames.h"

namespace manyhands::io {

struct SdfGeom {
  SdfElement source;  ///< the <visual> or <collision>
  Geom geom{};        ///< its link, place and mesh still unset
  SdfPose pose{};
  std::string mesh_file{};
  Vec3<double> mesh_scale{1, 1, 1};
  bool is_concave = false;  ///< by Bullet's attribute: its triangles touch, not its hulls
  std::string texture_file{};
  std::optional<Vec3<double>> ellipsoid{};  ///< half axes [m]
};

struct SdfLink {
  SdfElement source;
  std::string name;  ///< in the model: "hand", "arm::hand"
  std::string scope;
  std::string key;
  Inertial inertial{};
  double gravity_compensation = 0;
  std::vector<SdfGeom> geoms{};
};

struct SdfAxis {
  SdfElement source;
  Vec3<double> xyz{0, 0, 1};
  std::string expressed_in{};  ///< the name of a frame; empty: the joint's own
  Joint joint{};               ///< limits, damping, friction, spring, initial and mimic
};

struct SdfJoint {
  SdfElement source;
  std::string name;
  std::string scope;
  std::string key;
  std::string type;
  std::string parent, child;    ///< names of frames
  std::vector<SdfAxis> axes{};  ///< as many as the type has
};

struct SdfModel {
  SdfElement source;
  std::string name;
  std::string key;
  bool is_static = false;
  bool self_collide = false;
  std::vector<SdfLink> links{};    ///< in the order of the file
  std::vector<SdfJoint> joints{};  ///< in the order of the file
  LoadReport report{};
};

struct SdfWorld {
  std::deque<SdfFile> files{};  ///< elements point into them
  std::optional<Vec3<double>> gravity{};
  std::optional<double> time_step{};
  SdfFrames frames{};
  std::deque<SdfModel> models{};
  LoadReport report{};          ///< of the world itself
  LoadReport* notes = &report;  ///< of what is being read
};

/// Reads a text and all that it includes into `world`.
void read_sdf(SdfWorld& world, std::string_view text, const std::string& name, const std::filesystem::path& folder,
              const SdfOptions& options);

/// A <link>. `masks` tells whether anything in the file has a <collide_bitmask>.
[[nodiscard]] SdfLink read_link(const SdfElement& link, const SdfOptions& options, bool masks);
[[nodiscard]] SdfJoint read_joint(const SdfElement& joint);
/// A <visual> or <collision>; nothing if its shape cannot be used, which is noted.
[[nodiscard]] std::optional<SdfGeom> read_geom(const SdfElement& geom, GeomRole role);
[[nodiscard]] SurfaceMaterial read_surface(const SdfElement& collision);

}  // namespace manyhands::io
