// World: its own parameters, by name.
#include "manyhands/physics/world/world_impl.h"

namespace manyhands {

namespace {

NamedParameters<double> parameters(WorldCore& core) {
  return {*core.model, core.system.colliders, 1, [&core](std::size_t) { return core.view(0); }};
}

std::span<const double> one(const double& value) { return {&value, 1}; }

/// Of the first of those that the name stands for.
double surface(const Field<double>& field, const Model& model, std::string_view name) {
  return field[geoms_named(model, name).front().index()];
}

}  // namespace

Vec3<double> World::gravity() const { return loose().params.gravity[0]; }

void World::set_gravity(const Vec3<double>& gravity) {
  parameters(loose()).set_gravity(std::array{gravity.x, gravity.y, gravity.z});
}

double World::mass(std::string_view link) const {
  const WorldCore& now = loose();
  return now.extras.link_mass[now.model->link_id(link).index()];
}

void World::set_mass(std::string_view link, double mass) { parameters(loose()).set_mass(link, one(mass)); }

double World::friction(std::string_view name) const {
  return surface(loose().params.geom_friction, *loose().model, name);
}

void World::set_friction(std::string_view name, double friction) {
  parameters(loose()).set_friction(name, one(friction));
}

void World::set_spinning_friction(std::string_view name, double spinning) {
  parameters(loose()).set_spinning_friction(name, one(spinning));
}

void World::set_rolling_friction(std::string_view name, double rolling) {
  parameters(loose()).set_rolling_friction(name, one(rolling));
}

double World::restitution(std::string_view name) const {
  return surface(loose().params.geom_restitution, *loose().model, name);
}

void World::set_restitution(std::string_view name, double restitution) {
  parameters(loose()).set_restitution(name, one(restitution));
}

double World::damping(std::string_view joint) const {
  return loose().params.damping[static_cast<std::size_t>(moving_joint(*loose().model, joint).iv)];
}

void World::set_damping(std::string_view joint, double damping) {
  parameters(loose()).set_damping(joint, one(damping));
}

double World::stiffness(std::string_view joint) const {
  return loose().params.stiffness[static_cast<std::size_t>(moving_joint(*loose().model, joint).iv)];
}

void World::set_stiffness(std::string_view joint, double stiffness) {
  parameters(loose()).set_stiffness(joint, one(stiffness));
}

void World::set_joint_friction(std::string_view joint, double friction) {
  parameters(loose()).set_joint_friction(joint, one(friction));
}

void World::set_armature(std::string_view joint, double armature) {
  parameters(loose()).set_armature(joint, one(armature));
}

Vec3<double> World::geom_size(std::string_view geom) const {
  return loose().params.geom_size[geom_id(*loose().model, geom).index()];
}

void World::set_geom_size(std::string_view geom, const Vec3<double>& size) {
  parameters(loose()).set_geom_size(geom, std::array{size.x, size.y, size.z});
  loose().moved();
}

std::pair<double, double> World::gains(std::string_view actuator) const {
  const std::size_t k = actuator_id(*loose().model, actuator).index();
  return {loose().params.drive_kp[k], loose().params.drive_kd[k]};
}

void World::set_gains(std::string_view actuator, double kp, double kd) {
  parameters(loose()).set_gains(actuator, one(kp), one(kd));
}

}  // namespace manyhands
