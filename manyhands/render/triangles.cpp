#include "manyhands/render/triangles.h"

#include <algorithm>
#include <mutex>
#include <numbers>
#include <numeric>
#include <unordered_map>

#include "manyhands/base/hash.h"
#include "manyhands/base/index.h"
#include "manyhands/base/process_mutex.h"
#include "manyhands/render/simplify.h"

namespace manyhands {

namespace {

using Vec = Vec3<float>;
using Corner = std::array<int, 3>;

constexpr float kSmooth = 0.766f;  // cosine of the angle below which an edge is none
// Coarser copies are off by these shares of a mesh's size, and kStep times as much from one to the next. Their
// triangles turn away from its normals by as many times kTurn [rad]: in large pictures, one sees by the light how a
// surface is turned. Those that cast shadows turn as they like.
constexpr float kFinest = 1.0f / 1024, kCoarsest = 1.0f / 32;
constexpr float kTurn = 40, kStep = 1.4142135f;
constexpr float kAnyTurn = std::numbers::pi_v<float>;
constexpr float kWorthwhile = 0.7f;  // a copy is kept if it has so many triangles of the last one, or fewer

/// For each vertex, the first one at the same place: files repeat vertices where normals or textures differ.
std::vector<int> merged(const std::vector<Vec>& vertices) {
  std::vector<int> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) { return std::array{vertices[index(i)].x, vertices[index(i)].y, vertices[index(i)].z}; };
  std::ranges::sort(order, [&](int a, int b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool repeats = k > 0 && key(order[k]) == key(order[k - 1]);
    first[index(order[k])] = repeats ? first[index(order[k - 1])] : order[k];
  }
  return first;
}

Vec unit(const Vec& a) {
  const float length = norm(a);
  return length > 0 ? (1 / length) * a : Vec{0, 0, 1};
}

/// Twice the triangle's area, along its normal.
Vec area(const Triangles::Part& part, const Corner& t) {
  const Vec &a = part.vertices[index(t[0])], &b = part.vertices[index(t[1])], &c = part.vertices[index(t[2])];
  return cross(b - a, c - a);
}

std::vector<std::array<Vec, 3>> corner_normals(const Triangles::Part& part) {
  std::vector<Vec> areas;
  areas.reserve(part.triangles.size());
  for (const Corner& t : part.triangles) areas.push_back(area(part, t));
  std::vector<std::array<Vec, 3>> normals;
  if (!part.is_smooth) {
    for (const Vec& a : areas) normals.push_back({unit(a), unit(a), unit(a)});
    return normals;
  }
  const std::vector<int> first = merged(part.vertices);
  std::vector<std::vector<int>> around(part.vertices.size());
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    for (const int v : part.triangles[i]) around[index(first[index(v)])].push_back(static_cast<int>(i));
  }
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    std::array<Vec, 3> corners{};
    const Vec own = unit(areas[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      Vec sum = areas[i];
      for (const int other : around[index(first[index(part.triangles[i][k])])]) {
        if (index(other) != i && dot(own, unit(areas[index(other)])) > kSmooth) sum += areas[index(other)];
      }
      corners[k] = unit(sum);
    }
    normals.push_back(corners);
  }
  return normals;
}

std::vector<Facet> facets_of(const Triangles::Part& part, int number) {
  std::vector<Facet> facets;
  const std::vector<std::array<Vec, 3>> normals = corner_normals(part);
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    Facet& facet = facets.emplace_back(Facet{.normal = normals[i], .part = number});
    for (std::size_t k = 0; k < 3; ++k) facet.corner[k] = part.vertices[index(part.triangles[i][k])];
  }
  return facets;
}

/// Of a box that holds them, from corner to corner [m].
float size_of(const std::vector<Facet>& mesh) {
  if (mesh.empty()) return 0;
  Vec low = mesh[0].corner[0], high = low;
  for (const Facet& facet : mesh) {
    for (const Vec& p : facet.corner) {
      low = {min(low.x, p.x), min(low.y, p.y), min(low.z, p.z)};
      high = {max(high.x, p.x), max(high.y, p.y), max(high.z, p.z)};
    }
  }
  return norm(high - low);
}

std::uint64_t hash_of(const std::vector<Triangles::Part>& parts) {
  Hash hash;
  for (const Triangles::Part& part : parts) {
    hash.add(part.vertices.size());
    hash.add(part.triangles.size());
    hash.add(part.is_smooth);
    for (const Vec& v : part.vertices) {
      for (const float x : {v.x, v.y, v.z}) hash.add(x);
    }
    for (const Corner& t : part.triangles) {
      for (const int v : t) hash.add(v);
    }
  }
  return hash.value();
}

}  // namespace

std::shared_ptr<const Triangles> Triangles::of(std::vector<Part> parts) {
  static ProcessMutex mutex;
  static std::unordered_map<std::uint64_t, std::weak_ptr<const Triangles>> known;
  const std::uint64_t key = hash_of(parts);
  const std::scoped_lock lock(mutex);
  if (std::shared_ptr<const Triangles> found = known[key].lock()) return found;
  std::erase_if(known, [](const auto& entry) { return entry.second.expired(); });
  const std::shared_ptr<const Triangles> made(new Triangles(parts));
  known[key] = made;
  return made;
}

Triangles::Triangles(const std::vector<Part>& parts) : exact_({}, false) {
  std::vector<Facet> all;
  std::vector<Simplifier> untouched;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::vector<Facet> mesh = facets_of(parts[i], static_cast<int>(i));
    all.insert(all.end(), mesh.begin(), mesh.end());
    untouched.emplace_back(mesh);
  }
  exact_ = ClusteredMesh(all, is_closed(all));
  const float size = size_of(all);
  const auto copies = [&](float turn) {
    std::vector<Level> levels;
    std::vector<Simplifier> simplifiers = untouched;
    std::size_t last = all.size();
    for (float share = kFinest; share <= kCoarsest; share *= kStep) {
      std::vector<Facet> coarser;
      for (Simplifier& simplifier : simplifiers) {
        simplifier.simplify(static_cast<double>(share * size), static_cast<double>(min(turn * share, kAnyTurn)));
        const std::vector<Facet> mesh = simplifier.facets();
        coarser.insert(coarser.end(), mesh.begin(), mesh.end());
      }
      if (static_cast<float>(coarser.size()) > kWorthwhile * static_cast<float>(last)) continue;
      last = coarser.size();
      levels.push_back({share * size, ClusteredMesh(coarser, exact_.is_closed)});
    }
    return levels;
  };
  shown_ = copies(kTurn);
  casting_ = copies(kAnyTurn / kFinest);
}

const ClusteredMesh& Triangles::coarsest(const std::vector<Level>& levels, float error) const {
  const auto found =
      std::ranges::find_if(levels.rbegin(), levels.rend(), [&](const Level& level) { return level.error <= error; });
  return found == levels.rend() ? exact_ : found->mesh;
}

}  // namespace manyhands
