#include "manyhands/physics/collision/general/collide_general.h"

#include "manyhands/physics/collision/surface/collide_surface.h"

namespace manyhands {

template <Real R>
int collide_general(const Colliders<R>& colliders, const ColliderPair& pair, const Vec3<R>& size_A,
                    const Transform<R>& X_WA, const Vec3<R>& size_B, const Transform<R>& X_WB, R margin,
                    std::span<Manifold<R>> out) {
  const Collider<R>&a = colliders.geoms[pair.a], &b = colliders.geoms[pair.b];
  const ConvexShape shape_A = ConvexShape::of(a.type, broadcast<double>(size_A), a.hull.get());
  switch (b.type) {
    case ShapeType::kPlane:
      out[0] = collide_plane(shape_A, X_WA, X_WB, margin);
      return 1;
    case ShapeType::kMesh:
      return collide_mesh(shape_A, X_WA, *b.mesh, X_WB, margin, out);
    case ShapeType::kHeightField:
      return collide_height_field(shape_A, X_WA, *b.height_field, X_WB, margin, out);
    default:
      out[0] =
          collide_convex(shape_A, X_WA, ConvexShape::of(b.type, broadcast<double>(size_B), b.hull.get()), X_WB, margin);
      return 1;
  }
}

template int collide_general<double>(const Colliders<double>&, const ColliderPair&, const Vec3<double>&,
                                     const Transform<double>&, const Vec3<double>&, const Transform<double>&, double,
                                     std::span<Manifold<double>>);
template int collide_general<float>(const Colliders<float>&, const ColliderPair&, const Vec3<float>&,
                                    const Transform<float>&, const Vec3<float>&, const Transform<float>&, float,
                                    std::span<Manifold<float>>);

}  // namespace manyhands
