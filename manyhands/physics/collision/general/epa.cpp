#include "manyhands/physics/collision/general/epa.h"

#include <algorithm>
#include <limits>

namespace manyhands {
namespace {

using Vec = Vec3<double>;

constexpr int kMaxVertices = 200;
constexpr int kMaxFaces = 2 * kMaxVertices;
constexpr double kGap = 1e-12;  // of the size: how much farther a face may move at the end

struct Face {
  std::array<int, 3> v;          // counter-clockwise from outside
  std::array<int, 3> neighbour;  // across the edge v[i], v[i + 1]
  std::array<int, 3> twin;       // that edge's index there
  Vec normal;
  bool alive;
};

Vec any_across(const Vec& a) {
  const double x = std::abs(a.x), y = std::abs(a.y), z = std::abs(a.z);
  const Vec e = x <= y && x <= z ? Vec{1, 0, 0} : y <= z ? Vec{0, 1, 0} : Vec{0, 0, 1};
  const Vec n = cross(a, e);
  return (1 / norm(n)) * n;
}

/// Follows the slope of the support over the circle of directions across `axis`, or over the sphere of them if it is
/// zero, to a smaller depth (step lengths after Barzilai and Borwein, 1988).
Penetration descend(const CorePair& pair, Penetration best, const Vec& start, const Vec& axis, int steps) {
  const auto across = [&](const Vec& x) { return x - dot(x, axis) * axis; };
  Vec n = across(start);
  n = (1 / norm(n)) * n;
  Vec last_n = n, last_slope = Vec::zero();
  for (int i = 0; i < steps && is_finite(n.x + n.y + n.z); ++i) {
    const MinkowskiVertex v = minkowski_support(pair, n);
    const double depth = dot(n, v.w);
    if (depth < best.depth) best = {depth, n, v.a};
    const Vec slope = across(v.w - depth * n);
    if (!(squared_norm(slope) > 0)) break;
    const Vec moved = n - last_n;
    const double curved = dot(moved, slope - last_slope);
    const double step = i > 0 && curved > 0 ? squared_norm(moved) / curved : 1e-3 / norm(slope);
    last_n = n;
    last_slope = slope;
    n = across(n - step * slope);
    n = (1 / norm(n)) * n;
  }
  return best;
}

/// Where a round surface encloses the origin nearly alike from all sides, a polytope of any affordable size cannot
/// tell its sides apart. What it found is near enough for a descent; about a cylinder, along the circle of its sides,
/// from several of them.
Penetration refined(const CorePair& pair, Penetration best) {
  constexpr int kSteps = 64;
  best = descend(pair, best, best.normal, Vec::zero(), kSteps);
  const Mat3<double> I = Mat3<double>::identity(), &R = pair.X_AB.R;
  const auto around = [&](const Vec& axis) {
    const Vec start = best.normal, side = cross(axis, start);
    for (const Vec& n : {start, start + side, side, side - start}) best = descend(pair, best, n, axis, kSteps);
    // Straight edges make kinks in the depth, where its slope says nothing.
    for (const Vec& edge : {I.x, I.y, I.z, R.x, R.y, R.z}) {
      const Vec n = cross(axis, edge);
      best = descend(pair, best, n, axis, 1);
      best = descend(pair, best, -n, axis, 1);
    }
  };
  if (pair.a.core == ConvexShape::Core::kCylinder) around(I.z);
  if (pair.b.core == ConvexShape::Core::kCylinder) around(R.z);
  // Once parted along the normal, the cores have nearest points.
  CorePair parted = pair;
  parted.X_AB.p = fma(best.depth + 0.05 * pair.scale(), best.normal, parted.X_AB.p);
  best.a = gjk(parted, std::numeric_limits<double>::infinity()).a;
  return best;
}

/// A closed surface of triangles about the origin, in fixed memory, which costs too much to clear for every contact.
class Polytope {
 public:
  Polytope(const CorePair& pair, double scale) : pair_(pair), scale_(scale) {}

  /// Makes the first tetrahedron of a simplex. False if the difference is flat; `flat_normal` is then normal to it.
  bool inflate(const GjkResult& start, Vec& flat_normal, Vec& a);
  Penetration expand();

 private:
  void add_vertex(const MinkowskiVertex& v) { vertices_[static_cast<std::size_t>(vertex_count_++)] = v; }
  [[nodiscard]] const Vec& w(int i) const { return vertices_[static_cast<std::size_t>(i)].w; }
  Face& face(int i) { return faces_[static_cast<std::size_t>(i)]; }
  double& distance(int i) { return distance_[static_cast<std::size_t>(i)]; }
  int add_face(int a, int b, int c);
  void link(int f, int edge, int g, int twin);
  [[nodiscard]] int nearest_face();
  bool add_cone(int seed, int apex);
  void flood(int f, int entered, const Vec& apex);
  [[nodiscard]] int holding_face(int nearest);
  [[nodiscard]] std::array<double, 3> weights(int f);
  [[nodiscard]] Vec nearest_on_a(int f);
  bool grow_along(const Vec& d, const Vec& base, double least);

  const CorePair& pair_;
  double scale_;
  std::array<MinkowskiVertex, kMaxVertices> vertices_;
  std::array<Face, kMaxFaces> faces_;
  std::array<double, kMaxFaces> distance_;  // of a face's plane from the origin; infinite if it is gone or has no area
  std::array<int, kMaxFaces> free_;
  std::array<std::array<int, 2>, kMaxFaces> horizon_;  // face beyond, and its edge
  int vertex_count_ = 0, face_count_ = 0, free_count_ = 0, horizon_count_ = 0;
};

/// Adds the farther of the two vertices along d and -d if it leaves the plane through `base`.
bool Polytope::grow_along(const Vec& d, const Vec& base, double least) {
  const MinkowskiVertex up = minkowski_support(pair_, d), down = minkowski_support(pair_, -d);
  const double height = dot(d, up.w - base), depth = -dot(d, down.w - base);
  if (max(height, depth) <= least) return false;
  add_vertex(height >= depth ? up : down);
  return true;
}

bool Polytope::inflate(const GjkResult& start, Vec& flat_normal, Vec& a) {
  const double least = 1e-13 * scale_;
  a = start.a;
  for (std::size_t i = 0; i < static_cast<std::size_t>(start.size); ++i) add_vertex(start.simplex[i]);
  flat_normal = {0, 0, 1};
  if (vertex_count_ == 1) {
    const bool grown =
        grow_along({1, 0, 0}, w(0), least) || grow_along({0, 1, 0}, w(0), least) || grow_along({0, 0, 1}, w(0), least);
    if (!grown) return false;
  }
  const Vec edge = w(1) - w(0), across = any_across(edge);
  flat_normal = across;
  if (vertex_count_ == 2) {
    const Vec other = (1 / norm(edge)) * cross(edge, across);
    if (!grow_along(across, w(0), least) && !grow_along(other, w(0), least)) return false;
  }
  Vec n = cross(w(1) - w(0), w(2) - w(0));
  if (!(norm(n) > 0)) return false;
  n = (1 / norm(n)) * n;
  flat_normal = n;
  if (vertex_count_ == 3 && !grow_along(n, w(0), least)) return false;
  const bool up = dot(n, w(3) - w(0)) > 0;
  const int p = up ? 1 : 0, q = up ? 0 : 1;
  const std::array<int, 4> f{add_face(p, q, 2), add_face(q, p, 3), add_face(2, q, 3), add_face(p, 2, 3)};
  link(f[0], 0, f[1], 0);
  link(f[0], 1, f[2], 0);
  link(f[0], 2, f[3], 0);
  link(f[1], 1, f[3], 2);
  link(f[1], 2, f[2], 1);
  link(f[2], 2, f[3], 1);
  return true;
}

int Polytope::add_face(int a, int b, int c) {
  const int i = free_count_ > 0 ? free_[static_cast<std::size_t>(--free_count_)] : face_count_++;
  Face& f = face(i);
  f.v = {a, b, c};
  f.alive = true;
  // From the corner with the largest angle the product loses the fewest digits.
  const Vec ab = w(b) - w(a), bc = w(c) - w(b), ca = w(a) - w(c);
  const double lab = squared_norm(ab), lbc = squared_norm(bc), lca = squared_norm(ca);
  const Vec n = lab >= lbc && lab >= lca ? cross(bc, ca) : lbc >= lca ? cross(ca, ab) : cross(ab, bc);
  const double length = norm(n);
  f.normal = length > 0 ? (1 / length) * n : Vec::zero();
  const bool sliver = length <= 1e-13 * max(lab, max(lbc, lca));
  distance(i) = sliver ? std::numeric_limits<double>::infinity() : max(dot(f.normal, w(a)), dot(f.normal, w(b)));
  return i;
}

void Polytope::link(int f, int edge, int g, int twin) {
  face(f).neighbour[static_cast<std::size_t>(edge)] = g;
  face(f).twin[static_cast<std::size_t>(edge)] = twin;
  face(g).neighbour[static_cast<std::size_t>(twin)] = f;
  face(g).twin[static_cast<std::size_t>(twin)] = edge;
}

/// None, -1, if no face has an area.
int Polytope::nearest_face() {
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < face_count_; ++i) {
    if (distance(i) < least) {
      best = i;
      least = distance(i);
    }
  }
  return best;
}

/// Removes face f if the apex sees it, and walks on; else its edge belongs to the horizon. The horizon comes out in
/// the order of the edges, counter-clockwise as the apex sees it.
void Polytope::flood(int f, int entered, const Vec& apex) {
  Face& here = face(f);
  if (!here.alive) return;
  const bool flat = std::isinf(distance(f));
  const bool seen = entered < 0 || flat || dot(here.normal, apex - w(here.v[0])) > 1e-15 * scale_;
  if (!seen) {
    if (horizon_count_ < kMaxFaces) horizon_[static_cast<std::size_t>(horizon_count_++)] = {f, entered};
    return;
  }
  here.alive = false;
  distance(f) = std::numeric_limits<double>::infinity();
  if (free_count_ < kMaxFaces) free_[static_cast<std::size_t>(free_count_++)] = f;
  for (int k = entered < 0 ? 0 : 1; k < 3; ++k) {
    const auto edge = static_cast<std::size_t>((std::max(entered, 0) + k) % 3);
    flood(here.neighbour[edge], here.twin[edge], apex);
  }
}

bool Polytope::add_cone(int seed, int apex) {
  horizon_count_ = 0;
  flood(seed, -1, w(apex));
  const int n = horizon_count_;
  if (n < 3 || face_count_ + n - free_count_ > kMaxFaces) return false;
  int first = -1, previous = -1;
  int last_vertex = -1, first_vertex = -1;
  for (int i = 0; i < n; ++i) {
    const auto [beyond, edge] = horizon_[static_cast<std::size_t>(i)];
    const auto e = static_cast<std::size_t>(edge);
    const int from = face(beyond).v[(e + 1) % 3], to = face(beyond).v[e];
    if (i > 0 && from != last_vertex) return false;
    const int f = add_face(from, to, apex);
    link(f, 0, beyond, edge);
    if (previous >= 0) link(previous, 1, f, 2);
    if (i == 0) first = f, first_vertex = from;
    previous = f;
    last_vertex = to;
  }
  if (last_vertex != first_vertex) return false;
  link(previous, 1, first, 2);
  return true;
}

/// Of the faces in the plane of the nearest one, that which holds the plane's nearest point.
int Polytope::holding_face(int nearest) {
  int best = nearest;
  double inside = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < face_count_; ++i) {
    if (!(distance(i) <= distance(nearest) + kGap * scale_)) continue;
    if (dot(face(i).normal, face(nearest).normal) < 1 - 1e-9) continue;
    const auto [u, v, w] = weights(i);
    if (const double least = min(u, min(v, w)); least > inside) {
      best = i;
      inside = least;
    }
  }
  return best;
}

/// Barycentric coordinates of the plane's nearest point to the origin.
std::array<double, 3> Polytope::weights(int i) {
  const Face& f = face(i);
  const Vec n = f.normal, p = distance(i) * n;
  const Vec a = w(f.v[0]) - p, b = w(f.v[1]) - p, c = w(f.v[2]) - p;
  const double u = dot(n, cross(b, c)), v = dot(n, cross(c, a)), t = dot(n, cross(a, b)), sum = u + v + t;
  if (!(sum > 0)) return {1, 0, 0};
  return {u / sum, v / sum, t / sum};
}

/// The point of A that belongs to the face's nearest point.
Vec Polytope::nearest_on_a(int i) {
  auto [u, v, t] = weights(i);
  u = max(0.0, u), v = max(0.0, v), t = max(0.0, t);
  const auto on_a = [&](std::size_t k) { return vertices_[static_cast<std::size_t>(face(i).v[k])].a; };
  return (1 / (u + v + t)) * fma(u, on_a(0), fma(v, on_a(1), t * on_a(2)));
}

Penetration Polytope::expand() {
  Penetration best{std::numeric_limits<double>::infinity(), {0, 0, 1}, {}};
  for (;;) {
    const int i = nearest_face();
    if (i < 0) break;
    const Vec normal = face(i).normal;
    const double depth = distance(i);
    const MinkowskiVertex v = minkowski_support(pair_, normal);
    const double reach = max(depth, dot(normal, v.w));
    if (reach < best.depth) best = {reach, normal, {}};
    if (reach - depth <= kGap * scale_) return {reach, normal, nearest_on_a(holding_face(i))};
    if (vertex_count_ == kMaxVertices) break;
    add_vertex(v);
    if (!add_cone(i, vertex_count_ - 1)) break;
  }
  return refined(pair_, best);
}

}  // namespace

Penetration epa(const CorePair& pair, const GjkResult& start) {
  Polytope polytope(pair, pair.scale());
  Vec normal, a;
  if (!polytope.inflate(start, normal, a)) return {0, normal, a};
  return polytope.expand();
}

}  // namespace manyhands
