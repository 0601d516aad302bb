// Convex hulls of point clouds as solids, with what collision asks of them.
#pragma once

#include <span>
#include <vector>

#include "manyhands/math/vec3.h"

namespace manyhands {

/// Lists of different lengths in one piece of memory: list i is items[start[i] .. start[i + 1]).
struct IndexLists {
  std::vector<int> start{0};
  std::vector<int> items{};

  [[nodiscard]] std::size_t size() const { return start.size() - 1; }
  [[nodiscard]] std::span<const int> operator[](std::size_t i) const {
    return {items.data() + start[i], items.data() + start[i + 1]};
  }
  void append(std::span<const int> list);
};

/// The half-space normal . x <= offset.
struct FacePlane {
  Vec3<double> normal{};  ///< unit, outwards
  double offset{};        ///< [m]
};

/// A closed convex polyhedron, immutable once built. Lengths are in metres, in the axes of the points.
struct ConvexPolyhedron {
  std::vector<Vec3<double>> vertices{};
  std::vector<FacePlane> planes{};  ///< of each face; no vertex lies outside
  IndexLists faces{};               ///< vertices of each face, counter-clockwise seen from outside
  IndexLists neighbours{};          ///< vertices joined to each vertex by an edge, those across flat faces included
  IndexLists faces_of{};            ///< faces on which each vertex lies, within one included
  Vec3<double> centre{};            ///< centroid of the volume
  double volume{};                  ///< [m^3]
  double bound{};                   ///< largest distance of a vertex from the origin [m]
};

/// The hull of `points` (Qhull: Barber, Dobkin and Huhdanpaa, The Quickhull Algorithm for Convex Hulls, ACM TOMS 1996).
/// Triangles that are coplanar to 1e-6 of the cloud's extent become one face. A flat or straight cloud is thickened by
/// 1e-4 of its extent, half to each side. Throws ModelError if there is no extent or a coordinate is not finite.
[[nodiscard]] ConvexPolyhedron convex_polyhedron(std::span<const Vec3<double>> points);

/// The same of a mesh's vertices.
[[nodiscard]] ConvexPolyhedron convex_polyhedron(std::span<const Vec3<float>> points);

}  // namespace manyhands
