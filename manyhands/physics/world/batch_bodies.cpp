// Batch: bodies, contacts and parameters, by name.
#include <algorithm>

#include "manyhands/math/quaternion.h"
#include "manyhands/physics/world/batch.h"

namespace manyhands {

namespace {

void require_room(const char* name, std::span<const float> values, std::size_t size) {
  if (values.size() == size) return;
  throw std::invalid_argument(std::string(name) + " has room for " + std::to_string(values.size()) +
                              " numbers; expected " + std::to_string(size));
}

Vec3<float> vec3(const float* a) { return {a[0], a[1], a[2]}; }

/// R and p of a row of frame_motion.
Transform<float> pose_of(const float* row) { return {{vec3(row), vec3(row + 3), vec3(row + 6)}, vec3(row + 9)}; }

}  // namespace

void Batch::body_pose(std::string_view name, std::span<float> position, std::span<float> quaternion) {
  const Frame& frame = model_->frame(model_->frame_id(name));
  require_room("position", position, 3 * steps_.size());
  require_room("quaternion", quaternion, 4 * steps_.size());
  lanes_->frame_motion(frame.body, broadcast<float>(frame.X_BF), pool_, pose_, velocity_);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const Transform<float> X = pose_of(&pose_[12 * i]);
    const Quat<float> r = to_quat(X.R);
    std::ranges::copy(std::array{X.p.x, X.p.y, X.p.z}, &position[3 * i]);
    std::ranges::copy(std::array{r.x, r.y, r.z, r.w}, &quaternion[4 * i]);
  }
}

void Batch::body_velocity(std::string_view name, std::span<float> omega, std::span<float> velocity) {
  const Frame& frame = model_->frame(model_->frame_id(name));
  require_room("omega", omega, 3 * steps_.size());
  require_room("velocity", velocity, 3 * steps_.size());
  lanes_->frame_motion(frame.body, broadcast<float>(frame.X_BF), pool_, pose_, velocity_);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    std::copy_n(&velocity_[6 * i], 3, &omega[3 * i]);
    std::copy_n(&velocity_[6 * i + 3], 3, &velocity[3 * i]);
  }
}

void Batch::apply_force(std::string_view name, std::span<const float> force, std::span<const float> torque,
                        std::span<const float> point) {
  const LinkId id = model_->link_id(name);
  const Link& link = model_->link(id);
  require_rows("force", force, 3);
  if (!torque.empty()) require_rows("torque", torque, 3);
  if (!point.empty()) require_rows("point", point, 3);
  const Vec3<float> com = broadcast<float>(link.inertial.com);
  lanes_->frame_motion(link.body, broadcast<float>(link.X_BL), pool_, pose_, velocity_);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const Transform<float> X = pose_of(&pose_[12 * i]);
    const Vec3<float> arm = point.empty() ? X.R * com : vec3(&point[3 * i]) - X.p;
    const Vec3<float> f = vec3(&force[3 * i]);
    const Vec3<float> n = torque.empty() ? cross(arm, f) : vec3(&torque[3 * i]) + cross(arm, f);
    const BatchExtras extras = lanes_->extras(i);
    const std::array<float, 6> numbers{n.x, n.y, n.z, f.x, f.y, f.z};
    for (std::size_t k = 0; k < 6; ++k) extras.external[6 * id.index() + k] += numbers[k];
    extras.pushed = 1;
  }
}

std::vector<std::int32_t> Batch::contact_count() const {
  std::vector<std::int32_t> result;
  result.reserve(steps_.size());
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    result.push_back(static_cast<std::int32_t>(lanes_->extras(i).contacts));
  }
  return result;
}

std::vector<float> Batch::max_penetration() const {
  std::vector<float> result;
  result.reserve(steps_.size());
  for (std::size_t i = 0; i < steps_.size(); ++i) result.push_back(lanes_->extras(i).penetration);
  return result;
}

void Batch::contact_wrench(std::string_view name, std::span<float> normal, std::span<float> friction) const {
  const std::size_t link = model_->link_id(name).index();
  require_room("normal", normal, 6 * steps_.size());
  require_room("friction", friction, 6 * steps_.size());
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const Strided<float> wrench = lanes_->extras(i).wrench;
    for (std::size_t k = 0; k < 6; ++k) {
      normal[6 * i + k] = wrench[12 * link + k];
      friction[6 * i + k] = wrench[12 * link + 6 + k];
    }
  }
}

// ---- parameters ----------------------------------------------------------------------------------------------------

void Batch::require_least(const std::string& name, std::span<const float> values) const {
  require_rows(name, values, 1);
  for (std::size_t i = 0; i < values.size(); ++i) {
    require_at_least(name + " in world " + std::to_string(i), 0, static_cast<double>(values[i]));
  }
}

void Batch::set_geoms(std::string_view name, const std::string& what, Strided<float> ParamsView<float>::* field,
                      std::span<const float> value) {
  require_least(what + " of '" + std::string(name) + "'", value);
  const std::vector<GeomId> geoms = geoms_named(*model_, name);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const ParamsView<float> params = lanes_->params(i);
    for (const GeomId id : geoms) (params.*field)[id.index()] = value[i];
  }
}

void Batch::set_dofs(std::string_view name, const std::string& what, Strided<float> ParamsView<float>::* field,
                     std::span<const float> value) {
  require_least(what + " of joint '" + std::string(name) + "'", value);
  const Joint& joint = model_->joint(model_->joint_id(name));
  if (joint.iv < 0) throw std::invalid_argument("joint '" + joint.name + "' is fixed: it has no such parameter");
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const ParamsView<float> params = lanes_->params(i);
    for (int k = 0; k < velocity_size(joint.type); ++k) {
      (params.*field)[static_cast<std::size_t>(joint.iv + k)] = value[i];
    }
  }
}

void Batch::set_gravity(std::span<const float> gravity) {
  require_rows("gravity", gravity, 3);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const ParamsView<float> params = lanes_->params(i);
    for (std::size_t k = 0; k < 3; ++k) params.gravity[k] = gravity[3 * i + k];
  }
}

void Batch::set_mass(std::string_view name, std::span<const float> mass) {
  const LinkId link = model_->link_id(name);
  require_rows("mass", mass, 1);
  for (const float value : mass) require_link_mass(*model_, link, static_cast<double>(value));
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    set_link_mass(*model_, link, static_cast<double>(mass[i]), lanes_->extras(i).link_mass, lanes_->params(i));
  }
}

void Batch::set_friction(std::string_view name, std::span<const float> value) {
  set_geoms(name, "friction", &ParamsView<float>::geom_friction, value);
  set_geoms(name, "friction", &ParamsView<float>::geom_friction_y, value);
}

void Batch::set_spinning_friction(std::string_view name, std::span<const float> value) {
  set_geoms(name, "spinning friction", &ParamsView<float>::geom_spinning, value);
  for (std::size_t i = 0; i < steps_.size(); ++i) let_resist_turning(lanes_->params(i), lanes_->colliders());
}

void Batch::set_rolling_friction(std::string_view name, std::span<const float> value) {
  set_geoms(name, "rolling friction", &ParamsView<float>::geom_rolling, value);
  for (std::size_t i = 0; i < steps_.size(); ++i) let_resist_turning(lanes_->params(i), lanes_->colliders());
}

void Batch::set_restitution(std::string_view name, std::span<const float> value) {
  set_geoms(name, "restitution", &ParamsView<float>::geom_restitution, value);
}

void Batch::set_damping(std::string_view joint, std::span<const float> value) {
  set_dofs(joint, "damping", &ParamsView<float>::damping, value);
}

void Batch::set_joint_friction(std::string_view joint, std::span<const float> value) {
  set_dofs(joint, "friction", &ParamsView<float>::friction, value);
}

void Batch::set_armature(std::string_view joint, std::span<const float> value) {
  set_dofs(joint, "armature", &ParamsView<float>::armature, value);
}

void Batch::set_geom_size(std::string_view name, std::span<const float> size) {
  const GeomId id = geom_id(*model_, name);
  require_rows("size", size, 3);
  Shape shape = model_->geoms()[id.index()].shape;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    shape.size = broadcast<double>(vec3(&size[3 * i]));
    require_sized(geom_label(*model_, id), shape);
  }
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const ParamsView<float> params = lanes_->params(i);
    for (std::size_t k = 0; k < 3; ++k) params.geom_size[3 * id.index() + k] = size[3 * i + k];
  }
}

void Batch::set_gains(std::string_view name, std::span<const float> kp, std::span<const float> kd) {
  const std::size_t k = actuator_id(*model_, name).index();
  require_least("kp", kp);
  require_least("kd", kd);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    require_gains(model_->actuators()[k], static_cast<double>(kp[i]));
    const ParamsView<float> params = lanes_->params(i);
    params.drive_kp[k] = kp[i];
    params.drive_kd[k] = kd[i];
  }
}

}  // namespace manyhands
