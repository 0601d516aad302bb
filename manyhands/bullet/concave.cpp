#include "manyhands/bullet/concave.h"

#include <utility>

namespace manyhands::bullet {

void split_concave(const Decomposer& decompose, BodyPlan& plan) {
  for (int i = plan.fixed ? 0 : -1; i < plan.num_links(); ++i) {
    for (ShapePlan& shape : plan.link(i).collisions) {
      if (shape.geom.shape.type != ShapeType::kMesh) continue;
      for (Mesh& part : decompose(plan.meshes[shape.geom.shape.mesh.index()])) {
        shape.parts.emplace_back(static_cast<int>(plan.meshes.size()));
        plan.meshes.push_back(std::move(part));
      }
    }
  }
}

}  // namespace manyhands::bullet
