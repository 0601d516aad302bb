// What loaders of URDF and SDF do alike with a geom as a file has it: its size, its mesh and its texture. A Part is an
// UrdfGeom or an SdfGeom.
#pragma once

#include <optional>
#include <string>

#include "manyhands/model/io/mesh_shelf.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

/// Whether the shape has an extent along every axis.
[[nodiscard]] inline bool has_extent(const Shape& shape, const Vec3<double>& mesh_scale) {
  const Vec3<double>& size = shape.size;
  switch (shape.type) {
    case ShapeType::kSphere:
      return size.x > 0;
    case ShapeType::kCapsule:
      return size.x > 0 && size.y >= 0;
    case ShapeType::kCylinder:
      return size.x > 0 && size.y > 0;
    case ShapeType::kBox:
      return size.x > 0 && size.y > 0 && size.z > 0;
    case ShapeType::kMesh:
    case ShapeType::kConvex:
      return mesh_scale.x != 0 && mesh_scale.y != 0 && mesh_scale.z != 0;
    case ShapeType::kPlane:
    case ShapeType::kHeightField:
      return true;
  }
  return false;
}

/// Where a mesh is read from, and how it touches.
struct MeshRequest {
  const PackagePaths& paths;
  std::string file;
  Vec3<double> scale;
  bool bullet;  ///< the hulls of a file's objects touch; else its triangles do, or its hull where it moves
};

/// Adds a geom for each mesh that is found; a part whose mesh cannot be read is noted, and left out.
template <class Part>
void add_meshes(const Part& part, Geom geom, const MeshRequest& request, MeshShelf& shelf, ModelBuilder& builder) {
  const bool by_objects = request.bullet && geom.role == GeomRole::kCollision && !part.is_concave;
  if (by_objects) geom.shape.type = ShapeType::kConvex;
  const std::string mesh = "mesh " + in_quotes(part.mesh_file) + ": ";
  try {
    const ShelvedMeshes found = shelf.find(request.paths, request.file, request.scale, by_objects);
    if (found.ids.empty()) {
      part.source.note_serious(LoadAction::kIgnored, mesh + found.problem + "; the geom is left out");
    }
    for (const MeshId id : found.ids) {
      geom.shape.mesh = id;
      builder.add_geom(geom);
    }
  } catch (const PathEscape& error) {
    part.source.fail(mesh + error.what());
  }
}

/// Nothing, which is noted, if there is no such file that may be read.
template <class Part>
[[nodiscard]] std::optional<GeomTexture> texture_of(const Part& part, const PackagePaths& paths) {
  try {
    return GeomTexture{.file = paths.resolve(part.texture_file).string()};
  } catch (const std::runtime_error& error) {
    part.source.note(LoadAction::kIgnored,
                     "texture " + in_quotes(part.texture_file) + ": " + error.what() + "; the colour alone is shown");
    return std::nullopt;
  }
}

}  // namespace manyhands::io
