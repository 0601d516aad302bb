#include "manyhands/physics/collision/surface/height_grid.h"

#include <algorithm>
#include <cmath>

namespace manyhands {
namespace {

using Vec = Vec3<double>;

/// Corners of each half of a cell as steps from its lowest vertex.
constexpr int kCorner[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};

}  // namespace

double HeightGrid::highest(int i, int j) const {
  return max(max(vertex(i, j).z, vertex(i + 1, j).z), max(vertex(i, j + 1).z, vertex(i + 1, j + 1).z));
}

double HeightGrid::lowest(int i, int j) const {
  return min(min(vertex(i, j).z, vertex(i + 1, j).z), min(vertex(i, j + 1).z, vertex(i + 1, j + 1).z));
}

HeightGrid::Cells HeightGrid::cells(const Bounds& box) const {
  const auto cell = [](double x, int vertices, double spacing) {
    const double at = std::floor(x / spacing + 0.5 * (vertices - 1));
    return static_cast<int>(clamp(at, -1.0, static_cast<double>(vertices - 1)));
  };
  const int i0 = std::max(0, cell(box.low.x, columns(), field_.dx)),
            j0 = std::max(0, cell(box.low.y, rows(), field_.dy));
  const int i1 = std::min(columns() - 1, cell(box.high.x, columns(), field_.dx) + 1);
  const int j1 = std::min(rows() - 1, cell(box.high.y, rows(), field_.dy) + 1);
  return {i0, i1, j0, j1};
}

Vec HeightGrid::normal(int i, int j, int half) const {
  if (i < 0 || j < 0 || i + 1 >= columns() || j + 1 >= rows()) return Vec::zero();
  const auto& c = kCorner[half];
  const Vec a = vertex(i + c[0][0], j + c[0][1]);
  const Vec n = cross(vertex(i + c[1][0], j + c[1][1]) - a, vertex(i + c[2][0], j + c[2][1]) - a);
  return (1 / norm(n)) * n;
}

SurfaceTriangle HeightGrid::triangle(int i, int j, int half) const {
  SurfaceTriangle t;
  for (std::size_t k = 0; k < 3; ++k) t.corner[k] = vertex(i + kCorner[half][k][0], j + kCorner[half][k][1]);
  t.normal = normal(i, j, half);
  if (half == 0) {
    t.beside = {normal(i, j - 1, 1), normal(i + 1, j, 1), normal(i, j, 1)};
  } else {
    t.beside = {normal(i, j, 0), normal(i, j + 1, 0), normal(i - 1, j, 0)};
  }
  return t;
}

bool HeightGrid::is_summit(int i, int j, int half, std::size_t k, const Vec& m) const {
  constexpr int kRing[6][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 0}, {-1, -1}, {0, -1}};
  const int x = i + kCorner[half][k][0], y = j + kCorner[half][k][1];
  const Vec here = vertex(x, y);
  return std::all_of(std::begin(kRing), std::end(kRing), [&](const auto& step) {
    const int u = x + step[0], v = y + step[1];
    if (u < 0 || v < 0 || u >= columns() || v >= rows()) return true;
    const Vec edge = vertex(u, v) - here;
    return dot(edge, m) <= 1e-4 * norm(edge);
  });
}

}  // namespace manyhands
