#include "manyhands/planning/grasp_quality.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "manyhands/model/hull_depth.h"
#include "manyhands/model/unit.h"

namespace manyhands {

namespace {

using Vec = Vec3<double>;

void append(std::vector<double>& points, const Vec& force, const Vec& moment) {
  points.insert(points.end(), {force.x, force.y, force.z, moment.x, moment.y, moment.z});
}

}  // namespace

double epsilon_quality(std::span<const GraspContact> contacts, const Vec& about, double length, int edges) {
  if (edges < 3) throw std::invalid_argument("edges is " + std::to_string(edges) + "; expected 3 or more");
  std::vector<double> wrenches;
  for (const GraspContact& c : contacts) {
    const Mat3<double> R = rotation_to_normal(c.normal);
    const Vec arm = (1 / length) * (c.point - about);
    for (int k = 0; k < edges; ++k) {
      const double angle = 2 * std::numbers::pi * k / edges;
      const Vec force = c.normal + c.friction * (std::cos(angle) * R.x + std::sin(angle) * R.y);
      append(wrenches, force, cross(arm, force));
    }
    const Vec twist = (c.torsion / length) * c.normal;
    if (c.torsion > 0) {
      for (const Vec& moment : {twist, -twist}) append(wrenches, c.normal, cross(arm, c.normal) + moment);
    }
  }
  return depth_in_hull(std::move(wrenches), 6);
}

}  // namespace manyhands
