// The parts that parameters belong to, by name, and how a link's mass becomes its body's inertia.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "manyhands/physics/collision/colliders.h"
#include "manyhands/physics/dynamics/params.h"

namespace manyhands {

/// A geom's name, or "link#k" for the k-th nameless geom of its link.
[[nodiscard]] std::string geom_label(const Model& model, GeomId id);
/// The geom of that label. Throws std::out_of_range that lists those there are.
[[nodiscard]] GeomId geom_id(const Model& model, std::string_view label);
/// The colliding geoms of the link of that name, or the one geom of that label. Throws std::out_of_range.
[[nodiscard]] std::vector<GeomId> geoms_named(const Model& model, std::string_view name);
/// The joint of that name. Throws std::invalid_argument for fixed joints, which have no parameters.
[[nodiscard]] const Joint& moving_joint(const Model& model, std::string_view name);
/// The actuator of that name. Throws std::out_of_range that lists those there are.
[[nodiscard]] ActuatorId actuator_id(const Model& model, std::string_view name);

/// Makes room for spinning and rolling friction at pairs whose geoms have any.
template <Real R>
void let_resist_turning(const ParamsView<R>& params, Colliders<R>& colliders) {
  const auto resists = [&](std::size_t collider) {
    const std::size_t geom = colliders.geoms[collider].geom;
    return params.geom_spinning[geom] > 0 || params.geom_rolling[geom] > 0;
  };
  for (ColliderPair& pair : colliders.pairs) {
    pair.torsion = pair.torsion || (pair.surface < 0 && (resists(pair.a) || resists(pair.b)));
  }
}

/// Throws std::invalid_argument if a motor of `max_force` (nv) above 0 meets a position or velocity actuator on its
/// dof.
template <Real R>
void require_undriven(const Model& model, std::span<const R> max_force) {
  std::string names;
  for (const Actuator& actuator : model.actuators()) {
    if (!actuator.joint.is_valid()) continue;
    const Joint& joint = model.joint(actuator.joint);
    const bool drives = actuator.type != ActuatorType::kForce && max_force[static_cast<std::size_t>(joint.iv)] > 0;
    if (drives) names += (names.empty() ? "'" : ", '") + joint.name + "' (by '" + actuator.name + "')";
  }
  if (names.empty()) return;
  throw std::invalid_argument("actuators drive these joints already: " + names +
                              "; set ctrl, or give their motors a max_force of 0");
}

/// Throws std::invalid_argument unless the value is finite and at least `least`; `what` begins the message.
void require_at_least(const std::string& what, double least, double value);

/// Throws std::invalid_argument if the actuator has no gains, or none for positions and kp is not 0.
void require_gains(const Actuator& actuator, double kp);

/// Gives the link another mass, its inertia in proportion. `link_mass` (links) holds every link's present mass.
/// Throws std::invalid_argument if the model's link has no mass, or the mass is not above 0.
template <Real R>
void set_link_mass(const Model& model, LinkId link, double mass, const Strided<R>& link_mass,
                   const ParamsView<R>& params);

/// The same check without the change.
void require_link_mass(const Model& model, LinkId link, double mass);

/// Throws std::invalid_argument unless the numbers of `size` that the shape uses are finite and above 0: see
/// Shape::size. Planes, meshes and height fields use none.
void require_shape_size(const std::string& what, const Shape& shape);
/// The same, and that the shape uses any.
void require_sized(const std::string& geom, const Shape& shape);

}  // namespace manyhands
