#include "manyhands/model/convex_parts.h"

#include "manyhands/model/compose.h"

namespace manyhands {

Model with_convex_parts(const Model& model, const std::map<MeshId, std::vector<Mesh>>& parts) {
  ModelBuilder builder = builder_of(model);
  std::map<MeshId, std::vector<MeshId>> added;
  const std::size_t count = builder.geoms().size();
  for (std::size_t i = 0; i < count; ++i) {
    const Geom& from = model.geoms()[i];
    const bool touches = from.role == GeomRole::kCollision && from.shape.mesh.is_valid();
    if (!touches || model.link(from.link).body == BodyId(0) || !parts.contains(from.shape.mesh)) continue;
    std::vector<MeshId>& meshes = added[from.shape.mesh];
    if (meshes.empty()) {
      for (const Mesh& part : parts.at(from.shape.mesh)) meshes.push_back(builder.add_mesh(part));
    }
    for (std::size_t k = 0; k < meshes.size(); ++k) {
      Geom geom = builder.geom(GeomId(i));
      geom.shape = {.type = ShapeType::kConvex, .mesh = meshes[k]};
      if (k == 0) {
        builder.geom(GeomId(i)) = geom;
      } else {
        if (!geom.name.empty()) geom.name += "#" + std::to_string(k);
        builder.add_geom(std::move(geom));
      }
    }
  }
  return builder.build();
}

}  // namespace manyhands
