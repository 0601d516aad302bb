#include "manyhands/physics/dynamics/params.h"

#include <algorithm>

#include "manyhands/math/instantiate.h"
#include "manyhands/physics/dynamics/tree.h"

namespace manyhands {

Layout::Layout(const Model& model, std::size_t contact_numbers)
    : counts_{1,
              static_cast<std::size_t>(model.nq()),
              static_cast<std::size_t>(model.nv()),
              static_cast<std::size_t>(model.nu()),
              equality_rows(model),
              contact_numbers,
              model.bodies().size(),
              model.geoms().size(),
              model.links().size(),
              model.lifts().size(),
              kPoseNumbers * model.mocap_bodies().size(),
              model.tendons().size(),
              static_cast<std::size_t>(model.na())} {}

bool Layout::has_room(const FieldInsertion& at) const {
  for (std::size_t k = 0; k < kKindsOfEach; ++k) {
    if (counts_[k] + static_cast<std::size_t>(at[k].new_size) > room(static_cast<Each>(k))) return false;
  }
  return true;
}

void Layout::reserve_twice(const FieldInsertion& at) {
  for (std::size_t k = 0; k < kKindsOfEach; ++k) {
    const std::size_t count = counts_[k] + static_cast<std::size_t>(at[k].new_size);
    rooms_[k] = count > room(static_cast<Each>(k)) ? 2 * count : room(static_cast<Each>(k));
  }
}

void Layout::add(const FieldInsertion& at) {
  for (std::size_t k = 0; k < kKindsOfEach; ++k) counts_[k] += static_cast<std::size_t>(at[k].new_size);
}

double middle_force(const Actuator& actuator) {
  return actuator.min_force ? 0.5 * (*actuator.min_force + actuator.max_force) : 0;
}

template <Number T>
void Params<T>::take(const Model& model) {
  const auto number = [](double value) { return T(static_cast<real_t<T>>(value)); };
  gravity[0] = broadcast<T>(model.gravity());
  std::ranges::transform(model.bodies(), inertia.begin(), [](const Body& body) { return broadcast<T>(body.inertia); });
  for (std::size_t i = 0; i < lifted_mass.size(); ++i) {
    lifted_mass[i] = number(model.lifts()[i].mass);
    lifted_moment[i] = broadcast<T>(model.lifts()[i].moment);
  }
  std::ranges::transform(model.dof_damping(), damping.begin(), number);
  std::ranges::transform(model.dof_armature(), armature.begin(), number);
  std::ranges::transform(model.dof_friction(), friction.begin(), number);
  std::ranges::transform(model.dof_stiffness(), stiffness.begin(), number);
  std::ranges::transform(model.spring_reference(), spring_reference.begin(), number);
  for (std::size_t i = 0; i < lower.size(); ++i) {
    lower[i] = number(model.dof_limits()[i].lower);
    upper[i] = number(model.dof_limits()[i].upper);
    motor_kp[i] = motor_kd[i] = motor_max_force[i] = number(0);
  }
  for (std::size_t i = 0; i < geom_size.size(); ++i) {
    const Geom& geom = model.geoms()[i];
    const SurfaceMaterial& surface = geom.surface;
    geom_size[i] = broadcast<T>(geom.shape.size);
    geom_friction[i] = number(surface.lateral_friction);
    geom_friction_y[i] = number(surface.friction_y.value_or(surface.lateral_friction));
    geom_spinning[i] = number(surface.spinning_friction);
    geom_rolling[i] = number(surface.rolling_friction);
    geom_restitution[i] = number(surface.restitution);
  }
  for (std::size_t i = 0; i < tendon_damping.size(); ++i) {
    const Tendon& tendon = model.tendons()[i];
    tendon_damping[i] = number(tendon.damping);
    tendon_armature[i] = number(tendon.armature);
    tendon_friction[i] = number(tendon.friction);
    tendon_stiffness[i] = number(tendon.stiffness);
    tendon_rest_lower[i] = number(tendon.spring_lower);
    tendon_rest_upper[i] = number(tendon.spring_upper);
    tendon_lower[i] = number(tendon.lower);
    tendon_upper[i] = number(tendon.upper);
  }
  for (std::size_t i = 0; i < gear.size(); ++i) {
    const Actuator& actuator = model.actuators()[i];
    gear[i] = number(actuator.gear);
    drive_kp[i] = number(actuator.type == ActuatorType::kPosition ? actuator.kp : 0.0);
    drive_kd[i] = number(actuator.kd);
    drive_max_force[i] = number(actuator.max_force - middle_force(actuator));
  }
}

#define MANYHANDS_INSTANTIATE(T) template struct Params<T>;
MANYHANDS_FOR_EACH_NUMBER(MANYHANDS_INSTANTIATE)

}  // namespace manyhands
