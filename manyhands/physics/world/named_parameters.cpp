#include "manyhands/physics/world/named_parameters.h"

#include "manyhands/base/float_environment.h"
#include "manyhands/model/part_checks.h"
#include "manyhands/physics/world/world_checks.h"

namespace manyhands {

using internal::require_rows;

template <Real R>
void NamedParameters<R>::require_not_negative(const std::string& what, std::span<const R> values) const {
  require_rows(what, values, n_, 1);
  for (std::size_t i = 0; i < n_; ++i) {
    require_at_least(n_ == 1 ? what : what + " in world " + std::to_string(i), 0, static_cast<double>(values[i]));
  }
}

template <Real R>
void NamedParameters<R>::set_geoms(std::string_view name, const std::string& what, Field field,
                                   std::span<const R> values) const {
  require_not_negative(what + " of '" + std::string(name) + "'", values);
  const std::vector<GeomId> geoms = geoms_named(model_, name);
  for (std::size_t i = 0; i < n_; ++i) {
    const ParamsView<R> params = worlds_(i).params;
    for (const GeomId id : geoms) (params.*field)[id.index()] = values[i];
  }
}

template <Real R>
void NamedParameters<R>::set_dofs(std::string_view name, const std::string& what, Field field,
                                  std::span<const R> values) const {
  require_not_negative(what + " of joint '" + std::string(name) + "'", values);
  const Joint& joint = moving_joint(model_, name);
  for (std::size_t i = 0; i < n_; ++i) {
    const ParamsView<R> params = worlds_(i).params;
    for (int k = 0; k < velocity_size(joint.type); ++k) {
      (params.*field)[static_cast<std::size_t>(joint.iv + k)] = values[i];
    }
  }
}

template <Real R>
void NamedParameters<R>::let_resist_turning() const {
  for (std::size_t i = 0; i < n_; ++i) manyhands::let_resist_turning(worlds_(i).params, colliders_);
}

template <Real R>
void NamedParameters<R>::set_gravity(std::span<const R> gravity) const {
  require_rows("gravity", gravity, n_, 3);
  for (std::size_t i = 0; i < n_; ++i) {
    const ParamsView<R> params = worlds_(i).params;
    for (std::size_t k = 0; k < 3; ++k) params.gravity[k] = gravity[3 * i + k];
  }
}

template <Real R>
void NamedParameters<R>::set_mass(std::string_view name, std::span<const R> mass) const {
  const FloatEnvironment floats;
  const LinkId link = model_.link_id(name);
  require_rows("mass", mass, n_, 1);
  for (const R value : mass) require_link_mass(model_, link, static_cast<double>(value));
  for (std::size_t i = 0; i < n_; ++i) {
    const WorldView<R> world = worlds_(i);
    set_link_mass(model_, link, static_cast<double>(mass[i]), world.extras.link_mass, world.params);
  }
}

template <Real R>
void NamedParameters<R>::set_friction(std::string_view name, std::span<const R> values) const {
  set_geoms(name, "friction", &ParamsView<R>::geom_friction, values);
  set_geoms(name, "friction", &ParamsView<R>::geom_friction_y, values);
}

template <Real R>
void NamedParameters<R>::set_spinning_friction(std::string_view name, std::span<const R> values) const {
  set_geoms(name, "spinning friction", &ParamsView<R>::geom_spinning, values);
  let_resist_turning();
}

template <Real R>
void NamedParameters<R>::set_rolling_friction(std::string_view name, std::span<const R> values) const {
  set_geoms(name, "rolling friction", &ParamsView<R>::geom_rolling, values);
  let_resist_turning();
}

template <Real R>
void NamedParameters<R>::set_restitution(std::string_view name, std::span<const R> values) const {
  for (const R value : values) check_restitution("'" + std::string(name) + "'", static_cast<double>(value));
  set_geoms(name, "restitution", &ParamsView<R>::geom_restitution, values);
}

template <Real R>
void NamedParameters<R>::set_damping(std::string_view joint, std::span<const R> values) const {
  set_dofs(joint, "damping", &ParamsView<R>::damping, values);
}

template <Real R>
void NamedParameters<R>::set_stiffness(std::string_view joint, std::span<const R> values) const {
  set_dofs(joint, "stiffness", &ParamsView<R>::stiffness, values);
}

template <Real R>
void NamedParameters<R>::set_joint_friction(std::string_view joint, std::span<const R> values) const {
  set_dofs(joint, "friction", &ParamsView<R>::friction, values);
}

template <Real R>
void NamedParameters<R>::set_armature(std::string_view joint, std::span<const R> values) const {
  set_dofs(joint, "armature", &ParamsView<R>::armature, values);
}

template <Real R>
void NamedParameters<R>::set_geom_size(std::string_view name, std::span<const R> size) const {
  const GeomId id = geom_id(model_, name);
  require_rows("size", size, n_, 3);
  Shape shape = model_.geoms()[id.index()].shape;
  for (std::size_t i = 0; i < n_; ++i) {
    const std::span<const R> row = size.subspan(3 * i, 3);
    shape.size = {static_cast<double>(row[0]), static_cast<double>(row[1]), static_cast<double>(row[2])};
    require_sized(geom_label(model_, id), shape);
  }
  for (std::size_t i = 0; i < n_; ++i) {
    const ParamsView<R> params = worlds_(i).params;
    for (std::size_t k = 0; k < 3; ++k) params.geom_size[3 * id.index() + k] = size[3 * i + k];
  }
}

template <Real R>
void NamedParameters<R>::set_gains(std::string_view name, std::span<const R> kp, std::span<const R> kd) const {
  const std::size_t k = actuator_id(model_, name).index();
  const Actuator& actuator = model_.actuators()[k];
  require_not_negative("kp of actuator '" + actuator.name + "'", kp);
  require_not_negative("kd of actuator '" + actuator.name + "'", kd);
  for (const R value : kp) require_gains(actuator, static_cast<double>(value));
  for (std::size_t i = 0; i < n_; ++i) {
    const ParamsView<R> params = worlds_(i).params;
    params.drive_kp[k] = kp[i];
    params.drive_kd[k] = kd[i];
  }
}

template class NamedParameters<double>;
template class NamedParameters<float>;

}  // namespace manyhands
