// Where rays meet the triangles that they are known to meet. Internal to the renderer.
#pragma once

#include "manyhands/render/clusters.h"

namespace manyhands {

/// Of a mesh, at the points of some rays.
struct Surface {
  Rays t;        ///< where the ray meets the triangle's plane
  Vec3<Rays> n;  ///< unit; mixed from the normals of the triangle's corners
  RayInts part;
};

/// In the lanes of the mask; the others' numbers are arbitrary.
MANYHANDS_INLINE Surface surface_at(const ClusteredMesh& mesh, RayInts triangle, RayMask mask, const Vec3<Rays>& o,
                                    const Vec3<Rays>& d) {
  std::array<Vec3<Rays>, 3> corner, normal;
  Surface surface;
  for (int j = 0; j < kRays; ++j) {
    const Facet& facet = mesh.facets[static_cast<std::size_t>(mask.bits[j] & triangle[j])];
    const auto put = [&](Vec3<Rays>& to, const Vec3<float>& from) {
      set_lane(to.x, j, from.x);
      set_lane(to.y, j, from.y);
      set_lane(to.z, j, from.z);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      put(corner[k], facet.corner[k]);
      put(normal[k], facet.normal[k]);
    }
    surface.part[j] = facet.part;
  }
  // Moeller and Trumbore, Fast, Minimum Storage Ray-Triangle Intersection, 1997.
  const Vec3<Rays> u = corner[1] - corner[0], v = corner[2] - corner[0], s = o - corner[0];
  const Vec3<Rays> n = cross(u, v), q = cross(s, u);
  const Rays inverse = Rays(-1.0f) / dot(n, d), one(1.0f);
  const Rays beta = -(inverse * dot(cross(s, v), d)), gamma = inverse * dot(q, d);
  const Vec3<Rays> smooth = fma(one - beta - gamma, normal[0], fma(beta, normal[1], gamma * normal[2]));
  surface.t = inverse * dot(n, s);
  surface.n = (one / max(norm(smooth), Rays(1e-20f))) * smooth;
  return surface;
}

}  // namespace manyhands
