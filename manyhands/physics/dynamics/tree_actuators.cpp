#include "manyhands/physics/dynamics/tree_actuators.h"

#include <algorithm>
#include <numbers>

#include "manyhands/base/index.h"

namespace manyhands {

namespace {

template <Real R>
std::array<R, 3> numbers(const std::array<double, 3>& from) {
  return {static_cast<R>(from[0]), static_cast<R>(from[1]), static_cast<R>(from[2])};
}

/// A servo between two sites that only turns takes the shorter way, as in MuJoCo: the period of its error; 0 for
/// others.
double period_of(const Actuator& actuator) {
  const bool turns = actuator.type == ActuatorType::kPosition && actuator.ctrl_scale == 1 && actuator.site &&
                     actuator.site->reference.is_valid() && norm(actuator.site->force) == 0;
  return turns ? 2 * std::numbers::pi * norm(actuator.site->torque) : 0;
}

/// All but what it acts on.
template <Real R>
TreeActuator<R> tree_actuator(const Actuator& actuator) {
  return {.type = actuator.type,
          .scale = static_cast<R>(actuator.ctrl_scale),
          .offset = static_cast<R>(actuator.ctrl_offset),
          .period = static_cast<R>(period_of(actuator)),
          .middle_force = static_cast<R>(middle_force(actuator)),
          .gain = numbers<R>(actuator.gain),
          .bias = numbers<R>(actuator.bias),
          .activation = actuator.activation.type,
          .act = actuator.iact,
          .time_constant = static_cast<R>(actuator.activation.time_constant),
          .least_act = static_cast<R>(actuator.activation.lower),
          .most_act = static_cast<R>(actuator.activation.upper),
          .early = actuator.activation.early};
}

}  // namespace

template <Real R>
void add_actuators(const Model& model, Tree<R>& tree) {
  tree.dof_drive.assign(index(tree.num_laws()), -1);
  const auto num_sites = std::ranges::count_if(model.actuators(), [](const Actuator& a) { return a.site.has_value(); });
  std::size_t site = tree.lengths.size() - static_cast<std::size_t>(num_sites);
  for (const Actuator& actuator : model.actuators()) {
    TreeActuator<R> added = tree_actuator<R>(actuator);
    if (actuator.joint.is_valid()) {
      const Joint& joint = model.joint(actuator.joint);
      added.law = index(joint.iv);
      added.q = index(joint.iq);
    } else {
      added.q = actuator.site ? site++ : actuator.tendon.index();
      added.law = index(tree.nv) + added.q;
    }
    const auto shares = [&](const TreeActuator<R>& other) { return is_drive(other.type) && other.law == added.law; };
    if (is_drive(actuator.type)) {
      tree.dof_drive[added.law] = static_cast<int>(tree.actuators.size());
      for (TreeActuator<R>& other : tree.actuators) {
        if (shares(other)) other.is_shared = added.is_shared = true;
      }
    }
    tree.actuators.push_back(added);
  }
}

template void add_actuators(const Model&, Tree<double>&);
template void add_actuators(const Model&, Tree<float>&);

}  // namespace manyhands
