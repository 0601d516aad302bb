// Batch: bodies, contacts and parameters, by name.
#include <algorithm>

#include "manyhands/base/float_environment.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/physics/world/batch_impl.h"

namespace manyhands {

using internal::require_rows;

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
  const Frame& frame = impl_->model->frame(impl_->model->frame_id(name));
  require_room("position", position, 3 * impl_->steps.size());
  require_room("quaternion", quaternion, 4 * impl_->steps.size());
  impl_->lanes->frame_motion(frame.body, broadcast<float>(frame.X_BF), impl_->pool, impl_->pose, impl_->velocity);
  for (std::size_t i = 0; i < impl_->steps.size(); ++i) {
    const Transform<float> X = pose_of(&impl_->pose[12 * i]);
    const Quat<float> r = to_quat(X.R);
    std::ranges::copy(std::array{X.p.x, X.p.y, X.p.z}, &position[3 * i]);
    std::ranges::copy(std::array{r.x, r.y, r.z, r.w}, &quaternion[4 * i]);
  }
}

void Batch::body_velocity(std::string_view name, std::span<float> omega, std::span<float> velocity) {
  const Frame& frame = impl_->model->frame(impl_->model->frame_id(name));
  require_room("omega", omega, 3 * impl_->steps.size());
  require_room("velocity", velocity, 3 * impl_->steps.size());
  impl_->lanes->frame_motion(frame.body, broadcast<float>(frame.X_BF), impl_->pool, impl_->pose, impl_->velocity);
  for (std::size_t i = 0; i < impl_->steps.size(); ++i) {
    std::copy_n(&impl_->velocity[6 * i], 3, &omega[3 * i]);
    std::copy_n(&impl_->velocity[6 * i + 3], 3, &velocity[3 * i]);
  }
}

void Batch::set_mocap(std::string_view name, std::span<const float> position, std::span<const float> quaternion,
                      std::span<const std::uint8_t> mask) {
  const FloatEnvironment floats;
  impl_->require_mask(mask);
  const std::size_t n = impl_->steps.size(), first = kPoseNumbers * impl_->model->mocap_index(name);
  require_rows("position", position, n, 3);
  require_rows("quaternion", quaternion, n, 4);
  for (std::size_t i = 0; i < n; ++i) {
    (void)internal::require_unit_quaternion<float>(quaternion, 4 * i, "quaternion[");
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!chosen(mask, i)) continue;
    const Quat<float> r =
        normalized(Quat<float>{quaternion[4 * i], quaternion[4 * i + 1], quaternion[4 * i + 2], quaternion[4 * i + 3]});
    const Strided<float> pose = impl_->world(i).state.mocap;
    const std::array<float, kPoseNumbers> numbers{
        position[3 * i], position[3 * i + 1], position[3 * i + 2], r.x, r.y, r.z, r.w};
    for (std::size_t k = 0; k < kPoseNumbers; ++k) pose[first + k] = numbers[k];
  }
}

void Batch::apply_force(std::string_view name, std::span<const float> force, std::span<const float> torque,
                        std::span<const float> point) {
  const FloatEnvironment floats;
  const LinkId id = impl_->model->link_id(name);
  const Link& link = impl_->model->link(id);
  require_rows("force", force, impl_->steps.size(), 3);
  if (!torque.empty()) require_rows("torque", torque, impl_->steps.size(), 3);
  if (!point.empty()) require_rows("point", point, impl_->steps.size(), 3);
  const Vec3<float> com = broadcast<float>(link.inertial.com);
  impl_->lanes->frame_motion(link.body, broadcast<float>(link.X_BL), impl_->pool, impl_->pose, impl_->velocity);
  for (std::size_t i = 0; i < impl_->steps.size(); ++i) {
    const Transform<float> X = pose_of(&impl_->pose[12 * i]);
    const Vec3<float> arm = point.empty() ? X.R * com : vec3(&point[3 * i]) - X.p;
    const Vec3<float> f = vec3(&force[3 * i]);
    const Vec3<float> n = torque.empty() ? cross(arm, f) : vec3(&torque[3 * i]) + cross(arm, f);
    const ExtrasView<float> extras = impl_->world(i).extras;
    const std::array<float, 6> numbers{n.x, n.y, n.z, f.x, f.y, f.z};
    for (std::size_t k = 0; k < 6; ++k) extras.external[6 * id.index() + k] += numbers[k];
    extras.pushed[0] = 1;
  }
}

std::vector<std::int32_t> Batch::contact_count() const {
  std::vector<std::int32_t> result;
  result.reserve(impl_->steps.size());
  for (std::size_t i = 0; i < impl_->steps.size(); ++i) {
    result.push_back(static_cast<std::int32_t>(impl_->world(i).extras.touching[0]));
  }
  return result;
}

std::vector<float> Batch::max_penetration() const {
  std::vector<float> result;
  result.reserve(impl_->steps.size());
  for (std::size_t i = 0; i < impl_->steps.size(); ++i) result.push_back(impl_->world(i).extras.penetration[0]);
  return result;
}

void Batch::contact_wrench(std::string_view name, std::span<float> normal, std::span<float> friction) const {
  const std::size_t link = impl_->model->link_id(name).index();
  require_room("normal", normal, 6 * impl_->steps.size());
  require_room("friction", friction, 6 * impl_->steps.size());
  for (std::size_t i = 0; i < impl_->steps.size(); ++i) {
    const Strided<float> wrench = impl_->world(i).extras.wrench;
    for (std::size_t k = 0; k < 6; ++k) {
      normal[6 * i + k] = wrench[12 * link + k];
      friction[6 * i + k] = wrench[12 * link + 6 + k];
    }
  }
}

// ---- parameters ----------------------------------------------------------------------------------------------------

void Batch::set_gravity(std::span<const float> gravity) { impl_->parameters().set_gravity(gravity); }

void Batch::set_mass(std::string_view link, std::span<const float> mass) { impl_->parameters().set_mass(link, mass); }

void Batch::set_friction(std::string_view name, std::span<const float> value) {
  impl_->parameters().set_friction(name, value);
}

void Batch::set_spinning_friction(std::string_view name, std::span<const float> value) {
  impl_->parameters().set_spinning_friction(name, value);
}

void Batch::set_rolling_friction(std::string_view name, std::span<const float> value) {
  impl_->parameters().set_rolling_friction(name, value);
}

void Batch::set_restitution(std::string_view name, std::span<const float> value) {
  impl_->parameters().set_restitution(name, value);
}

void Batch::set_damping(std::string_view joint, std::span<const float> value) {
  impl_->parameters().set_damping(joint, value);
}

void Batch::set_stiffness(std::string_view joint, std::span<const float> value) {
  impl_->parameters().set_stiffness(joint, value);
}

void Batch::set_joint_friction(std::string_view joint, std::span<const float> value) {
  impl_->parameters().set_joint_friction(joint, value);
}

void Batch::set_armature(std::string_view joint, std::span<const float> value) {
  impl_->parameters().set_armature(joint, value);
}

void Batch::set_geom_size(std::string_view geom, std::span<const float> size) {
  impl_->parameters().set_geom_size(geom, size);
}

void Batch::set_gains(std::string_view actuator, std::span<const float> kp, std::span<const float> kd) {
  impl_->parameters().set_gains(actuator, kp, kd);
}

}  // namespace manyhands
