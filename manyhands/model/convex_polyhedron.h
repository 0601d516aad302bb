// Convex hulls of point clouds as solids, with what collision asks of them.
#pragma once

#include <array>
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

/// Where to look for the vertex farthest along a direction; see `support_vertex`. Empty for hulls of a few vertices.
struct SupportTable {
  static constexpr std::size_t kRow = 4;

  /// Neighbours of a vertex, side by side; the last one again where there are fewer.
  struct Row {
    std::array<double, kRow> x, y, z;
    std::array<int, kRow> vertex;
  };
  std::size_t side = 0;      ///< directions are sorted into side x side cells
  std::vector<int> start{};  ///< for each cell, the vertex farthest along its middle
  std::vector<Row> rows{};   ///< those of vertex i are rows[first_row[i]] .. rows[first_row[i + 1] - 1]
  std::vector<int> first_row{};
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
  SupportTable support{};
};

/// The hull of `points` (Qhull: Barber, Dobkin and Huhdanpaa, The Quickhull Algorithm for Convex Hulls, ACM TOMS 1996).
/// Triangles that are coplanar to 1e-6 of the cloud's extent become one face. A flat or straight cloud is thickened by
/// 1e-4 of its extent, half to each side. Throws ModelError if there is no extent or a coordinate is not finite.
[[nodiscard]] ConvexPolyhedron convex_polyhedron(std::span<const Vec3<double>> points);

/// The same of a mesh's vertices.
[[nodiscard]] ConvexPolyhedron convex_polyhedron(std::span<const Vec3<float>> points);

}  // namespace manyhands
