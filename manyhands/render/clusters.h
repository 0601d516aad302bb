// A triangle mesh as it is drawn: cut into clusters, each of which is drawn or passed over in one go.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "manyhands/render/rays.h"

namespace manyhands {

/// A triangle, counter-clockwise seen from outside.
struct Facet {
  std::array<Vec3<float>, 3> corner{};  ///< [m]
  std::array<Vec3<float>, 3> normal{};  ///< at its corners: unit, outwards
  int part = 0;                         ///< of the mesh that it belongs to
};

/// Neighbouring triangles that face much the same way.
struct Cluster {
  int first_vertex, num_vertices;     ///< multiples of kRays
  int first_triangle, num_triangles;  ///< likewise
};

/// Bounds of eight clusters: a ball around each, and a cone around the normals of its triangles.
struct ClusterBounds {
  Vec3<Rays> centre;
  Rays radius;  ///< [m]; less than 0: there is no such cluster
  Vec3<Rays> axis;
  Rays spread;  ///< sine of the angle between the axis and the normal that is farthest from it; above 1: too wide
};

/// Immutable. Where numbers are missing to a multiple of kRays, vertices are repeated, and triangles without area
/// stand.
struct ClusteredMesh {
  static constexpr int kMostTriangles = 64;                 ///< of a cluster
  static constexpr int kMostVertices = 3 * kMostTriangles;  ///< likewise

  /// is_closed: whether it is known that each edge is passed as often in one direction as in the other.
  ClusteredMesh(std::span<const Facet> mesh, bool is_closed);

  std::vector<Cluster> clusters;
  std::vector<ClusterBounds> bounds;
  std::vector<float> x, y, z;                        ///< vertices of the clusters, one after the other [m]
  std::array<std::vector<std::uint8_t>, 3> corners;  ///< of the triangles, by vertex of their cluster
  std::vector<Facet> facets;                         ///< the triangles
  bool is_closed;                                    ///< its triangles are seen from outside only
};

/// Whether each edge is passed as often in one direction as in the other.
[[nodiscard]] bool is_closed(std::span<const Facet> mesh);

}  // namespace manyhands
