// World: its parts by ids, for programs that ask often.
#include <algorithm>
#include <array>

#include "manyhands/base/float_environment.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/model/model_edit.h"
#include "manyhands/model/part_checks.h"
#include "manyhands/physics/dynamics/checks.h"
#include "manyhands/physics/world/world_impl.h"

namespace manyhands {

using internal::require_numbers;
using internal::require_pose;
using internal::require_vector;

namespace {

/// Messages are made only where a check fails: these calls are frequent.
bool all_finite(std::span<const double> numbers) {
  return internal::all_finite(numbers.data(), static_cast<int>(numbers.size()));
}

}  // namespace

const Model& World::parts() const { return *loose().model; }

const Link& World::required_link(const WorldCore& core, LinkId link) {
  const std::span<const Link> links = core.model->links();
  if (link.is_valid() && link.index() < links.size()) return links[link.index()];
  throw std::out_of_range("there is no link " + std::to_string(link.value()) + "; the world has " +
                          std::to_string(links.size()) + " links, its own frame first");
}

const Body& World::required_body(const WorldCore& core, JointId joint) {
  const std::span<const Joint> joints = core.model->joints();
  if (!joint.is_valid() || joint.index() >= joints.size()) {
    throw std::out_of_range("there is no joint " + std::to_string(joint.value()) + "; the world has " +
                            std::to_string(joints.size()));
  }
  return core.model->body(core.model->link(joints[joint.index()].child).body);
}

Transform<double> World::link_pose(LinkId id) const {
  const WorldCore& now = loose();
  const Link& link = required_link(now, id);
  return frame_pose(link.body, link.X_BL, now.placed());
}

Motion<double> World::link_velocity(LinkId id) const {
  const WorldCore& now = loose();
  const Link& link = required_link(now, id);
  const Workspace<double>& ws = now.placed();
  const std::size_t b = link.body.index();
  return at_point(ws.V[b], ws.R_WB[b] * link.X_BL.p + ws.p_OB[b]);
}

void World::set_link_pose(LinkId id, const Transform<double>& X_WL) {
  const FloatEnvironment floats;
  WorldCore& now = loose();
  const Link& link = required_link(now, id);
  require_pose("link '" + link.name + "'", X_WL);
  if (id.value() != 0 && !link.joint.is_valid()) {
    now.place_root(id, X_WL);
    return;
  }
  if (now.model->body(link.body).type == JointType::kMocap) {
    const Quat<double> r = normalized(to_quat(X_WL.R));
    const std::array<double, kPoseNumbers> pose{X_WL.p.x, X_WL.p.y, X_WL.p.z, r.x, r.y, r.z, r.w};
    std::ranges::copy(pose, now.state.mocap() + kPoseNumbers * now.model->mocap_index(link.name));
    now.moved();
    return;
  }
  const Body& body = free_body(now, link, "pose");
  const Transform<double> X_FB = inverse(body.X_PF) * (X_WL * inverse(link.X_BL));
  const Quat<double> r = normalized(to_quat(X_FB.R));
  const std::array<double, 7> q{X_FB.p.x, X_FB.p.y, X_FB.p.z, r.x, r.y, r.z, r.w};
  std::copy(q.begin(), q.end(), now.state.q() + body.iq);
  now.moved();
}

void World::set_link_velocity(LinkId id, const Motion<double>& V_WL) {
  const FloatEnvironment floats;
  WorldCore& now = loose();
  const Link& link = required_link(now, id);
  require_vector("the angular velocity of link '" + link.name + "'", V_WL.w);
  require_vector("the velocity of link '" + link.name + "'", V_WL.v);
  const Body& body = free_body(now, link, "velocity");
  const Vec3<double> p_LB = -(now.placed().R_WB[link.body.index()] * link.X_BL.p);
  const Vec3<double> w = transpose_times(body.X_PF.R, V_WL.w);
  const Vec3<double> v = transpose_times(body.X_PF.R, V_WL.v + cross(V_WL.w, p_LB));
  const std::array<double, 6> numbers{w.x, w.y, w.z, v.x, v.y, v.z};
  std::copy(numbers.begin(), numbers.end(), now.state.v() + body.iv);
  now.moved();
}

void World::apply_link_force(LinkId id, const Vec3<double>& force, const Vec3<double>& torque,
                             const Vec3<double>& point) {
  const FloatEnvironment floats;
  WorldCore& now = loose();
  const std::string& name = required_link(now, id).name;
  const Force<double> about_origin{torque + cross(point, force), force};
  const Vec3<double>& moment = about_origin.n;
  if (!all_finite(std::array{moment.x, moment.y, moment.z, force.x, force.y, force.z})) {
    require_vector("the force on '" + name + "'", force);
    require_vector("the torque on '" + name + "'", torque);
    require_vector("the point of the force on '" + name + "'", point);
  }
  Force<double>& sum = now.extras.external[id.index()];
  sum = sum + about_origin;
  now.extras.pushed[0] = 1;
}

// ---- joints -------------------------------------------------------------------------------------------------------

std::span<const double> World::joint_q(JointId joint) const {
  const WorldCore& now = loose();
  const Body& body = required_body(now, joint);
  if (body.joint != joint) return {};
  return {now.state.q() + body.iq, static_cast<std::size_t>(body.nq)};
}

std::span<const double> World::joint_v(JointId joint) const {
  const WorldCore& now = loose();
  const Body& body = required_body(now, joint);
  if (body.joint != joint) return {};
  return {now.state.v() + body.iv, static_cast<std::size_t>(body.nv)};
}

void World::set_joint(JointId joint, std::span<const double> q, std::span<const double> v) {
  WorldCore& now = loose();
  const Body& body = required_body(now, joint);
  const std::size_t nq = joint_q(joint).size(), nv = joint_v(joint).size();
  if (q.size() != nq || v.size() != nv || !all_finite(q) || !all_finite(v)) {
    const std::string& name = now.model->joint(joint).name;
    require_numbers("the position of joint '" + name + "'", q, nq);
    require_numbers("the velocity of joint '" + name + "'", v, nv);
  }
  std::ranges::copy(q, now.state.q() + body.iq);
  std::ranges::copy(v, now.state.v() + body.iv);
  now.moved();
}

void World::set_joint_tau(JointId joint, std::span<const double> tau) {
  WorldCore& now = loose();
  const std::size_t nv = joint_v(joint).size();
  if (tau.size() != nv || !all_finite(tau)) {
    require_numbers("the force of joint '" + now.model->joint(joint).name + "'", tau, nv);
  }
  std::ranges::copy(tau, now.state.tau() + required_body(now, joint).iv);
}

void World::set_joint_motor(JointId joint, const JointMotor& motor) {
  std::array<JointMotor, 6> motors{};
  motors.fill(motor);
  set_joint_motors(joint, std::span(motors).first(joint_v(joint).size()));
}

void World::set_joint_motors(JointId joint, std::span<const JointMotor> motors) {
  WorldCore& now = loose();
  const Body& body = required_body(now, joint);
  const std::string_view name = now.model->joint(joint).name;
  if (motors.size() != joint_v(joint).size()) {
    throw std::invalid_argument("joint '" + std::string(name) + "' has " + std::to_string(joint_v(joint).size()) +
                                " dofs; expected a motor for each, not " + std::to_string(motors.size()));
  }
  for (const JointMotor& motor : motors) {
    const std::array<double, 5> numbers{motor.target_q, motor.target_v, motor.kp, motor.kd, motor.max_force};
    if (!all_finite(numbers) || motor.kp < 0 || motor.kd < 0 || motor.max_force < 0) {
      const std::string what = "the motor of joint '" + std::string(name) + "'";
      require_numbers<double>(what, numbers, 5);
      internal::require_not_negative<double>("the gains and force of " + what, std::span(numbers).subspan(2));
    }
  }
  for (std::size_t k = 0; k < motors.size(); ++k) {
    const std::size_t i = static_cast<std::size_t>(body.iv) + k;
    now.state.target_q()[i] = motors[k].target_q;
    now.state.target_v()[i] = motors[k].target_v;
    now.params.motor_kp[i] = motors[k].kp;
    now.params.motor_kd[i] = motors[k].kd;
    now.params.motor_max_force[i] = motors[k].max_force;
  }
}

std::vector<double> World::joint_forces(JointId joint) const {
  const WorldCore& now = loose();
  const Body& body = required_body(now, joint);
  std::vector<double> forces;
  for (int k = 0; body.joint == joint && k < body.nv; ++k) {
    forces.push_back(now.has_stepped ? now.state.joint_impulse()[body.iv + k] / time_step_ : 0.0);
  }
  return forces;
}

void World::set_joint_damping(JointId joint, double damping) {
  WorldCore& now = loose();
  const Body& body = required_body(now, joint);
  require_at_least("the damping of joint '" + now.model->joint(joint).name + "'", 0, damping);
  for (int k = 0; body.joint == joint && k < body.nv; ++k) {
    now.params.damping[static_cast<std::size_t>(body.iv + k)] = damping;
  }
}

void World::set_joint_limits(JointId joint, double lower, double upper) {
  WorldCore& now = loose();
  const Body& body = required_body(now, joint);
  const std::string& name = now.model->joint(joint).name;
  if (!(lower <= upper)) {
    throw std::invalid_argument("the limits of joint '" + name + "' are " + std::to_string(lower) + " and " +
                                std::to_string(upper) + "; expected the lower one first");
  }
  if (body.joint != joint || !now.system.tree.dof_limited[static_cast<std::size_t>(body.iv)]) {
    throw std::invalid_argument("joint '" + name + "' was made without limits and cannot get any");
  }
  now.params.lower[static_cast<std::size_t>(body.iv)] = lower;
  now.params.upper[static_cast<std::size_t>(body.iv)] = upper;
}

// ---- links --------------------------------------------------------------------------------------------------------

void World::set_link_inertial(LinkId id, const Inertial& inertial) {
  const FloatEnvironment floats;
  WorldCore& now = loose();
  const Link& link = required_link(now, id);
  require_at_least("the mass of link '" + link.name + "'", 1e-12, inertial.mass);
  require_vector("the centre of mass of link '" + link.name + "'", inertial.com);
  require_numbers<double>("the inertia of link '" + link.name + "'", std::span(&inertial.inertia.xx, 6), 6);
  now.set_inertial(id, inertial);
}

void World::set_link_surface(LinkId id, const SurfaceMaterial& surface) {
  WorldCore& now = loose();
  const std::string what = "link '" + required_link(now, id).name + "'";
  require_at_least(what + ": friction", 0, surface.lateral_friction);
  require_at_least(what + ": spinning friction", 0, surface.spinning_friction);
  require_at_least(what + ": rolling friction", 0, surface.rolling_friction);
  check_restitution(what, surface.restitution);
  for (const GeomId geom : now.model->geoms_of(id)) {
    const std::size_t i = geom.index();
    now.params.geom_friction[i] = surface.lateral_friction;
    now.params.geom_friction_y[i] = surface.lateral_friction;
    now.params.geom_spinning[i] = surface.spinning_friction;
    now.params.geom_rolling[i] = surface.rolling_friction;
    now.params.geom_restitution[i] = surface.restitution;
  }
  let_resist_turning(now.view(0).params, now.system.colliders);
}

std::optional<LinkDistance> World::link_distance(LinkId a, LinkId b) const {
  const WorldCore& now = loose();
  (void)required_link(now, a);
  (void)required_link(now, b);
  if (a == b) return std::nullopt;
  return manyhands::link_distance(*now.model, {now.system.colliders, now.params, now.placed_geoms()}, a, b);
}

void World::set_link_collision(LinkId a, LinkId b, bool enabled) {
  WorldCore& now = loose();
  (void)required_link(now, a);
  (void)required_link(now, b);
  if (a != b) now.set_excluded(a, b, !enabled);
}

// ---- equality constraints -----------------------------------------------------------------------------------------

namespace {

std::size_t equality_index(const Model& model, std::string_view name) {
  const auto found = std::ranges::find(model.equalities(), name, &EqualityConstraint::name);
  if (found != model.equalities().end()) return static_cast<std::size_t>(found - model.equalities().begin());
  throw std::out_of_range("there is no equality constraint '" + std::string(name) + "'");
}

}  // namespace

void World::add_equality(const EqualityConstraint& equality) {
  const FloatEnvironment floats;
  ModelBuilder check = builder_of(*core().model);
  check.add_equality(equality);
  core().add_equality(equality);
  rebuild();
}

void World::set_equality(const EqualityConstraint& equality) {
  WorldCore& now = core();
  now.set_equality(equality_index(*now.model, equality.name), equality);
}

void World::aim_equality(const EqualityConstraint& equality) {
  WorldCore& now = core();
  now.aim_equality(equality_index(*now.model, equality.name), equality);
}

void World::remove_equality(std::string_view name) {
  const FloatEnvironment floats;
  WorldCore& now = core();
  now.remove_equality(equality_index(*now.model, name));
  rebuild();
}

}  // namespace manyhands
