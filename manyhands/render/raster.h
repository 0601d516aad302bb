// Triangles drawn into a grid: at each of its points, the one that is nearest to who looks.
#pragma once

#include <limits>
#include <vector>

#include "manyhands/render/clusters.h"

namespace manyhands {

/// How points p of a mesh are seen: with (a, b, c) = rows p + at, in column a / c and row b / c at the depth c, or
/// where rays are parallel in column a and row b at the depth c. Columns go to the right and rows down, seen from
/// outside.
struct View {
  Vec3<float> across{}, down{}, ahead{};  ///< rows
  Vec3<float> at{};
  bool is_parallel = false;
  float near = 0;           ///< what is nearer is not seen [m]
  Vec3<float> eye{};        ///< where who looks is; where rays are parallel, where they go to (unit)
  bool sees_backs = false;  ///< also the inner sides of closed meshes
};

/// A part of a grid: its first point, and how many there are. Point (i, j) lies at column i + 0.5 and row j + 0.5.
struct GridPart {
  int left = 0, top = 0, width = 0, height = 0;
};

/// The grid, of which one part is drawn at a time.
class Raster {
 public:
  static constexpr float kNothing = -std::numeric_limits<float>::max();

  /// Makes it empty. keeps_triangles: it can tell which triangle is seen, not only how near it is.
  void begin(const GridPart& part, bool keeps_triangles);
  /// Draws what of a mesh is seen in the part of the grid. number: by which `at` tells it apart.
  void draw(const ClusteredMesh& mesh, const View& view, int number);

  [[nodiscard]] const GridPart& part() const { return part_; }
  [[nodiscard]] bool is_empty() const { return is_empty_; }
  /// What is seen at some points of the part: which mesh, and which of its triangles; -1: none.
  MANYHANDS_INLINE void at(RayMask active, RayInts column, RayInts row, RayInts& mesh, RayInts& triangle) const {
    const RayInts place = active.bits & ((row - part_.top) * stride_ + (column - part_.left));
    for (int k = 0; k < kRays; ++k) {
      const auto i = static_cast<std::size_t>(place[k]);
      mesh[k] = active.bits[k] != 0 && nearness_[i] > kNothing ? mesh_[i] : -1;
      triangle[k] = triangle_[i];
    }
  }
  /// The nearness of what is seen, 1 / depth or, where rays are parallel, -depth: kNothing where there is nothing.
  MANYHANDS_INLINE Rays nearness(RayInts column, RayInts row) const {
    const RayInts place = (row - part_.top) * stride_ + (column - part_.left);
    Rays found;
    for (int k = 0; k < kRays; ++k) set_lane(found, k, nearness_[static_cast<std::size_t>(place[k])]);
    return found;
  }

 private:
  struct Projected;
  struct Candidates;
  struct Setup;
  void draw_cluster(const ClusteredMesh& mesh, const Cluster& cluster, const View& view, bool culls, bool clips);
  void draw_clipped(const ClusteredMesh& mesh, int triangle, const View& view, bool culls);
  [[nodiscard]] Candidates candidates_of(const Projected& corners, RayMask wanted, bool culls) const;
  void draw_eight(const Projected& corners, const Candidates& candidates, RayInts numbers);
  void fill(const Setup& setup, int k, int triangle);

  GridPart part_;
  int stride_ = 0;
  bool keeps_triangles_ = false, is_empty_ = true;
  int number_ = 0;  // of the mesh that is drawn
  float most_ = 0;  // nearness that is seen of it
  std::vector<float> nearness_;
  std::vector<std::int32_t> mesh_, triangle_;
};

}  // namespace manyhands
