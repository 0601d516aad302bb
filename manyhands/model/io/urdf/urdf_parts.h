// The contents of a URDF file before they become a model, and the functions that read them.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manyhands/model/description.h"
#include "manyhands/model/io/urdf/urdf_element.h"

namespace manyhands::io {

using Rgba = std::array<float, 4>;

struct UrdfMaterial {
  Rgba rgba{};
  std::string texture_file{};  ///< empty without one
};

/// The materials by name: those of the whole robot first, then those given where they are used.
using Materials = std::map<std::string, UrdfMaterial, std::less<>>;

struct UrdfGeom {
  UrdfElement source;  ///< for messages: the <visual> or <collision>
  Geom geom;           ///< its link and mesh still unset
  std::string mesh_file;
  Vec3<double> mesh_scale{1, 1, 1};
  bool is_concave = false;  ///< by Bullet's attribute: its triangles touch, not its hulls
  std::string texture_file{};
};

struct UrdfLink {
  UrdfElement source;
  std::string name;
  Inertial inertial;
  Mat3<double> inertial_axes = Mat3<double>::identity();  ///< of its <inertial>
  double inertia_scale = 1;                               ///< Bullet's
  std::vector<UrdfGeom> geoms;
};

struct UrdfJoint {
  UrdfElement source;
  Joint joint;  ///< its parent and child still unset
  std::string parent;
  std::string child;
};

struct UrdfRobot {
  std::string name;
  std::vector<UrdfLink> links;    ///< in the order of the file
  std::vector<UrdfJoint> joints;  ///< in the order of the file
};

/// Reads the root element. Fails on anything malformed; defaults, repairs and ignored elements are noted.
[[nodiscard]] UrdfRobot read_robot(const UrdfElement& robot);

/// The colour and texture that the element itself has, white where only the texture is given; nothing without either.
[[nodiscard]] std::optional<UrdfMaterial> read_material(const UrdfElement& material);
[[nodiscard]] Materials read_materials(const UrdfElement& robot);
[[nodiscard]] UrdfLink read_link(const UrdfElement& link, const Materials& materials);
[[nodiscard]] Inertial read_inertial(const UrdfElement& link);
[[nodiscard]] SurfaceMaterial read_contact(const UrdfElement& link);
/// A <visual> or <collision>; nothing if its shape cannot be used, which is noted.
[[nodiscard]] std::optional<UrdfGeom> read_geom(const UrdfElement& geom, GeomRole role, const Materials& materials);
[[nodiscard]] UrdfJoint read_joint(const UrdfElement& joint);

}  // namespace manyhands::io
