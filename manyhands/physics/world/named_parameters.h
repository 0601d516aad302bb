// The parameters of worlds by the names of the parts that they belong to: for World and Batch alike.
#pragma once

#include <functional>

#include "manyhands/physics/world/parameters.h"
#include "manyhands/physics/world/world_block.h"

namespace manyhands {

/// Sets parameters of n worlds of one model: values (n), or (n, 3), one for each world. Throws std::invalid_argument on
/// a wrong length or a number that cannot be, before anything changes; std::out_of_range on a name that is not there.
template <Real R>
class NamedParameters {
 public:
  using Worlds = std::function<WorldView<R>(std::size_t)>;
  /// `worlds(i)` gives the numbers of world i of n; what is given outlives this.
  NamedParameters(const Model& model, Colliders<R>& colliders, std::size_t n, Worlds worlds)
      : model_(model), colliders_(colliders), n_(n), worlds_(std::move(worlds)) {}

  void set_gravity(std::span<const R> gravity) const;                         ///< (n, 3) [m/s^2]
  void set_mass(std::string_view link, std::span<const R> mass) const;        ///< [kg]; scales the inertia with it
  void set_friction(std::string_view name, std::span<const R> values) const;  ///< of a geom, or of a link's geoms
  void set_spinning_friction(std::string_view name, std::span<const R> values) const;  ///< [m]
  void set_rolling_friction(std::string_view name, std::span<const R> values) const;   ///< [m]
  void set_restitution(std::string_view name, std::span<const R> values) const;
  void set_damping(std::string_view joint, std::span<const R> values) const;         ///< [N m s/rad or N s/m]
  void set_stiffness(std::string_view joint, std::span<const R> values) const;       ///< [N m/rad or N/m]
  void set_joint_friction(std::string_view joint, std::span<const R> values) const;  ///< dry [N m or N]
  void set_armature(std::string_view joint, std::span<const R> values) const;        ///< [kg m^2 or kg]
  void set_geom_size(std::string_view geom, std::span<const R> size) const;          ///< (n, 3), see Shape [m]
  void set_gains(std::string_view actuator, std::span<const R> kp, std::span<const R> kd) const;

 private:
  using Field = Strided<R> ParamsView<R>::*;
  void require_not_negative(const std::string& what, std::span<const R> values) const;
  void set_geoms(std::string_view name, const std::string& what, Field field, std::span<const R> values) const;
  void set_dofs(std::string_view joint, const std::string& what, Field field, std::span<const R> values) const;
  void let_resist_turning() const;

  const Model& model_;
  Colliders<R>& colliders_;
  std::size_t n_;
  Worlds worlds_;
};

}  // namespace manyhands
