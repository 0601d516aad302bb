// World: joints moved by name, and links held together.
#include <algorithm>
#include <cmath>

#include "manyhands/math/quaternion.h"
#include "manyhands/physics/world/world_impl.h"

namespace manyhands {

void World::move(std::span<const JointTarget> targets, double kp, double kd, std::optional<double> max_force) {
  const Model& model = *loose().model;
  std::vector<std::pair<JointId, JointMotor>> motors;
  for (const JointTarget& target : targets) {
    const JointId id = model.joint_id(target.joint);
    const std::string what = "joint '" + target.joint + "'";
    if (joint_v(id).size() != 1) {
      throw std::invalid_argument(what + " has " + std::to_string(joint_v(id).size()) +
                                  " degrees of freedom; a target is for one: use set_motors");
    }
    const JointLimits& limits = model.joint(id).limits;
    constexpr double kOver = 1e-3;  // [rad or m]: bodies that press a joint against its limit push it over
    if (target.q < limits.lower - kOver || target.q > limits.upper + kOver) {
      throw std::invalid_argument(what + " is to go to " + std::to_string(target.q) + ", beyond its limits " +
                                  std::to_string(limits.lower) + " and " + std::to_string(limits.upper));
    }
    const double force = max_force.value_or(limits.effort);
    if (!std::isfinite(force) && !max_force) {
      throw std::invalid_argument(what + " has no effort in its model; give max_force [N m or N]");
    }
    const std::array<double, 4> numbers{target.q, kp, kd, force};
    internal::require_numbers<double>("target, gains and force of " + what, numbers, 4);
    internal::require_not_negative<double>("the gains and force of " + what, std::span(numbers).subspan(1));
    motors.push_back({id, {.target_q = target.q, .kp = kp, .kd = kd, .max_force = force}});
  }
  for (const auto& [id, motor] : motors) set_joint_motor(id, motor);
}

std::string World::weld(std::string_view link_a, std::string_view link_b) {
  const Model& model = *core().model;
  const LinkId a = model.link_id(link_a), b = link_b.empty() ? LinkId(0) : model.link_id(link_b);
  if (a == b) throw std::invalid_argument("a weld holds two links, not '" + std::string(link_a) + "' to itself");
  const std::string name = "weld " + model.link(a).name + " to " + model.link(b).name;
  if (std::ranges::find(model.equalities(), name, &EqualityConstraint::name) != model.equalities().end()) {
    throw std::invalid_argument("there is a '" + name + "' already; end it by unweld");
  }
  add_equality({.name = name,
                .type = EqualityType::kFixed,
                .link_a = a,
                .link_b = b,
                .X_LB = inverse(link_pose(b)) * link_pose(a)});
  return name;
}

void World::unweld(std::string_view name) {
  if (!name.starts_with("weld ")) throw std::out_of_range("there is no weld '" + std::string(name) + "'");
  remove_equality(name);
}

}  // namespace manyhands
