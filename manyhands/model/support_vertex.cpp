#include "manyhands/model/support_vertex.h"

#include <algorithm>
#include <cmath>

#include "manyhands/math/lanes.h"

namespace manyhands {
namespace {

using Vec = Vec3<double>;
using Wide = Lanes<double, SupportTable::kRow>;
using Row = SupportTable::Row;

constexpr std::size_t kScan = 20;     // vertices that are looked at sooner than a table is asked
constexpr std::size_t kMaxSide = 32;  // of the table: 4 kB

/// The cell of a direction. Directions are points of the octahedron |x| + |y| + |z| = 1, whose lower half is folded out
/// to fill the square [-1, 1]^2 (Meyer et al., On Floating-Point Normal Vectors, Computer Graphics Forum 2010).
std::size_t cell_of(const Vec& d, std::size_t side) {
  const double scale = 1 / (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
  const double x = scale * d.x, y = scale * d.y;
  const bool lower = d.z < 0;
  const double u = lower ? std::copysign(1 - std::abs(y), x) : x, v = lower ? std::copysign(1 - std::abs(x), y) : y;
  const double half = 0.5 * static_cast<double>(side);
  const auto index = [&](double t) {  // of whatever comes of a zero, an infinity or a NaN, too
    return t > -1 ? std::min(static_cast<std::size_t>(fma(half, min(t, 1.0), half)), side - 1) : 0;
  };
  return index(v) * side + index(u);
}

/// The direction in the middle of a cell.
Vec middle_of(std::size_t cell, std::size_t side) {
  const double width = 2.0 / static_cast<double>(side);
  const double u = (static_cast<double>(cell % side) + 0.5) * width - 1;
  const double v = (static_cast<double>(cell / side) + 0.5) * width - 1;
  const double z = 1 - std::abs(u) - std::abs(v);
  if (z >= 0) return {u, v, z};
  return {std::copysign(1 - std::abs(v), u), std::copysign(1 - std::abs(u), v), z};
}

/// x a + y b + z c, for numbers and for rows of them alike to the bit.
template <class T>
MANYHANDS_INLINE T height(T x, T y, T z, T a, T b, T c) {
  return x * a + (y * b + z * c);
}

/// Adds the rows of the listed vertices.
void add_rows(const std::vector<Vec>& vertices, std::span<const int> list, std::vector<Row>& rows) {
  for (std::size_t i = 0; i < list.size(); i += SupportTable::kRow) {
    Row& row = rows.emplace_back();
    for (std::size_t k = 0; k < SupportTable::kRow; ++k) {
      row.vertex[k] = list[std::min(i + k, list.size() - 1)];
      const Vec& p = vertices[static_cast<std::size_t>(row.vertex[k])];
      row.x[k] = p.x, row.y[k] = p.y, row.z[k] = p.z;
    }
  }
}

/// The vertex at which a climb that begins at `top` ends: each time on to the highest of its neighbours, while one is
/// higher. On a convex hull none is higher then anywhere.
std::size_t climb(const std::vector<Vec>& vertices, const SupportTable& table, const Vec& d, std::size_t top) {
  const Vec& start = vertices[top];
  double best = height(start.x, start.y, start.z, d.x, d.y, d.z);
  const Wide x(d.x), y(d.y), z(d.z);
  for (std::size_t from = vertices.size(); from != top;) {
    from = top;
    for (auto r = static_cast<std::size_t>(table.first_row[from]);
         r < static_cast<std::size_t>(table.first_row[from + 1]); ++r) {
      const Row& row = table.rows[r];
      const Wide h = height(load<Wide>(row.x.data()), load<Wide>(row.y.data()), load<Wide>(row.z.data()), x, y, z);
      if (none(h > Wide(best))) continue;
      for (int k = 0; k < static_cast<int>(SupportTable::kRow); ++k) {
        if (lane(h, k) > best) {
          best = lane(h, k);
          top = static_cast<std::size_t>(row.vertex[static_cast<std::size_t>(k)]);
        }
      }
    }
  }
  return top;
}

}  // namespace

std::size_t support_vertex(const ConvexPolyhedron& hull, const Vec& d) {
  if (const SupportTable& table = hull.support; !table.start.empty()) {
    return climb(hull.vertices, table, d, static_cast<std::size_t>(table.start[cell_of(d, table.side)]));
  }
  std::size_t top = 0;
  double best = dot(hull.vertices[0], d);
  for (std::size_t i = 1; i < hull.vertices.size(); ++i) {
    if (const double h = dot(hull.vertices[i], d); h > best) top = i, best = h;
  }
  return top;
}

SupportTable support_table(const ConvexPolyhedron& hull) {
  SupportTable table;
  if (hull.vertices.size() <= kScan) return table;
  // Four cells a vertex: the climb is then a step or none.
  table.side = std::min(static_cast<std::size_t>(2 * std::sqrt(static_cast<double>(hull.vertices.size()))), kMaxSide);
  table.first_row.push_back(0);
  for (std::size_t i = 0; i < hull.vertices.size(); ++i) {
    add_rows(hull.vertices, hull.neighbours[i], table.rows);
    table.first_row.push_back(static_cast<int>(table.rows.size()));
  }
  std::size_t top = 0;
  for (std::size_t cell = 0; cell < table.side * table.side; ++cell) {
    top = climb(hull.vertices, table, middle_of(cell, table.side), top);
    table.start.push_back(static_cast<int>(top));
  }
  return table;
}

}  // namespace manyhands
