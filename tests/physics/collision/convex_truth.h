// What the tests of contact between simple shapes share: their support functions and signed distances, written apart
// from the kernels; a search for the true signed distance of two shapes; random shapes and poses.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "manyhands/math/quaternion.h"
#include "manyhands/model/description.h"
#include "manyhands/physics/collision/manifold.h"
#include "tests/math/conformance.h"

namespace manyhands::testing {

using Vec = Vec3<double>;
using Pose = Transform<double>;

struct Body {
  ShapeType type{};
  Vec size{};
  Pose X_WB = Pose::identity();
};

inline std::string describe(const Body& body) {
  std::string text = "size";
  const auto add = [&](const Vec& v) {
    for (const double x : {v.x, v.y, v.z}) text += " " + std::to_string(x);
  };
  add(body.size);
  text += " at";
  add(body.X_WB.p);
  text += " axes";
  add(body.X_WB.R.x);
  add(body.X_WB.R.y);
  add(body.X_WB.R.z);
  return text;
}

template <class R>
std::size_t deepest(const Manifold<R>& m) {
  return static_cast<std::size_t>(std::min_element(m.phi.begin(), m.phi.end()) - m.phi.begin());
}

inline Vec unit(const Vec& v) { return (1 / norm(v)) * v; }

/// The largest n . p over the points p of the shape; a plane answers for its own normal only.
inline double support(const Body& body, const Vec& n_W) {
  const Vec n = transpose_times(body.X_WB.R, n_W);
  const double at_origin = dot(n_W, body.X_WB.p);
  switch (body.type) {
    case ShapeType::kSphere:
      return at_origin + body.size.x;
    case ShapeType::kCapsule:
      return at_origin + body.size.x + body.size.y * std::abs(n.z);
    case ShapeType::kCylinder:
      return at_origin + body.size.x * std::hypot(n.x, n.y) + body.size.y * std::abs(n.z);
    case ShapeType::kBox:
      return at_origin + body.size.x * std::abs(n.x) + body.size.y * std::abs(n.y) + body.size.z * std::abs(n.z);
    default:
      return n.z > 1 - 1e-12 ? at_origin : std::numeric_limits<double>::infinity();
  }
}

/// How far the planes across n keep the shapes apart; the greatest over all n is the signed distance.
inline double separation(const Body& a, const Body& b, const Vec& n) { return -support(b, -n) - support(a, n); }

/// Signed distance of a point from the solid shape.
inline double distance_from(const Body& body, const Vec& p_W) {
  const Vec p = transpose_times(body.X_WB.R, p_W - body.X_WB.p);
  const auto of_excess = [](double x, double y, double z) {
    const double outside = std::hypot(std::max(x, 0.0), std::max(y, 0.0), std::max(z, 0.0));
    return outside > 0 ? outside : std::max({x, y, z});
  };
  const double radial = std::hypot(p.x, p.y), z = std::abs(p.z);
  switch (body.type) {
    case ShapeType::kSphere:
      return norm(p) - body.size.x;
    case ShapeType::kCapsule:
      return std::hypot(radial, std::max(z - body.size.y, 0.0)) - body.size.x;
    case ShapeType::kCylinder:
      return of_excess(radial - body.size.x, -1e300, z - body.size.y);
    case ShapeType::kBox:
      return of_excess(std::abs(p.x) - body.size.x, std::abs(p.y) - body.size.y, z - body.size.z);
    default:
      return p.z;
  }
}

/// The signed distance by search: directions all around, then ever finer steps about the best. Never above the truth.
inline double searched_distance(const Body& a, const Body& b) {
  if (b.type == ShapeType::kPlane) return separation(a, b, -b.X_WB.R.z);
  constexpr int kDirections = 400, kStarts = 4;
  std::vector<std::pair<double, Vec>> found;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - (2 * i + 1.0) / kDirections, r = std::sqrt(1 - z * z);
    const Vec n{r * std::cos(golden * i), r * std::sin(golden * i), z};
    found.emplace_back(separation(a, b, n), n);
  }
  std::partial_sort(found.begin(), found.begin() + kStarts, found.end(),
                    [](const auto& x, const auto& y) { return x.first > y.first; });
  double best = -std::numeric_limits<double>::infinity();
  for (int start = 0; start < kStarts; ++start) {
    auto [value, n] = found[static_cast<std::size_t>(start)];
    for (double step = 0.1; step > 1e-8;) {
      const Vec u = unit(cross(n, std::abs(n.x) < 0.7 ? Vec{1, 0, 0} : Vec{0, 1, 0})), v = cross(n, u);
      bool improved = false;
      for (int i = 0; i < 8; ++i) {
        const double angle = i * std::numbers::pi / 4;
        const Vec candidate = unit(n + step * std::cos(angle) * u + step * std::sin(angle) * v);
        const double s = separation(a, b, candidate);
        if (s > value + 1e-10) {
          value = s;
          n = candidate;
          improved = true;
          break;
        }
      }
      if (!improved) step *= 0.4;
    }
    best = std::max(best, value);
  }
  return best;
}

/// Calls check(i, expected) for every number of lane k of a manifold and of the scalar's.
template <Number T, class Check>
void compare_lane(const Manifold<T>& m, const Manifold<real_t<T>>& scalar, int k, Check check) {
  check(lane(m.normal.x, k), scalar.normal.x);
  check(lane(m.normal.y, k), scalar.normal.y);
  check(lane(m.normal.z, k), scalar.normal.z);
  for (std::size_t i = 0; i < m.phi.size(); ++i) {
    check(lane(m.phi[i], k), scalar.phi[i]);
    if (!std::isfinite(scalar.phi[i])) continue;
    check(lane(m.p[i].x, k), scalar.p[i].x);
    check(lane(m.p[i].y, k), scalar.p[i].y);
    check(lane(m.p[i].z, k), scalar.p[i].z);
  }
}

/// Puts numbers of a scalar vector or pose into lane k.
template <Number T>
void put_lane(Vec3<T>& to, int k, const Vec3<real_t<T>>& from) {
  set_lane(to.x, k, from.x);
  set_lane(to.y, k, from.y);
  set_lane(to.z, k, from.z);
}
template <Number T>
void put_lane(Transform<T>& to, int k, const Transform<real_t<T>>& from) {
  put_lane(to.R.x, k, from.R.x);
  put_lane(to.R.y, k, from.R.y);
  put_lane(to.R.z, k, from.R.z);
  put_lane(to.p, k, from.p);
}

/// Checks that lane k of `collide`, a function template of sizes and poses, holds the scalar's bits.
template <Number T, class Bodies, class Collide>
void expect_lanes_collide_as_scalars(int trials, Bodies bodies, Collide collide) {
  using R = real_t<T>;
  for (int trial = 0; trial < trials; ++trial) {
    Vec3<T> size_A, size_B;
    Transform<T> X_WA, X_WB;
    std::array<Manifold<R>, width_v<T>> expected;
    for (int k = 0; k < width_v<T>; ++k) {
      const std::pair<Body, Body> pair = bodies();
      const auto sA = broadcast<R>(pair.first.size), sB = broadcast<R>(pair.second.size);
      const auto XA = broadcast<R>(pair.first.X_WB), XB = broadcast<R>(pair.second.X_WB);
      put_lane(size_A, k, sA);
      put_lane(size_B, k, sB);
      put_lane(X_WA, k, XA);
      put_lane(X_WB, k, XB);
      expected[static_cast<std::size_t>(k)] = collide(sA, XA, sB, XB);
    }
    const Manifold<T> m = collide(size_A, X_WA, size_B, X_WB);
    for (int k = 0; k < width_v<T>; ++k) {
      compare_lane(m, expected[static_cast<std::size_t>(k)], k, [&](R got, R want) {
        ASSERT_TRUE(same(got, want)) << got << ", expected " << want << ", lane " << k << ", trial " << trial;
      });
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
}

/// Whether the normal is of unit length and every point that is one is finite.
template <Real R>
bool is_sound(const Manifold<R>& m) {
  bool sound = std::abs(norm(broadcast<double>(m.normal)) - 1) < 1e-5;
  for (std::size_t k = 0; k < m.phi.size(); ++k) {
    const Vec p = broadcast<double>(m.p[k]);
    sound = sound && !std::isnan(m.phi[k]) && m.phi[k] > -std::numeric_limits<R>::infinity();
    if (std::isfinite(m.phi[k])) sound = sound && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  }
  return sound;
}

/// Seeded random bodies: every size from needles to slabs, every turn, now and then one square to the axes.
class RandomBodies {
 public:
  explicit RandomBodies(unsigned seed) : engine_(seed) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  bool chance(double p) { return uniform(0, 1) < p; }
  double length() { return chance(0.15) ? uniform(0.001, 0.003) : std::exp(uniform(std::log(0.02), std::log(0.4))); }

  Mat3<double> rotation() {
    std::normal_distribution<double> normal;
    Quat<double> q{normal(engine_), normal(engine_), normal(engine_), normal(engine_)};
    if (chance(0.25)) {  // quarter turns, exactly or nearly
      const double tilt = chance(0.5) ? 0 : std::pow(10.0, uniform(-7, -1));
      const double half = std::numbers::sqrt2 / 2;
      q = std::array<Quat<double>, 4>{{{0, 0, 0, 1},
                                       {half, 0, 0, half},
                                       {0, half, 0, half},
                                       {0, 0, half, half}}}[static_cast<std::size_t>(uniform(0, 3.999))];
      q.x += tilt * normal(engine_);
      q.y += tilt * normal(engine_);
    }
    return to_matrix(normalized(q));
  }

  Body body(ShapeType type) { return {type, {length(), length(), length()}, {rotation(), Vec::zero()}}; }

  /// Two bodies that touch, nearly touch, or overlap: at most 2 cm apart, or in up to all the way.
  std::pair<Body, Body> pair(ShapeType type_A, ShapeType type_B) {
    Body a = body(type_A), b = body(type_B);
    if (chance(0.3)) b.X_WB.R = a.X_WB.R;
    b.X_WB.p = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    if (type_B == ShapeType::kPlane) {
      a.X_WB.p = b.X_WB.p + uniform(-0.5, 0.5) * b.X_WB.R.x + uniform(-0.2, 0.5) * b.X_WB.R.z;
      return {a, b};
    }
    const Vec n = chance(0.3) ? a.X_WB.R.x : unit(Vec{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)});
    a.X_WB.p = b.X_WB.p + uniform(-0.5, 0.5) * b.size.x * b.X_WB.R.x + uniform(-0.5, 0.5) * b.size.z * b.X_WB.R.z;
    if (chance(0.05)) return {a, b};  // centres coincide, or nearly
    a.X_WB.p += (separation(a, b, n) + (chance(0.6) ? uniform(-0.003, 0.003) : uniform(-0.1, 0.02))) * n;
    return {a, b};
  }

  /// Two bodies that make trouble: sizes of zero, one place, one turn, sizes and distances of all magnitudes.
  std::pair<Body, Body> hard_pair(ShapeType type_A, ShapeType type_B) {
    const auto size = [&] { return chance(0.3) ? 0.0 : std::pow(10.0, uniform(-4, 3)); };
    Body a = body(type_A), b = body(type_B);
    a.size = {size(), size(), size()};
    b.size = {size(), size(), size()};
    if (chance(0.5)) a.X_WB.R = Mat3<double>::identity();
    if (chance(0.5)) b.X_WB.R = a.X_WB.R;
    const double apart = chance(0.5) ? 0.0 : std::pow(10.0, uniform(-9, 6));
    b.X_WB.p = apart * (chance(0.5) ? a.X_WB.R.y : Vec{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)});
    return {a, b};
  }

 private:
  std::mt19937 engine_;
};

}  // namespace manyhands::testing
