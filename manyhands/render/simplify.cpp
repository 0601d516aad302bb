#include "manyhands/render/simplify.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <queue>
#include <tuple>

#include "manyhands/base/index.h"

namespace manyhands {

namespace {

using Vec = Vec3<double>;

/// The sum of squared distances from planes, each as heavy as its triangle is large.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec b = Vec::zero();
  double c = 0, weight = 0;

  void add_plane(const Vec& n, const Vec& p, double w) {
    const double d = -dot(n, p);
    xx += w * n.x * n.x;
    xy += w * n.x * n.y;
    xz += w * n.x * n.z;
    yy += w * n.y * n.y;
    yz += w * n.y * n.z;
    zz += w * n.z * n.z;
    b += (w * d) * n;
    c += w * d * d;
    weight += w;
  }
  void add(const Quadric& other) {
    xx += other.xx;
    xy += other.xy;
    xz += other.xz;
    yy += other.yy;
    yz += other.yz;
    zz += other.zz;
    b += other.b;
    c += other.c;
    weight += other.weight;
  }
  /// The mean of squared distances of p [m^2].
  [[nodiscard]] double at(const Vec& p) const {
    if (weight <= 0) return 0;
    const Vec Ap{xx * p.x + xy * p.y + xz * p.z, xy * p.x + yy * p.y + yz * p.z, xz * p.x + yz * p.y + zz * p.z};
    return std::max(dot(p, Ap) + 2 * dot(b, p) + c, 0.0) / weight;
  }
};

/// Vertex `from` onto vertex `to`, when `from` had moved together with `version` others.
struct Move {
  double cost;  // [m^2]
  int from, to, version;
  // The cheapest comes first; few are equally cheap.
  bool operator<(const Move& other) const {
    if (cost != other.cost) return cost > other.cost;
    return std::tie(from, to, version) > std::tie(other.from, other.to, other.version);
  }
};

}  // namespace

struct Simplifier::State {
  using Corners = std::array<int, 3>;

  int part = 0;
  std::vector<Vec3<float>> place;                 // of vertices [m]
  std::vector<std::vector<Vec3<float>>> normals;  // that the mesh has at them, each once
  std::vector<std::vector<int>> around;           // their triangles, some of which may be gone
  std::vector<Quadric> quadric;
  std::vector<int> version;  // -1: the vertex is gone
  std::vector<Corners> triangles;
  std::vector<bool> is_gone;  // of triangles
  std::priority_queue<Move> moves;
  std::vector<Move> refused;  // which may fit when more is allowed

  [[nodiscard]] Vec at(int vertex) const { return broadcast<double>(place[index(vertex)]); }
  [[nodiscard]] Vec area(const Corners& t) const { return cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0])); }

  void read(std::span<const Facet> mesh);
  void keep_rims();
  void push(int from, int to) { moves.push({quadric[index(from)].at(at(to)), from, to, version[index(from)]}); }
  [[nodiscard]] std::vector<int> neighbours(int vertex) const;
  /// Of the normals that the mesh has at a vertex, the one that fits a triangle with the normal n best.
  [[nodiscard]] const Vec3<float>& normal_at(int vertex, const Vec3<float>& n) const {
    return *std::ranges::max_element(normals[index(vertex)], {}, [&](const Vec3<float>& m) { return dot(m, n); });
  }
  [[nodiscard]] bool fits(int from, int to, double least_cosine) const;
  void move(int from, int to);
};

void Simplifier::State::read(std::span<const Facet> mesh) {
  std::map<std::array<float, 3>, int> known;
  for (const Facet& facet : mesh) {
    Corners t{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3<float>& p = facet.corner[k];
      const auto [found, is_new] = known.try_emplace({p.x, p.y, p.z}, static_cast<int>(place.size()));
      t[k] = found->second;
      if (!is_new) continue;
      place.push_back(p);
      normals.emplace_back();
      around.emplace_back();
    }
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<Vec3<float>>& known_normals = normals[index(t[k])];
      const auto is_this = [&](const Vec3<float>& n) { return squared_norm(n - facet.normal[k]) == 0; };
      if (std::ranges::none_of(known_normals, is_this)) known_normals.push_back(facet.normal[k]);
      around[index(t[k])].push_back(static_cast<int>(triangles.size()));
    }
    triangles.push_back(t);
  }
  is_gone.resize(triangles.size());
  quadric.resize(place.size());
  version.resize(place.size());
}

/// Where a mesh ends its rim stays: a plane stands upright on each edge that has one triangle.
void Simplifier::State::keep_rims() {
  std::map<std::pair<int, int>, int> passes;
  for (const Corners& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++passes[std::minmax(t[k], t[(k + 1) % 3])];
  }
  for (const Corners& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (passes[std::minmax(a, b)] != 1) continue;
      const Vec edge = at(b) - at(a), upright = cross(edge, area(t));
      if (norm(upright) <= 0) continue;
      for (const int v : {a, b}) quadric[index(v)].add_plane((1 / norm(upright)) * upright, at(a), dot(edge, edge));
    }
  }
}

std::vector<int> Simplifier::State::neighbours(int vertex) const {
  std::vector<int> found;
  for (const int i : around[index(vertex)]) {
    if (is_gone[index(i)]) continue;
    for (const int other : triangles[index(i)]) {
      if (other != vertex) found.push_back(other);
    }
  }
  std::ranges::sort(found);
  const auto rest = std::ranges::unique(found);
  found.erase(rest.begin(), rest.end());
  return found;
}

/// Whether no triangle turns over, or away from the normals at its corners, and the surface does not grow together.
bool Simplifier::State::fits(int from, int to, double least_cosine) const {
  constexpr double kTurned = 0.2;  // cosine
  bool are_neighbours = false;
  for (const int i : around[index(from)]) {
    const Corners& t = triangles[index(i)];
    if (is_gone[index(i)]) continue;
    if (std::ranges::find(t, to) != t.end()) {
      are_neighbours = true;
      continue;
    }
    Corners moved = t;
    std::ranges::replace(moved, from, to);
    const Vec before = area(t), after = area(moved);
    const double size = norm(after);
    if (dot(before, after) <= kTurned * norm(before) * size) return false;
    if (least_cosine <= -1) continue;  // it may turn as it likes
    const Vec3<float> n = broadcast<float>((1 / size) * after);
    const auto agrees = [&](int v) { return static_cast<double>(dot(normal_at(v, n), n)) >= least_cosine; };
    if (!std::ranges::all_of(moved, agrees)) return false;
  }
  if (!are_neighbours) return false;
  std::vector<int> both;
  std::ranges::set_intersection(neighbours(from), neighbours(to), std::back_inserter(both));
  return both.size() <= 2;
}

void Simplifier::State::move(int from, int to) {
  const std::vector<int> known = neighbours(to);
  for (const int i : around[index(from)]) {
    if (is_gone[index(i)]) continue;
    Corners& t = triangles[index(i)];
    if (std::ranges::find(t, to) != t.end()) {
      is_gone[index(i)] = true;
      continue;
    }
    std::ranges::replace(t, from, to);
    around[index(to)].push_back(i);
  }
  around[index(from)].clear();
  std::erase_if(around[index(to)], [&](int i) { return is_gone[index(i)]; });
  quadric[index(to)].add(quadric[index(from)]);
  version[index(from)] = -1;
  ++version[index(to)];
  for (const int other : neighbours(to)) {
    push(to, other);
    if (!std::ranges::binary_search(known, other)) push(other, to);
  }
}

Simplifier::Simplifier(std::span<const Facet> mesh) : state_(std::make_unique<State>()) {
  State& s = *state_;
  if (!mesh.empty()) s.part = mesh[0].part;
  s.read(mesh);
  for (const State::Corners& t : s.triangles) {
    const Vec area = s.area(t);
    const double twice = norm(area);
    if (twice <= 0) continue;
    for (const int v : t) s.quadric[index(v)].add_plane((1 / twice) * area, s.at(t[0]), twice);
  }
  s.keep_rims();
  for (int v = 0; v < static_cast<int>(s.place.size()); ++v) {
    for (const int other : s.neighbours(v)) s.push(v, other);
  }
}

Simplifier::~Simplifier() = default;
Simplifier::Simplifier(const Simplifier& other) : state_(std::make_unique<State>(*other.state_)) {}
Simplifier::Simplifier(Simplifier&&) noexcept = default;
Simplifier& Simplifier::operator=(Simplifier&&) noexcept = default;

void Simplifier::simplify(double error, double angle) {
  State& s = *state_;
  const double least_cosine = angle < std::numbers::pi ? std::cos(angle) : -1;
  for (const Move& move : s.refused) s.moves.push(move);
  s.refused.clear();
  while (!s.moves.empty() && s.moves.top().cost <= error * error) {
    const Move next = s.moves.top();
    s.moves.pop();
    if (s.version[index(next.from)] != next.version || s.version[index(next.to)] < 0) continue;
    if (s.fits(next.from, next.to, least_cosine)) {
      s.move(next.from, next.to);
    } else {
      s.refused.push_back(next);
    }
  }
}

std::vector<Facet> Simplifier::facets() const {
  const State& s = *state_;
  std::vector<Facet> facets;
  for (std::size_t i = 0; i < s.triangles.size(); ++i) {
    if (s.is_gone[i]) continue;
    const State::Corners& t = s.triangles[i];
    const Vec3<float> own = broadcast<float>(s.area(t));
    Facet& facet = facets.emplace_back(Facet{.part = s.part});
    for (std::size_t k = 0; k < 3; ++k) {
      facet.corner[k] = s.place[index(t[k])];
      facet.normal[k] = s.normal_at(t[k], own);  // so that edges stay sharp
    }
  }
  return facets;
}

}  // namespace manyhands
