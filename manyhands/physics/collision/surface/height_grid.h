// The triangles of a height field: each cell is cut along its diagonal through the corners of lowest and highest index.
#pragma once

#include "manyhands/physics/collision/surface/triangle_mesh.h"

namespace manyhands {

/// A view of a height field as triangles that face up; 2 per cell.
class HeightGrid {
 public:
  explicit HeightGrid(const HeightField& field) : field_(field) {}

  [[nodiscard]] int columns() const { return field_.columns; }  ///< vertices along x
  [[nodiscard]] int rows() const { return field_.rows; }        ///< vertices along y

  /// The vertex at column i and row j.
  [[nodiscard]] Vec3<double> vertex(int i, int j) const {
    return {(i - 0.5 * (field_.columns - 1)) * field_.dx, (j - 0.5 * (field_.rows - 1)) * field_.dy,
            field_.height[static_cast<std::size_t>(j) * static_cast<std::size_t>(field_.columns) +
                          static_cast<std::size_t>(i)]};
  }
  [[nodiscard]] double highest(int i, int j) const;  ///< corner of the cell whose lowest vertex is (i, j)
  [[nodiscard]] double lowest(int i, int j) const;

  /// The cells, lowest to one beyond the highest, that the box covers seen from above; none if it lies beside the grid.
  struct Cells {
    int i0, i1, j0, j1;
  };
  [[nodiscard]] Cells cells(const Bounds& box) const;

  /// Half 0 or 1 of a cell: (00, 10, 11) or (00, 11, 01).
  [[nodiscard]] SurfaceTriangle triangle(int i, int j, int half) const;
  /// As TriangleMesh::is_summit.
  [[nodiscard]] bool is_summit(int i, int j, int half, std::size_t k, const Vec3<double>& m) const;

 private:
  [[nodiscard]] Vec3<double> normal(int i, int j, int half) const;  // zero outside of the grid

  const HeightField& field_;
};

}  // namespace manyhands
