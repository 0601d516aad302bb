#include "manyhands/render/clusters.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "manyhands/base/index.h"

namespace manyhands {

namespace {

using Vec = Vec3<float>;
using Key = std::array<float, 6>;

constexpr float kFacing = 1.2f;  // how much directions count in the cut, in sizes of the mesh

Vec area_of(const Facet& facet) { return cross(facet.corner[1] - facet.corner[0], facet.corner[2] - facet.corner[0]); }

Vec unit(const Vec& a) {
  const float length = norm(a);
  return length > 0 ? (1 / length) * a : Vec{0, 0, 0};
}

std::array<float, 3> numbers(const Vec& a) { return {a.x, a.y, a.z}; }

/// By what triangles are near each other: where they are, and where they face.
std::vector<Key> keys_of(std::span<const Facet> mesh) {
  Vec low = mesh[0].corner[0], high = low;
  for (const Facet& facet : mesh) {
    for (const Vec& p : facet.corner) {
      low = {min(low.x, p.x), min(low.y, p.y), min(low.z, p.z)};
      high = {max(high.x, p.x), max(high.y, p.y), max(high.z, p.z)};
    }
  }
  const float facing = kFacing * norm(high - low);
  std::vector<Key> keys;
  keys.reserve(mesh.size());
  for (const Facet& facet : mesh) {
    const Vec middle = (1.0f / 3) * (facet.corner[0] + facet.corner[1] + facet.corner[2]);
    const Vec n = facing * unit(area_of(facet));
    keys.push_back({middle.x, middle.y, middle.z, n.x, n.y, n.z});
  }
  return keys;
}

/// Calls visit(part) for parts of `order` of at most `most` triangles, which it sorts.
template <class Visit>
void cut(std::span<int> order, const std::vector<Key>& keys, std::size_t most, Visit&& visit) {
  if (order.size() <= most) {
    std::ranges::sort(order);
    return visit(order);
  }
  std::size_t widest = 0;
  float width = -1;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const auto by_axis = [&](int i) { return keys[index(i)][axis]; };
    const auto [low, high] = std::ranges::minmax(order, {}, by_axis);
    if (by_axis(high) - by_axis(low) > width) {
      width = by_axis(high) - by_axis(low);
      widest = axis;
    }
  }
  // In whole clusters, so that they are full; ties by number, so that the parts are the same with every library.
  const std::size_t half = (order.size() / 2 + most - 1) / most * most;
  const auto before = [&](int a, int b) {
    const float x = keys[index(a)][widest], y = keys[index(b)][widest];
    return x != y ? x < y : a < b;
  };
  std::ranges::nth_element(order, order.begin() + static_cast<std::ptrdiff_t>(half), before);
  cut(order.first(half), keys, most, visit);
  cut(order.subspan(half), keys, most, visit);
}

/// Appends repetitions of the last number until there is a multiple of kRays.
template <class Numbers>
void fill_up(Numbers& all) {
  while (all.size() % kRays != 0) all.push_back(all.back());
}

void set_bounds(ClusterBounds& bounds, int k, std::span<const Facet> mesh, std::span<const int> part) {
  Vec low = mesh[index(part[0])].corner[0], high = low, sum = Vec::zero();
  for (const int i : part) {
    for (const Vec& p : mesh[index(i)].corner) {
      low = {min(low.x, p.x), min(low.y, p.y), min(low.z, p.z)};
      high = {max(high.x, p.x), max(high.y, p.y), max(high.z, p.z)};
    }
    sum += unit(area_of(mesh[index(i)]));
  }
  const Vec centre = 0.5f * (low + high), axis = unit(sum);
  float radius = 0, least = 1;
  for (const int i : part) {
    for (const Vec& p : mesh[index(i)].corner) radius = max(radius, norm(p - centre));
    const Vec n = unit(area_of(mesh[index(i)]));
    if (squared_norm(n) > 0) least = min(least, dot(axis, n));
  }
  constexpr float kRoom = 1e-4f, kTooWide = 2;
  const auto put = [&](Vec3<Rays>& to, const Vec& from) {
    set_lane(to.x, k, from.x);
    set_lane(to.y, k, from.y);
    set_lane(to.z, k, from.z);
  };
  put(bounds.centre, centre);
  put(bounds.axis, axis);
  set_lane(bounds.radius, k, radius * (1 + kRoom));
  set_lane(bounds.spread, k, least > 0 ? std::sqrt(max(1 - least * least, 0.0f)) + kRoom : kTooWide);
}

}  // namespace

bool is_closed(std::span<const Facet> mesh) {
  using Edge = std::pair<std::array<float, 3>, std::array<float, 3>>;
  std::vector<Edge> there, back;
  for (const Facet& facet : mesh) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = numbers(facet.corner[k]), b = numbers(facet.corner[(k + 1) % 3]);
      if (a == b) continue;
      there.emplace_back(a, b);
      back.emplace_back(b, a);
    }
  }
  std::ranges::sort(there);
  std::ranges::sort(back);
  return there == back;
}

ClusteredMesh::ClusteredMesh(std::span<const Facet> mesh, bool closed) : is_closed(closed) {
  if (mesh.empty()) return;
  const std::vector<Key> keys = keys_of(mesh);
  std::vector<int> order(mesh.size());
  std::iota(order.begin(), order.end(), 0);
  cut(order, keys, kMostTriangles, [&](std::span<const int> part) {
    Cluster cluster{static_cast<int>(x.size()), 0, static_cast<int>(facets.size()), 0};
    std::vector<std::pair<std::array<float, 3>, std::uint8_t>> known;
    for (const int i : part) {
      facets.push_back(mesh[index(i)]);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::array<float, 3> p = numbers(mesh[index(i)].corner[k]);
        auto found = std::ranges::find(known, p, [](const auto& one) { return one.first; });
        if (found == known.end()) {
          found = known.insert(known.end(), {p, static_cast<std::uint8_t>(known.size())});
          x.push_back(p[0]);
          y.push_back(p[1]);
          z.push_back(p[2]);
        }
        corners[k].push_back(found->second);
      }
    }
    for (auto* all : {&x, &y, &z}) fill_up(*all);
    while (facets.size() % kRays != 0) {
      facets.push_back({});
      for (auto& all : corners) all.push_back(0);
    }
    cluster.num_vertices = static_cast<int>(x.size()) - cluster.first_vertex;
    cluster.num_triangles = static_cast<int>(facets.size()) - cluster.first_triangle;
    const int k = static_cast<int>(clusters.size()) % kRays;
    if (k == 0) bounds.push_back({.centre = {}, .radius = Rays(-1.0f), .axis = {}, .spread = Rays(0.0f)});
    set_bounds(bounds.back(), k, mesh, part);
    clusters.push_back(cluster);
  });
}

}  // namespace manyhands
