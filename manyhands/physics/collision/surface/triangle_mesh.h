// A static surface of triangles with a tree of boxes over it.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "manyhands/model/convex_polyhedron.h"
#include "manyhands/model/description.h"

namespace manyhands {

/// An axis-aligned box, empty as made.
struct Bounds {
  Vec3<double> low{kFar, kFar, kFar};
  Vec3<double> high{-kFar, -kFar, -kFar};

  void include(const Vec3<double>& p) {
    low = {min(low.x, p.x), min(low.y, p.y), min(low.z, p.z)};
    high = {max(high.x, p.x), max(high.y, p.y), max(high.z, p.z)};
  }
  void grow(double by) {
    low = low - Vec3<double>{by, by, by};
    high = high + Vec3<double>{by, by, by};
  }
  [[nodiscard]] bool meets(const Bounds& b) const {
    return low.x <= b.high.x && b.low.x <= high.x && low.y <= b.high.y && b.low.y <= high.y && low.z <= b.high.z &&
           b.low.z <= high.z;
  }
  /// Between the nearest points of two boxes [m]; 0 if they meet.
  [[nodiscard]] double distance(const Bounds& b) const {
    const Vec3<double> gap{max(0.0, max(low.x - b.high.x, b.low.x - high.x)),
                           max(0.0, max(low.y - b.high.y, b.low.y - high.y)),
                           max(0.0, max(low.z - b.high.z, b.low.z - high.z))};
    return norm(gap);
  }
  /// Where a ray from o enters [m]; infinite if it misses or enters beyond `far`. The reciprocals of its direction are
  /// finite: 1e300 for 0.
  [[nodiscard]] double entry(const Vec3<double>& o, const Vec3<double>& reciprocal, double far) const;

 private:
  static constexpr double kFar = std::numeric_limits<double>::infinity();
};

/// One triangle of a surface and what lies across its edges.
struct SurfaceTriangle {
  std::array<Vec3<double>, 3> corner{};  ///< counter-clockwise from the front [m]
  Vec3<double> normal{};                 ///< unit, to the front
  std::array<Vec3<double>, 3> beside{};  ///< normal of the triangle across the edge from corner k to k + 1, or zero

  [[nodiscard]] Bounds bounds() const {
    Bounds b;
    for (const auto& p : corner) b.include(p);
    return b;
  }
};

/// Immutable once built. Triangles without area are left out; corners at one place are one vertex.
class TriangleMesh {
 public:
  /// Throws ModelError if no triangle has an area, or an index or a coordinate makes no sense.
  explicit TriangleMesh(const Mesh& mesh);

  [[nodiscard]] std::size_t size() const { return triangles_.size(); }
  [[nodiscard]] const SurfaceTriangle& triangle(std::size_t i) const { return triangles_[i]; }
  [[nodiscard]] const std::vector<Vec3<double>>& vertices() const { return vertices_; }
  [[nodiscard]] const Bounds& bounds() const { return nodes_[0].bounds; }
  /// The radius of a ball about the origin that holds the mesh [m].
  [[nodiscard]] double bound() const { return bound_; }

  /// Whether m is in the normal cone of corner k of triangle i: no edge from it leads up along m.
  [[nodiscard]] bool is_summit(std::size_t i, std::size_t k, const Vec3<double>& m) const;

  /// Calls f(i) for the triangles of the leaf that is reached by going from each box to the one within it that costs
  /// less.
  template <class Cost, class Visit>
  void visit_best_leaf(Cost&& cost, Visit&& f) const {
    std::size_t n = 0;
    while (nodes_[n].count == 0) {
      const auto second = static_cast<std::size_t>(nodes_[n].first);
      n = cost(nodes_[n + 1].bounds) <= cost(nodes_[second].bounds) ? n + 1 : second;
    }
    for (int i = nodes_[n].first; i < nodes_[n].first + nodes_[n].count; ++i) f(static_cast<std::size_t>(i));
  }

  /// Calls f(i) for each triangle i in the leaves that `wanted(bounds)` reaches; `wanted` may tighten as f finds
  /// things.
  template <class Wanted, class Visit>
  void visit(Wanted&& wanted, Visit&& f) const {
    std::array<int, 64> stack{};  // the tree is balanced: 64 levels would need 2^64 triangles
    int top = 1;
    while (top > 0) {
      const auto n = static_cast<std::size_t>(stack[static_cast<std::size_t>(--top)]);
      const Node& node = nodes_[n];
      if (!wanted(node.bounds)) continue;
      if (node.count > 0) {
        for (int i = node.first; i < node.first + node.count; ++i) f(static_cast<std::size_t>(i));
      } else {
        stack[static_cast<std::size_t>(top++)] = node.first;
        stack[static_cast<std::size_t>(top++)] = static_cast<int>(n) + 1;
      }
    }
  }

 private:
  struct Node {
    Bounds bounds{};
    int first = 0;  // triangle of a leaf; second child of an inner node, whose first child follows it
    int count = 0;  // triangles of a leaf, else 0
  };
  struct Corners {
    std::array<int, 3> v;
    Vec3<double> middle;
  };

  void weld(const Mesh& mesh, std::vector<Corners>& corners);
  void build(std::vector<Corners>& corners, int first, int last);
  void connect(const std::vector<Corners>& corners);

  std::vector<Vec3<double>> vertices_;
  std::vector<SurfaceTriangle> triangles_;
  std::vector<std::array<int, 3>> corners_;
  IndexLists ring_;  // vertices joined to each vertex
  std::vector<Node> nodes_;
  double bound_ = 0;
};

}  // namespace manyhands
