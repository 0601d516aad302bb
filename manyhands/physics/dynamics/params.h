// The numbers of a model that may differ from world to world.
#pragma once

#include <vector>

#include "manyhands/math/spatial.h"
#include "manyhands/model/model.h"
#include "manyhands/physics/dynamics/field.h"

namespace manyhands {

/// The one list of what Params holds: field(name, item, one for each, range). Struct, views, snapshots, hashes and what
/// a World carries over to other parts all follow it.
// clang-format off
#define MANYHANDS_PARAMS_FIELDS(field)                                                                                \
  field(gravity,          Vec3<T>,         kWorld,    kFinite)      /* [m/s^2], in the world frame */                 \
  field(inertia,          RigidInertia<T>, kBody,     kFinite)      /* about the body's origin, in its axes */        \
  field(lifted_mass,      T,               kLift,     kFinite)      /* that gravity compensation carries [kg] */     \
  field(lifted_moment,    Vec3<T>,         kLift,     kFinite)      /* its first moment, in the body's axes [kg m] */ \
  field(damping,          T,               kDof,      kNotNegative) /* [N m s/rad or N s/m] */                        \
  field(armature,         T,               kDof,      kNotNegative) /* [kg m^2 or kg] */                              \
  field(friction,         T,               kDof,      kForceLimit)  /* dry friction of the joint [N m or N] */        \
  field(stiffness,        T,               kDof,      kNotNegative) /* of the joint's spring [N m/rad or N/m] */      \
  field(spring_reference, T,               kCoordinate, kFinite)    /* q at which it is at rest */                    \
  field(lower,            T,               kDof,      kLimit)       /* [rad or m]; infinite where there is none */    \
  field(upper,            T,               kDof,      kLimit)       /* likewise */                                    \
  field(motor_kp,         T,               kDof,      kNotNegative) /* per step, dimensionless: World::set_motors */  \
  field(motor_kd,         T,               kDof,      kNotNegative) /* likewise */                                    \
  field(motor_max_force,  T,               kDof,      kForceLimit)  /* [N m or N]; 0 where there is no motor */       \
  field(tendon_damping,    T,              kTendon,   kNotNegative) /* see Tendon */                                  \
  field(tendon_armature,   T,              kTendon,   kNotNegative) /* likewise, as all of tendons */                 \
  field(tendon_friction,   T,              kTendon,   kForceLimit)                                                    \
  field(tendon_stiffness,  T,              kTendon,   kNotNegative)                                                   \
  field(tendon_rest_lower, T,              kTendon,   kFinite)      /* its spring pulls below it, */                  \
  field(tendon_rest_upper, T,              kTendon,   kFinite)      /* and above it */                                \
  field(tendon_lower,      T,              kTendon,   kLimit)                                                         \
  field(tendon_upper,      T,              kTendon,   kLimit)                                                         \
  field(gear,             T,               kActuator, kFinite)      /* see ActuatorType */                            \
  field(drive_kp,         T,               kActuator, kFinite)      /* see Actuator */                                \
  field(drive_kd,         T,               kActuator, kFinite)      /* see Actuator */                                \
  field(drive_max_force,  T,               kActuator, kForceLimit)  /* at the joint, about middle_force [N m or N] */  \
  field(geom_size,        Vec3<T>,         kGeom,     kNotNegative) /* see Shape [m] */                               \
  field(geom_friction,    T,               kGeom,     kNotNegative) /* lateral, along the geom's x */                 \
  field(geom_friction_y,  T,               kGeom,     kNotNegative) /* along its y */                                 \
  field(geom_spinning,    T,               kGeom,     kNotNegative) /* [m] */                                         \
  field(geom_rolling,     T,               kGeom,     kNotNegative) /* [m] */                                         \
  field(geom_restitution, T,               kGeom,     kNotNegative)
// clang-format on

/// About which the bounds of an actuator's force lie: 0 unless they differ [N m or N].
[[nodiscard]] double middle_force(const Actuator& actuator);

/// Set from the model, then randomised at will. Kernels take P = T, numbers of their own for every lane, or
/// P = real_t<T>, the same for all: that is smaller and stays in the nearest cache. A view: the numbers lie in the
/// memory of a WorldBlock or a ParamsStorage.
template <Number T>
struct Params {
  Params() = default;
  Params(const Params&) = delete;
  Params& operator=(const Params&) = delete;

#define MANYHANDS_FIELD(name, Item, each, range) Field<Item> name;
  MANYHANDS_PARAMS_FIELDS(MANYHANDS_FIELD)
#undef MANYHANDS_FIELD

  /// Calls visit(info, field of each of `params`...) for every field, in the order of memory.
  template <class Visit, class... Views>
  static void visit_fields(Visit&& visit, Views&... params) {
#define MANYHANDS_FIELD(name, Item, each, range) visit(FieldInfo{#name, Each::each, Range::range}, params.name...);
    MANYHANDS_PARAMS_FIELDS(MANYHANDS_FIELD)
#undef MANYHANDS_FIELD
  }

  /// Writes down what the model says; motors are off.
  void take(const Model& model);
};

/// One world's Params: the numbers of a lane, those of structs one after the other.
template <Real R>
struct ParamsView {
#define MANYHANDS_FIELD(name, Item, each, range) Strided<R> name;
  MANYHANDS_PARAMS_FIELDS(MANYHANDS_FIELD)
#undef MANYHANDS_FIELD

  template <class Visit, class... Views>
  static void visit_fields(Visit&& visit, Views&... views) {
    Params<R>::visit_fields(visit, views...);
  }
};

template <Number T>
[[nodiscard]] ParamsView<real_t<T>> view(Params<T>& params, std::size_t lane) {  ///< of one lane
  ParamsView<real_t<T>> result;
  Params<T>::visit_fields([lane](const FieldInfo&, auto& field, auto& numbers) { numbers = lane_of<T>(field, lane); },
                          params, result);
  return result;
}

/// Params that own their memory.
template <Number T>
class ParamsStorage : public Params<T> {
 public:
  explicit ParamsStorage(const Model& model) : ParamsStorage(Layout(model)) { this->take(model); }
  /// All zeros.
  explicit ParamsStorage(const Layout& layout) : layout_(layout), memory_(internal::numbers_of<T>(layout, params())) {
    internal::place_fields(layout_, memory_.data(), params());
  }
  ParamsStorage(const ParamsStorage& other) : Params<T>(), layout_(other.layout_), memory_(other.memory_) {
    internal::place_fields(layout_, memory_.data(), params());
  }
  ParamsStorage& operator=(const ParamsStorage& other) {
    layout_ = other.layout_;
    memory_ = other.memory_;
    internal::place_fields(layout_, memory_.data(), params());
    return *this;
  }

 private:
  [[nodiscard]] Params<T>& params() { return *this; }

  Layout layout_;
  std::vector<T> memory_;
};

}  // namespace manyhands
