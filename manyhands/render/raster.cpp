#include "manyhands/render/raster.h"

#include <algorithm>
#include <array>

#include "manyhands/base/index.h"
#include "manyhands/math/control_flow.h"

namespace manyhands {

namespace {

using Vec = Vec3<float>;

constexpr float kLeast = 1e-4f;   // depth at which triangles are cut off that reach behind who looks [m]
constexpr float kBeyond = 16384;  // how far from the part of the grid columns and rows are still precise

/// Points p with dot(n, p) + d > 0 lie on its inner side.
struct Plane {
  Vec n;
  float d;
};

/// Around what is seen in the part of the grid, `margin` points farther out.
std::array<Plane, 4> sides_of(const View& view, const GridPart& part, float margin) {
  const float left = static_cast<float>(part.left) - margin, top = static_cast<float>(part.top) - margin;
  const float right = static_cast<float>(part.left + part.width) + margin;
  const float bottom = static_cast<float>(part.top + part.height) + margin;
  const auto side = [&](const Vec& row, float at, float limit, float sign) -> Plane {
    if (view.is_parallel) return {sign * row, sign * (at - limit)};
    return {sign * fma(-limit, view.ahead, row), sign * (at - limit * view.at.z)};
  };
  return {side(view.across, view.at.x, left, 1), side(view.across, view.at.x, right, -1),
          side(view.down, view.at.y, top, 1), side(view.down, view.at.y, bottom, -1)};
}

/// The column and the row of a vertex.
struct Point {
  float column, row;
};
static_assert(sizeof(Point) == sizeof(double));

/// Columns and rows of eight vertices: both in one go, half the work of `gather`.
MANYHANDS_INLINE void gather_points(const Point* points, const std::uint8_t* vertex, Rays& column, Rays& row) {
  using Four = VectorOf<double, 4>::real;
  const auto both = [&](int k) {
    double bits;
    std::memcpy(&bits, &points[vertex[k]], sizeof(bits));
    return bits;
  };
  const auto low = std::bit_cast<Rays::Vector>(Four{both(0), both(1), both(4), both(5)});
  const auto high = std::bit_cast<Rays::Vector>(Four{both(2), both(3), both(6), both(7)});
  column.v = __builtin_shufflevector(low, high, 0, 2, 8, 10, 4, 6, 12, 14);
  row.v = __builtin_shufflevector(low, high, 1, 3, 9, 11, 5, 7, 13, 15);
}

MANYHANDS_INLINE void store_points(Point* to, Rays column, Rays row) {
  const auto low = __builtin_shufflevector(column.v, row.v, 0, 8, 1, 9, 2, 10, 3, 11);
  const auto high = __builtin_shufflevector(column.v, row.v, 4, 12, 5, 13, 6, 14, 7, 15);
  std::memcpy(to, &low, sizeof(low));
  std::memcpy(to + kRays / 2, &high, sizeof(high));
}

MANYHANDS_INLINE Rays gather_bytes(const float* table, const std::uint8_t* vertex) {
  Rays found;
  for (int k = 0; k < kRays; ++k) set_lane(found, k, table[vertex[k]]);
  return found;
}

MANYHANDS_INLINE Rays ceiling(Rays a) { return -floor(-a); }

/// How far inside of a plane the points are, times the length of its normal.
MANYHANDS_INLINE Rays inside(const Plane& plane, const Vec3<Rays>& p) {
  return dot(broadcast<Rays>(plane.n), p) + Rays(plane.d);
}

MANYHANDS_INLINE RayMask faces_away(const ClusterBounds& bounds, const View& view) {
  const Vec3<Rays> eye = broadcast<Rays>(view.eye);
  if (view.is_parallel) return dot(eye, bounds.axis) >= bounds.spread;
  const Vec3<Rays> way = bounds.centre - eye;
  return dot(way, bounds.axis) >= fma(bounds.spread, norm(way), bounds.radius);
}

}  // namespace

/// The corners of eight triangles.
struct Raster::Projected {
  std::array<Rays, 3> column, row, nearness;
};

/// What tells which points eight triangles cover, and how near they are there.
struct Raster::Setup {
  using Numbers = std::array<float, kRays>;
  struct Edge {
    Numbers x, y, dx, dy;  // a point of it, and its direction: inside lies where (px - x) dy - (py - y) dx >= 0
  };
  std::array<Edge, 3> edges;
  Numbers first, by_one, by_two;  // nearness at corner 0, and what edges 2 and 0 add to it
  Numbers left, right, top, bottom;
};

/// Which of eight triangles cover points of the grid, and which those may be.
struct Raster::Candidates {
  RayMask seen;
  Rays area, left, right, top, bottom;
};

MANYHANDS_INLINE Raster::Candidates Raster::candidates_of(const Projected& corners, RayMask wanted, bool culls) const {
  const auto& x = corners.column;
  const auto& y = corners.row;
  Candidates c;
  c.area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);  // < 0: seen from outside
  const auto points = [](const std::array<Rays, 3>& a, int first, int size, Rays& low, Rays& high) {
    const Rays half(0.5f);
    low = max(ceiling(min(a[0], min(a[1], a[2])) - half), Rays(static_cast<float>(first)));
    high = min(floor(max(a[0], max(a[1], a[2])) - half), Rays(static_cast<float>(first + size - 1)));
    return low <= high;
  };
  const RayMask across = points(x, part_.left, part_.width, c.left, c.right);
  const RayMask down = points(y, part_.top, part_.height, c.top, c.bottom);
  c.seen = wanted & across & down & (culls ? c.area < Rays(0.0f) : c.area != Rays(0.0f));
  return c;
}

void Raster::begin(const GridPart& part, bool keeps_triangles) {
  part_ = part;
  stride_ = part.width + kRays;  // rows are filled by packets
  keeps_triangles_ = keeps_triangles;
  is_empty_ = true;
}

void Raster::draw(const ClusteredMesh& mesh, const View& view, int number) {
  const bool culls = mesh.is_closed && !view.sees_backs;
  number_ = number;
  most_ = view.is_parallel ? -view.near : 1 / max(view.near, kLeast);
  const std::array<Plane, 4> sides = sides_of(view, part_, 0), beyond = sides_of(view, part_, kBeyond);
  const Plane front{view.ahead, view.at.z - max(view.near, kLeast)};
  const auto reach = [](const Plane& plane, Rays radius) { return radius * Rays(norm(plane.n)); };
  for (std::size_t group = 0; group < mesh.bounds.size(); ++group) {
    const ClusterBounds& bounds = mesh.bounds[group];
    RayMask seen = bounds.radius >= Rays(0.0f), clips(false);
    for (const Plane& side : sides) seen = seen & (inside(side, bounds.centre) >= -reach(side, bounds.radius));
    if (!view.is_parallel) {
      seen = seen & (inside(front, bounds.centre) >= -reach(front, bounds.radius));
      clips = inside(front, bounds.centre) < reach(front, bounds.radius);
      for (const Plane& side : beyond) clips = clips | (inside(side, bounds.centre) < reach(side, bounds.radius));
    }
    if (culls) seen = seen & !faces_away(bounds, view);
    for_lanes<Rays>(
        seen, [&](int k) { draw_cluster(mesh, mesh.clusters[group * kRays + index(k)], view, culls, lane(clips, k)); });
  }
}

void Raster::draw_cluster(const ClusteredMesh& mesh, const Cluster& cluster, const View& view, bool culls, bool clips) {
  if (is_empty_) {
    const std::size_t size = index(stride_) * index(part_.height) + kRays;
    if (nearness_.size() < size) nearness_.resize(size);
    for (std::size_t i = 0; i + kRays <= size; i += kRays) store(&nearness_[i], Rays(kNothing));
    if (keeps_triangles_ && mesh_.size() < size) {
      mesh_.resize(size);
      triangle_.resize(size);
    }
    is_empty_ = false;
  }
  std::array<Point, ClusteredMesh::kMostVertices> points;
  std::array<float, ClusteredMesh::kMostVertices> nearness, depth;
  const Vec3<Rays> across = broadcast<Rays>(view.across), down = broadcast<Rays>(view.down);
  const Vec3<Rays> ahead = broadcast<Rays>(view.ahead), at = broadcast<Rays>(view.at);
  for (std::size_t i = 0; i < index(cluster.num_vertices); i += kRays) {
    const std::size_t from = index(cluster.first_vertex) + i;
    const Vec3<Rays> p{load<Rays>(&mesh.x[from]), load<Rays>(&mesh.y[from]), load<Rays>(&mesh.z[from])};
    const Rays a = dot(across, p) + at.x, b = dot(down, p) + at.y, c = dot(ahead, p) + at.z;
    const Rays inverse = view.is_parallel ? Rays(1.0f) : Rays(1.0f) / c;
    store_points(&points[i], a * inverse, b * inverse);
    store(&nearness[i], view.is_parallel ? -c : inverse);
    if (clips) store(&depth[i], c);
  }
  const auto left = static_cast<float>(part_.left), top = static_cast<float>(part_.top);
  for (std::size_t i = 0; i < index(cluster.num_triangles); i += kRays) {
    const std::size_t from = index(cluster.first_triangle) + i;
    const std::array<const std::uint8_t*, 3> vertex{&mesh.corners[0][from], &mesh.corners[1][from],
                                                    &mesh.corners[2][from]};
    Projected corners;
    RayMask whole(true);
    for (std::size_t k = 0; k < 3; ++k) {
      gather_points(points.data(), vertex[k], corners.column[k], corners.row[k]);
      if (!clips) continue;
      whole = whole & (gather_bytes(depth.data(), vertex[k]) > Rays(max(view.near, kLeast))) &
              (abs(corners.column[k] - Rays(left)) < Rays(kBeyond)) & (abs(corners.row[k] - Rays(top)) < Rays(kBeyond));
    }
    if (clips) {
      for_lanes<Rays>(!whole, [&](int j) { draw_clipped(mesh, static_cast<int>(from) + j, view, culls); });
    }
    const Candidates candidates = candidates_of(corners, whole, culls);
    when(candidates.seen, [&] {
      RayInts numbers;
      for (int j = 0; j < kRays; ++j) numbers[j] = static_cast<int>(from) + j;
      for (std::size_t k = 0; k < 3; ++k) corners.nearness[k] = gather_bytes(nearness.data(), vertex[k]);
      draw_eight(corners, candidates, numbers);
    });
  }
}

void Raster::draw_clipped(const ClusteredMesh& mesh, int triangle, const View& view, bool culls) {
  constexpr std::size_t kMostCorners = 3 + 5;
  std::array<Plane, 5> planes{{{view.ahead, view.at.z - max(view.near, kLeast)}}};
  std::ranges::copy(sides_of(view, part_, kBeyond / 2), planes.begin() + 1);
  std::array<Vec, kMostCorners> polygon{}, next{};
  std::ranges::copy(mesh.facets[index(triangle)].corner, polygon.begin());
  std::size_t size = 3;
  for (const Plane& plane : planes) {  // Sutherland and Hodgman, Reentrant Polygon Clipping, 1974
    const auto side = [&](const Vec& p) { return dot(plane.n, p) + plane.d; };
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const Vec &a = polygon[i], &b = polygon[(i + 1) % size];
      const float in_a = side(a), in_b = side(b);
      if (in_a >= 0) next[kept++] = a;
      // From the inner point to the outer one: a neighbour that shares the edge finds the same point.
      if (in_a >= 0 && in_b < 0) next[kept++] = fma(in_a / (in_a - in_b), b - a, a);
      if (in_a < 0 && in_b >= 0) next[kept++] = fma(in_b / (in_b - in_a), a - b, b);
    }
    polygon = next;
    size = kept;
    if (size < 3) return;
  }
  std::array<Vec, kMostCorners> seen{};  // column, row, nearness
  for (std::size_t i = 0; i < size; ++i) {
    const Vec& p = polygon[i];
    const float a = dot(view.across, p) + view.at.x, b = dot(view.down, p) + view.at.y;
    const float c = dot(view.ahead, p) + view.at.z;
    seen[i] = view.is_parallel ? Vec{a, b, -c} : (1 / max(c, kLeast)) * Vec{a, b, 1};
  }
  Projected corners{};
  RayMask wanted(false);
  for (int j = 0; j + 2 < static_cast<int>(size); ++j) {
    const std::array<Vec, 3> fan{seen[0], seen[index(j + 1)], seen[index(j + 2)]};
    for (std::size_t k = 0; k < 3; ++k) {
      set_lane(corners.column[k], j, fan[k].x);
      set_lane(corners.row[k], j, fan[k].y);
      set_lane(corners.nearness[k], j, fan[k].z);
    }
    wanted.bits[j] = -1;
  }
  draw_eight(corners, candidates_of(corners, wanted, culls), RayInts{} + triangle);
}

void Raster::draw_eight(const Projected& corners, const Candidates& candidates, RayInts numbers) {
  const auto& [x, y, w] = corners;
  const Rays area = candidates.area;
  Setup setup;
  const Rays turn = copysign(Rays(1.0f), -area), share = Rays(1.0f) / abs(area);
  for (std::size_t k = 0; k < 3; ++k) {
    // From the end that comes first in order, whichever triangle the edge belongs to: neighbours judge a point by the
    // same numbers, and leave none out.
    const std::size_t l = (k + 1) % 3;
    const RayMask swaps = (x[l] < x[k]) | ((x[l] == x[k]) & (y[l] < y[k]));
    const Rays from_x = select(swaps, x[l], x[k]), from_y = select(swaps, y[l], y[k]);
    const Rays sign = select(swaps, -turn, turn);
    store(setup.edges[k].x.data(), from_x);
    store(setup.edges[k].y.data(), from_y);
    store(setup.edges[k].dx.data(), sign * (select(swaps, x[k], x[l]) - from_x));
    store(setup.edges[k].dy.data(), sign * (select(swaps, y[k], y[l]) - from_y));
  }
  store(setup.first.data(), w[0]);
  store(setup.by_one.data(), share * (w[1] - w[0]));
  store(setup.by_two.data(), share * (w[2] - w[0]));
  store(setup.left.data(), candidates.left);
  store(setup.right.data(), candidates.right);
  store(setup.top.data(), candidates.top);
  store(setup.bottom.data(), candidates.bottom);
  for_lanes<Rays>(candidates.seen, [&](int k) { fill(setup, k, numbers[k]); });
}

void Raster::fill(const Setup& setup, int k, int triangle) {
  const std::size_t i = index(k);
  const int left = static_cast<int>(setup.left[i]), right = static_cast<int>(setup.right[i]);
  const int top = static_cast<int>(setup.top[i]), bottom = static_cast<int>(setup.bottom[i]);
  const auto& [edge_0, edge_1, edge_2] = setup.edges;
  const Rays::Vector steps{0.5f, 1.5f, 2.5f, 3.5f, 4.5f, 5.5f, 6.5f, 7.5f};
  const Rays first(setup.first[i]), by_one(setup.by_one[i]), by_two(setup.by_two[i]), zero(0.0f), most(most_);
  for (int row = top; row <= bottom; ++row) {
    const float y = static_cast<float>(row) + 0.5f;
    const Rays c_0((y - edge_0.y[i]) * edge_0.dx[i]), c_1((y - edge_1.y[i]) * edge_1.dx[i]);
    const Rays c_2((y - edge_2.y[i]) * edge_2.dx[i]);
    std::size_t place = index((row - part_.top) * stride_ + left - part_.left);
    for (int column = left; column <= right; column += kRays, place += kRays) {
      const Rays x = Rays(steps) + Rays(static_cast<float>(column));
      const Rays in_0 = fma(x - Rays(edge_0.x[i]), Rays(edge_0.dy[i]), -c_0);
      const Rays in_1 = fma(x - Rays(edge_1.x[i]), Rays(edge_1.dy[i]), -c_1);
      const Rays in_2 = fma(x - Rays(edge_2.x[i]), Rays(edge_2.dy[i]), -c_2);
      const Rays w = fma(in_2, by_one, fma(in_0, by_two, first));
      const Rays before = load<Rays>(&nearness_[place]);
      const RayMask met = (min(in_0, min(in_1, in_2)) >= zero) & (w > before) & (w <= most);
      if (none(met)) continue;
      store(&nearness_[place], select(met, w, before));
      if (!keeps_triangles_) continue;
      const auto put = [&](std::int32_t* to, int number) {
        RayInts old;
        std::memcpy(&old, to, sizeof(old));
        old = select(met, RayInts{} + number, old);
        std::memcpy(to, &old, sizeof(old));
      };
      put(&mesh_[place], number_);
      put(&triangle_[place], triangle);
    }
  }
}

}  // namespace manyhands
