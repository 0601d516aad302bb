// World: its own parameters, by name.
#include "manyhands/physics/world/world.h"
#include "manyhands/physics/world/world_checks.h"

namespace manyhands {

namespace {

using Field = std::vector<double> Params<double>::*;

void set_surface(WorldCore& core, std::string_view name, const std::string& what, Field field, double value) {
  require_at_least(what + " of '" + std::string(name) + "'", 0, value);
  for (const GeomId id : geoms_named(*core.model, name)) (core.params.*field)[id.index()] = value;
}

double surface(const WorldCore& core, std::string_view name, Field field) {
  return (core.params.*field)[geoms_named(*core.model, name).front().index()];
}

/// The joint's first dof. Throws std::invalid_argument for fixed joints.
const Joint& moving_joint(const WorldCore& core, std::string_view name) {
  const Joint& joint = core.model->joint(core.model->joint_id(name));
  if (joint.iv < 0) throw std::invalid_argument("joint '" + joint.name + "' is fixed: it has no such parameter");
  return joint;
}

void set_joint(WorldCore& core, std::string_view name, const std::string& what, Field field, double value) {
  require_at_least(what + " of joint '" + std::string(name) + "'", 0, value);
  const Joint& joint = moving_joint(core, name);
  for (int k = 0; k < velocity_size(joint.type); ++k) {
    (core.params.*field)[static_cast<std::size_t>(joint.iv + k)] = value;
  }
}

}  // namespace

void World::set_gravity(const Vec3<double>& gravity) {
  internal::require_vector("gravity", gravity);
  core().params.gravity = gravity;
}

double World::mass(std::string_view link) const {
  const WorldCore& now = core();
  return now.link_mass[now.model->link_id(link).index()];
}

void World::set_mass(std::string_view link, double mass) {
  WorldCore& now = core();
  set_link_mass(*now.model, now.model->link_id(link), mass, lane_of<double>(now.link_mass, 0, 1), view(now.params, 0));
}

double World::friction(std::string_view name) const { return surface(core(), name, &Params<double>::geom_friction); }

void World::set_friction(std::string_view name, double friction) {
  set_surface(core(), name, "friction", &Params<double>::geom_friction, friction);
  set_surface(core(), name, "friction", &Params<double>::geom_friction_y, friction);
}

void World::set_spinning_friction(std::string_view name, double spinning) {
  set_surface(core(), name, "spinning friction", &Params<double>::geom_spinning, spinning);
  let_resist_turning(view(core().params, 0), core().system.colliders);
}

void World::set_rolling_friction(std::string_view name, double rolling) {
  set_surface(core(), name, "rolling friction", &Params<double>::geom_rolling, rolling);
  let_resist_turning(view(core().params, 0), core().system.colliders);
}

double World::restitution(std::string_view name) const {
  return surface(core(), name, &Params<double>::geom_restitution);
}

void World::set_restitution(std::string_view name, double restitution) {
  set_surface(core(), name, "restitution", &Params<double>::geom_restitution, restitution);
}

double World::damping(std::string_view joint) const {
  return core().params.damping[static_cast<std::size_t>(moving_joint(core(), joint).iv)];
}

void World::set_damping(std::string_view joint, double damping) {
  set_joint(core(), joint, "damping", &Params<double>::damping, damping);
}

void World::set_joint_friction(std::string_view joint, double friction) {
  set_joint(core(), joint, "friction", &Params<double>::friction, friction);
}

void World::set_armature(std::string_view joint, double armature) {
  set_joint(core(), joint, "armature", &Params<double>::armature, armature);
}

Vec3<double> World::geom_size(std::string_view geom) const {
  return core().params.geom_size[geom_id(*core().model, geom).index()];
}

void World::set_geom_size(std::string_view geom, const Vec3<double>& size) {
  WorldCore& now = core();
  const GeomId id = geom_id(*now.model, geom);
  Shape shape = now.model->geoms()[id.index()].shape;
  shape.size = size;
  require_sized(geom_label(*now.model, id), shape);
  now.params.geom_size[id.index()] = size;
}

std::pair<double, double> World::gains(std::string_view actuator) const {
  const std::size_t k = actuator_id(*core().model, actuator).index();
  return {core().params.drive_kp[k], core().params.drive_kd[k]};
}

void World::set_gains(std::string_view actuator, double kp, double kd) {
  WorldCore& now = core();
  const std::size_t k = actuator_id(*now.model, actuator).index();
  const Actuator& drive = now.model->actuators()[k];
  require_at_least("kp of actuator '" + drive.name + "'", 0, kp);
  require_at_least("kd of actuator '" + drive.name + "'", 0, kd);
  require_gains(drive, kp);
  now.params.drive_kp[k] = kp;
  now.params.drive_kd[k] = kd;
}

}  // namespace manyhands
