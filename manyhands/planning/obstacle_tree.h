// Obstacles as a tree of boxes that all lanes descend together: a lane is a configuration.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "manyhands/math/vec3.h"
#include "manyhands/model/convex_polyhedron.h"
#include "manyhands/model/description.h"

namespace manyhands {

/// A piece of an obstacle, in its own frame G. A mesh or height field is many pieces of type kMesh, one for each
/// triangle: in the plane z = 0, corners (0, 0), (size.x, 0) and (size.y, size.z). A point of a cloud is a sphere.
struct ObstaclePiece {
  ShapeType type{};
  int owner{};    ///< the obstacle it belongs to
  bool turned{};  ///< whether its axes differ from the world's
  Mat3<float> R_GW = Mat3<float>::identity();
  Vec3<float> p_WG{};           ///< [m]
  Vec3<float> size{};           ///< as Shape::size
  int first_face{}, faces = 0;  ///< of a convex hull, in ObstacleTree::faces
};

/// How far a point is from a piece: between the two [m]. Within a solid both are 0 or less.
template <Number T>
struct DistanceBounds {
  T low, high;
};

/// How far a point is from a piece [m], negative within a solid, and the unit vector (world) along which that grows.
template <Number T>
struct Approach {
  T distance;
  Vec3<T> away;
};

/// Pieces under a tree of boxes along the world's axes.
class ObstacleTree {
 public:
  /// Adds a shape of obstacle `owner` at X_WG; not a mesh or height field, whose triangles are added one by one.
  void add(int owner, const Shape& shape, const ConvexPolyhedron* hull, const Transform<double>& X_WG);
  void add_triangle(int owner, const std::array<Vec3<double>, 3>& corners);
  void add_point(int owner, const Vec3<double>& p, double radius);
  /// After the last piece; again, if more came.
  void build();

  [[nodiscard]] std::span<const ObstaclePiece> pieces() const { return pieces_; }
  /// What has no bounds: planes. Their pieces.
  [[nodiscard]] std::span<const ObstaclePiece> endless() const { return endless_; }

  /// Calls visit(leaf) for each leaf whose box is within `reach` of p in some lane.
  template <Number T, class Visit>
  void visit_leaves(const Vec3<T>& p, T reach, Visit&& visit) const;
  [[nodiscard]] std::span<const ObstaclePiece> pieces_of(int leaf) const {
    const Node& node = nodes_[static_cast<std::size_t>(leaf)];
    return std::span(pieces_).subspan(static_cast<std::size_t>(node.first), static_cast<std::size_t>(node.count));
  }
  template <Number T>
  [[nodiscard]] DistanceBounds<T> distance(const ObstaclePiece& piece, const Vec3<T>& p) const;
  /// What pushes a point out of a piece: of hulls the face that is farthest below p, so that the distance is too small
  /// beside edges; triangles have no inside.
  template <Number T>
  [[nodiscard]] Approach<T> approach(const ObstaclePiece& piece, const Vec3<T>& p) const;

 private:
  struct Node {
    Vec3<float> low{}, high{};
    int first = 0;  // piece of a leaf; second child of an inner node, whose first child follows it
    int count = 0;  // pieces of a leaf, else 0

    template <Number T>
    [[nodiscard]] MANYHANDS_INLINE mask_t<T> is_near(const Vec3<T>& p, T reach) const {
      const T zero = constant<T>(0);
      const Vec3<T> gap{max(zero, max(T(low.x) - p.x, p.x - T(high.x))),
                        max(zero, max(T(low.y) - p.y, p.y - T(high.y))),
                        max(zero, max(T(low.z) - p.z, p.z - T(high.z)))};
      return squared_norm(gap) <= reach * reach;
    }
  };
  struct Extent {
    Vec3<float> low, high;
  };
  struct Face {
    Vec3<float> normal;
    float offset;
  };

  template <Number T>
  [[nodiscard]] static Vec3<T> in_piece(const ObstaclePiece& piece, const Vec3<T>& p) {
    const Vec3<T> shifted = p - broadcast<T>(piece.p_WG);
    return piece.turned ? broadcast<T>(piece.R_GW) * shifted : shifted;
  }
  template <Number T>
  [[nodiscard]] Approach<T> approach_in_piece(const ObstaclePiece& piece, const Vec3<T>& g) const;
  void add_bounded(const ObstaclePiece& piece, const Vec3<double>& low, const Vec3<double>& high);
  void divide(std::span<int> order, int first);

  std::vector<ObstaclePiece> pieces_, endless_;
  std::vector<Extent> extents_;  // of pieces
  std::vector<Face> faces_;
  std::vector<Node> nodes_;
};

}  // namespace manyhands

#include "manyhands/planning/obstacle_tree.inl"
