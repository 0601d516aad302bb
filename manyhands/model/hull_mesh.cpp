#include "manyhands/model/hull_mesh.h"

#include "manyhands/model/convex_polyhedron.h"

namespace manyhands {

Mesh hull_of(const Mesh& mesh) {
  const ConvexPolyhedron hull = convex_polyhedron(mesh.vertices);
  Mesh result{.source = mesh.source};
  for (const Vec3<double>& v : hull.vertices) {
    result.vertices.push_back({static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)});
  }
  for (std::size_t i = 0; i < hull.faces.size(); ++i) {
    const std::span<const int> face = hull.faces[i];
    for (std::size_t k = 2; k < face.size(); ++k) result.triangles.push_back({face[0], face[k - 1], face[k]});
  }
  return result;
}

}  // namespace manyhands
