// The parameters of one world by name: where they lie in Params, and how a link's mass becomes its body's inertia.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "manyhands/physics/collision/colliders.h"
#include "manyhands/physics/dynamics/tree.h"

namespace manyhands {

/// Numbers of one world that lie `stride` apart: those of one lane.
template <Real R>
struct Strided {
  R* first = nullptr;
  std::size_t stride = 1, count = 0;

  [[nodiscard]] std::size_t size() const { return count; }
  [[nodiscard]] R& operator[](std::size_t i) const { return first[i * stride]; }
};

/// One lane of a vector of numbers, or of structs that consist of numbers.
template <Real R, class Item>
[[nodiscard]] Strided<R> lane_of(std::vector<Item>& items, std::size_t lane, std::size_t width) {
  static_assert(sizeof(Item) % sizeof(R) == 0);
  if (items.empty()) return {};
  return {reinterpret_cast<R*>(items.data()) + lane, width, items.size() * sizeof(Item) / sizeof(R) / width};
}

/// What one world's Params hold, field by field.
template <Real R>
struct ParamsView {
  Strided<R> gravity;  ///< (3)
  Strided<R> inertia;  ///< (nb, 10): m, h, then xx yy zz xy xz yz
  Strided<R> damping, armature, lower, upper, motor_kp, motor_kd, motor_max_force, friction;  ///< (nv)
  Strided<R> gear, drive_kp, drive_kd, drive_max_force;                                       ///< (nu)
  Strided<R> geom_size;                                                                       ///< (geoms, 3)
  Strided<R> geom_friction, geom_friction_y, geom_spinning, geom_rolling, geom_restitution;   ///< (geoms)

  /// Calls visit(field) for every field, always in the same order.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const Strided<R>* field :
         {&gravity,       &inertia,         &damping,       &armature,        &lower,
          &upper,         &motor_kp,        &motor_kd,      &motor_max_force, &friction,
          &gear,          &drive_kp,        &drive_kd,      &drive_max_force, &geom_size,
          &geom_friction, &geom_friction_y, &geom_spinning, &geom_rolling,    &geom_restitution}) {
      visit(*field);
    }
  }
};

/// The numbers of lane `lane` of `params`.
template <Number T>
[[nodiscard]] ParamsView<real_t<T>> view(Params<T>& params, std::size_t lane) {
  using R = real_t<T>;
  constexpr auto width = static_cast<std::size_t>(width_v<T>);
  const auto of = [&](auto& items) { return lane_of<R>(items, lane, width); };
  return {.gravity = {reinterpret_cast<R*>(&params.gravity) + lane, width, 3},
          .inertia = of(params.inertia),
          .damping = of(params.damping),
          .armature = of(params.armature),
          .lower = of(params.lower),
          .upper = of(params.upper),
          .motor_kp = of(params.motor_kp),
          .motor_kd = of(params.motor_kd),
          .motor_max_force = of(params.motor_max_force),
          .friction = of(params.friction),
          .gear = of(params.gear),
          .drive_kp = of(params.drive_kp),
          .drive_kd = of(params.drive_kd),
          .drive_max_force = of(params.drive_max_force),
          .geom_size = of(params.geom_size),
          .geom_friction = of(params.geom_friction),
          .geom_friction_y = of(params.geom_friction_y),
          .geom_spinning = of(params.geom_spinning),
          .geom_rolling = of(params.geom_rolling),
          .geom_restitution = of(params.geom_restitution)};
}

/// A geom's name, or "link#k" for the k-th nameless geom of its link.
[[nodiscard]] std::string geom_label(const Model& model, GeomId id);
/// The geom of that label. Throws std::out_of_range that lists those there are.
[[nodiscard]] GeomId geom_id(const Model& model, std::string_view label);
/// The colliding geoms of the link of that name, or the one geom of that label. Throws std::out_of_range.
[[nodiscard]] std::vector<GeomId> geoms_named(const Model& model, std::string_view name);
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
