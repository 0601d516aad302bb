#include "manyhands/planning/grasps.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include "manyhands/math/philox.h"
#include "manyhands/model/unit.h"
#include "manyhands/physics/collision/queries/distance.h"
#include "manyhands/planning/checks.h"
#include "manyhands/planning/grasp_quality.h"

namespace manyhands {

namespace {

using Vec = Vec3<double>;

constexpr int kLinesPerSample = 1000;  // random lines that may miss the object
constexpr int kTurns = 20;             // of a line that looks for agreeing normals
constexpr double kSameQuality = 1e-6;  // qualities that differ by less are equal

/// Two ends of a line through the object.
struct Pair {
  std::array<Vec, 2> points{}, normals{};  // as in Grasp
  Vec along{};                             // unit, from the first to the second
  double angle{};                          // between the line and the normal that agrees less [rad]

  [[nodiscard]] double width() const { return norm(points[1] - points[0]); }
};

double angle_between(const Vec& a, const Vec& b) { return std::atan2(norm(cross(a, b)), dot(a, b)); }

/// Of a ball about the centre of mass that holds the object [m].
double ball_radius(const GraspObject& object) {
  double radius = 0;
  const auto include = [&](const Vec& p, double more) { radius = std::max(radius, norm(p - object.com) + more); };
  for (const PlacedShape& placed : object.shapes) {
    if (placed.shape.type == ShapeType::kMesh) {
      for (const Vec& vertex : placed.shape.mesh->vertices()) include(placed.X * vertex, 0);
    } else if (placed.shape.type == ShapeType::kConvex) {
      for (const Vec& vertex : placed.shape.hull->vertices) include(placed.X * vertex, 0);
    } else {
      include(placed.X.p, placed.shape.convex().bound());
    }
  }
  return radius;
}

class GraspFinder {
 public:
  GraspFinder(const GraspObject& object, std::span<const PlacedShape> obstacles, const ParallelGripper& gripper,
              const GraspSettings& settings)
      : object_(object),
        gripper_(gripper),
        settings_(settings),
        obstacles_(obstacles),
        random_(settings.seed, 0, 0),
        radius_(ball_radius(object)),
        approach_(at_unit_length(settings.approach)) {}

  [[nodiscard]] std::vector<Grasp> find() {
    int samples = 0;
    for (int line = 0; samples < settings_.samples && line < kLinesPerSample * settings_.samples; ++line) {
      const Vec d = random_direction();
      const Vec o = object_.com + random_across(d);
      for (const Crossing& crossing : crossings(object_.shapes, o, d, reach())) {
        if (samples++ < settings_.samples) look_from(fma(crossing.from, d, o), crossing.normal_from);
      }
    }
    sort();
    return std::move(found_);
  }

 private:
  [[nodiscard]] double reach() const { return 2.5 * radius_; }  // lines begin and end outside, wherever they pass

  Vec random_direction() {
    const double z = random_.uniform(-1.0, 1.0), angle = random_.uniform(0.0, 2 * std::numbers::pi);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

  /// A point of the disc across d through the origin.
  Vec random_across(const Vec& d) {
    const double r = radius_ * std::sqrt(random_.unit<double>()), angle = random_.uniform(0.0, 2 * std::numbers::pi);
    const Mat3<double> R = rotation_to_normal(d);
    return r * (std::cos(angle) * R.x + std::sin(angle) * R.y);
  }

  /// All pairs of which one end is a point of the surface with the outward normal n.
  void look_from(const Vec& p, const Vec& n) {
    for (const Crossing& end : crossings(object_.shapes, p, -n, reach())) {
      if (end.to <= 0 || end.to > gripper_.opening) continue;
      Pair pair = {.points = {p, fma(end.to, -n, p)}, .normals = {n, end.normal_to}, .along = -n};
      pair.angle = angle_between(pair.along, end.normal_to);
      turn(pair);
      if (pair.angle > std::atan(settings_.friction) || pair.width() + 2 * settings_.clearance > gripper_.opening)
        continue;
      take(pair);
    }
  }

  /// Turns the line about its middle towards its normals for as long as they agree better.
  void turn(Pair& pair) const {
    for (int i = 0; i < kTurns; ++i) {
      const Vec between = pair.normals[1] - pair.normals[0];
      if (!(norm(between) > 1e-6)) return;
      const Vec d = at_unit_length(between), middle = 0.5 * (pair.points[0] + pair.points[1]);
      const double half = 0.5 * pair.width();
      const std::vector<Crossing> through = crossings(object_.shapes, middle, d, reach());
      if (through.empty()) return;
      const Crossing& in = *std::ranges::min_element(through, {}, [&](const auto& c) { return abs(c.from + half); });
      const Crossing& out = *std::ranges::min_element(through, {}, [&](const auto& c) { return abs(c.to - half); });
      if (out.to <= in.from) return;
      const double angle = std::max(angle_between(-d, in.normal_from), angle_between(d, out.normal_to));
      if (!(angle < pair.angle)) return;
      pair = {{fma(in.from, d, middle), fma(out.to, d, middle)}, {in.normal_from, out.normal_to}, d, angle};
    }
  }

  /// Every way of the hand to two contacts that is free.
  void take(const Pair& pair) {
    const Vec middle = 0.5 * (pair.points[0] + pair.points[1]), y = pair.along;
    const Vec aim = approach_ - dot(approach_, y) * y;
    const Vec first = norm(aim) > 1e-6 ? at_unit_length(aim) : rotation_to_normal(y).x;
    double quality = -1;
    for (int k = 0; k < settings_.approaches; ++k) {
      const double angle = 2 * std::numbers::pi * k / settings_.approaches;
      const Vec z = std::cos(angle) * first + std::sin(angle) * cross(y, first);
      if (angle_between(z, approach_) > settings_.tilt + 1e-9) continue;
      const Transform<double> X_OG{{cross(y, z), y, z}, middle};
      if (!is_free(X_OG, pair.width())) continue;
      if (quality < 0) quality = quality_of(pair);
      const double margin = std::atan(settings_.friction) - pair.angle;
      found_.push_back({X_OG, pair.width(), quality, margin, pair.points, pair.normals});
    }
  }

  /// Pads are pressed on evenly, so they resist turning by 2/3 of friction times radius.
  [[nodiscard]] double quality_of(const Pair& pair) const {
    const double torsion = settings_.friction * gripper_.width / 3;
    const std::array<GraspContact, 2> contacts{
        GraspContact{pair.points[0], -pair.normals[0], settings_.friction, torsion},
        GraspContact{pair.points[1], -pair.normals[1], settings_.friction, torsion}};
    return epsilon_quality(contacts, object_.com, radius_);
  }

  [[nodiscard]] bool is_free(const Transform<double>& X_OG, double width) const {
    const ParallelGripper& g = gripper_;
    const Vec jaw{0.5 * g.width, 0.5 * g.thickness, 0.5 * (g.depth + g.reach)};
    const double y = 0.5 * width + settings_.clearance + jaw.y, z = 0.5 * (g.reach - g.depth);
    return is_free(jaw, X_OG, {0, y, z}) && is_free(jaw, X_OG, {0, -y, z}) &&
           is_free(0.5 * g.palm, X_OG, {0, 0, -g.depth - 0.5 * g.palm.z});
  }

  /// A box of the hand, of half extents and at a place in G.
  [[nodiscard]] bool is_free(const Vec& half, const Transform<double>& X_OG, const Vec& at) const {
    const ShapeView box{.type = ShapeType::kBox, .size = half};
    const Transform<double> X_OB{X_OG.R, X_OG * at};
    const auto is_apart = [&](const PlacedShape& other) {
      return signed_distance(box, X_OB, other.shape, other.X).phi > 0;
    };
    return std::ranges::all_of(object_.shapes, is_apart) && std::ranges::all_of(obstacles_, is_apart);
  }

  void sort() {
    const auto rank = [&](const Grasp& grasp) {
      const double off_centre = norm(grasp.X_OG.p - object_.com), off_aim = -dot(grasp.X_OG.R.z, approach_);
      return std::tuple(-std::round(grasp.quality / kSameQuality), std::round(off_centre / kSameQuality), off_aim);
    };
    std::ranges::stable_sort(found_, {}, rank);
  }

  const GraspObject& object_;
  const ParallelGripper& gripper_;
  const GraspSettings& settings_;
  std::span<const PlacedShape> obstacles_;
  RandomStream random_;
  double radius_;
  Vec approach_;
  std::vector<Grasp> found_{};
};

void require(bool holds, const char* name, double value, const char* expected) {
  if (!holds) throw std::invalid_argument(std::string(name) + " is " + as_text(value) + "; expected " + expected);
}

void require_settings(const GraspSettings& s) {
  require(s.friction > 0 && is_finite(s.friction), "friction", s.friction, "a number above 0");
  require(s.samples > 0, "samples", s.samples, "1 or more");
  require(s.approaches > 0, "approaches", s.approaches, "1 or more");
  require(s.clearance >= 0 && is_finite(s.clearance), "clearance", s.clearance, "0 or more");
  require(s.tilt >= 0, "tilt", s.tilt, "0 or more");
  const double length = norm(s.approach);
  require(length > 0 && is_finite(length), "the length of approach", length, "a number above 0");
}

void require_solid(const GraspObject& object) {
  if (object.shapes.empty()) throw std::invalid_argument("the object has no shape that touches; give it one");
  for (const PlacedShape& placed : object.shapes) {
    if (placed.shape.type == ShapeType::kPlane || placed.shape.type == ShapeType::kHeightField)
      throw std::invalid_argument("the object is a plane or a height field; expected a solid");
  }
}

}  // namespace

void require_lengths(const ParallelGripper& g) {
  const auto above_0 = [](const char* name, double x) { require(x > 0 && is_finite(x), name, x, "a number above 0"); };
  above_0("the gripper's opening", g.opening);
  above_0("the gripper's depth", g.depth);
  above_0("the gripper's reach", g.reach);
  above_0("the gripper's width", g.width);
  above_0("the gripper's thickness", g.thickness);
  for (const double x : {g.palm.x, g.palm.y, g.palm.z}) above_0("the palm's size", x);
}

std::vector<Grasp> find_grasps(const GraspObject& object, std::span<const PlacedShape> obstacles,
                               const ParallelGripper& gripper, const GraspSettings& settings) {
  require_solid(object);
  require_lengths(gripper);
  require_settings(settings);
  return GraspFinder(object, obstacles, gripper, settings).find();
}

}  // namespace manyhands
