#include "manyhands/bullet/client.h"

#include <algorithm>
#include <cmath>

#include "manyhands/bullet/aim.h"
#include "manyhands/bullet/client_body.h"

namespace manyhands::bullet {

Client::Client() : world_(Settings{}.time_step) { reset(); }
Client::~Client() = default;

void Client::reset() {
  const int substeps = std::max(settings_.substeps, 1);
  world_ = World(settings_.time_step / substeps);
  world_.set_gravity({0, 0, 0});
  bodies_.clear();
  order_.clear();
  freed_.clear();
  next_id_ = 0;
  owners_.clear();
  edition_ = world_.edition();
  torqued_.clear();
  constraints_.clear();
  constraint_order_.clear();
  next_constraint_ = 1;
  contacts_.clear();
  contacts_known_ = true;
  pair_rules_.clear();
  collision_shapes_.clear();
  visual_shapes_.clear();
  textures_.clear();
  states_.clear();
  user_data_.clear();
  ++scene_;
  holds_ = false;
}

void Client::set_time_step(double time_step) {
  if (!(time_step > 0) || !is_finite(time_step)) {
    throw Error("setTimeStep: the time step is " + std::to_string(time_step) + " s; expected a number above 0");
  }
  settings_.time_step = time_step;
  world_.set_time_step(time_step / std::max(settings_.substeps, 1));
  for (const auto& [id, body] : bodies_) {
    for (int i = 0; i < body->plan.num_links(); ++i) {
      if (body->motor(i).is_default) write_motor(*body, i);
    }
  }
}

void Client::set_gravity(const Vec3<double>& gravity) { world_.set_gravity(gravity); }

void Client::step() {
  const int substeps = std::max(settings_.substeps, 1);
  const double h = settings_.time_step / substeps;
  if (world_.time_step() != h) set_time_step(settings_.time_step);
  for (int k = 0; k < substeps; ++k) {
    for (const int id : order_) {
      Body& body = *bodies_[id];
      apply_damping(body);
      if (body.has_clamps) apply_motors(body, h);
      if (body.is_capped) cap_speeds(body);
    }
    if (!constraints_.empty()) approach_constraints();
    if (screen_ != nullptr) follow_grips(h);
    world_.step();
  }
  for (const int id : order_) {
    if (bodies_[id]->is_capped) cap_speeds(*bodies_[id]);
  }
  clear_torques();
  contacts_known_ = false;
}

/// PyBullet's damping of motion through space: -m v (k + k |v|) on every link, and the same with its inertia for
/// rotations.
void Client::apply_damping(Body& body) {
  const double linear = body.linear_damping, angular = body.angular_damping;
  if (linear == 0 && angular == 0) return;
  for (int i = body.plan.fixed ? 0 : -1; i < body.plan.num_links(); ++i) {
    const LinkPlan& link = body.plan.link(i);
    if (!(link.mass > 0)) continue;
    const Motion<double> V = inertial_velocity(body, i);
    const double v = norm(V.v), w = norm(V.w);
    if (v == 0 && w == 0) continue;
    const Transform<double> X_WI = inertial_pose(body, i);
    const Vec3<double> spin = transpose_times(X_WI.R, V.w), I = link.inertia;
    const Vec3<double> L = X_WI.R * Vec3<double>{I.x * spin.x, I.y * spin.y, I.z * spin.z};
    world_.apply_link_force(link_id(body, i), (-link.mass * linear * (1 + v)) * V.v, (-angular * (1 + w)) * L, X_WI.p);
  }
}

/// Keeps each number of the velocities of base and joints at or below the body's largest.
void Client::cap_speeds(Body& body) {
  const double most = body.max_joint_velocity;
  const auto capped = [&](const Vec3<double>& v) {
    return Vec3<double>{std::clamp(v.x, -most, most), std::clamp(v.y, -most, most), std::clamp(v.z, -most, most)};
  };
  if (!body.plan.fixed) {
    const Motion<double> V = inertial_velocity(body, -1);
    if (norm(V.v - capped(V.v)) + norm(V.w - capped(V.w)) > 0) reset_base_velocity(body.id, capped(V.v), capped(V.w));
  }
  for (int i = 0; i < body.plan.num_links(); ++i) {
    const JointId joint = joint_id(body, i);
    const std::span<const double> q = world_.joint_q(joint), v = world_.joint_v(joint);
    if (std::ranges::all_of(v, [&](double x) { return std::abs(x) <= most; })) continue;
    std::vector<double> slower(v.begin(), v.end());
    for (double& x : slower) x = std::clamp(x, -most, most);
    world_.set_joint(joint, std::vector(q.begin(), q.end()), slower);
  }
}

/// Motors whose command depends on the state: of a largest velocity, of spherical joints, and PD.
void Client::apply_motors(Body& body, double h) {
  for (int i = 0; i < body.plan.num_links(); ++i) {
    MotorMemory& motor = body.motor(i);
    if (body.dof[static_cast<std::size_t>(i)] < 0) continue;
    const JointId joint = joint_id(body, i);
    if (motor.pd || motor.ball_pd) apply_pd(body, i, h);
    if (motor.ball) apply_ball_motor(body, i, h);
    const MotorSetting& s = motor.setting;
    if (s.mode != kPosition || !is_finite(motor.max_velocity)) continue;
    const double wanted = s.kp * (s.target_q - world_.joint_q(joint)[0]) / h + s.kd * s.target_v;
    const double most = motor.max_velocity;
    if (std::abs(wanted) <= most) {
      write_motor(body, i);
    } else {
      world_.set_joint_motor(joint, {.target_v = std::copysign(most, wanted), .kp = 0, .kd = 1, .max_force = s.force});
    }
  }
}

void Client::clear_torques() {
  for (const auto& [id, joint] : torqued_) {
    Body* const body = find(id);
    if (body == nullptr || !body->has_joint(joint)) continue;
    const JointId in_world = joint_id(*body, joint);
    const std::vector<double> zero(world_.joint_v(in_world).size(), 0.0);
    world_.set_joint_tau(in_world, zero);
    body->motor(joint).torque = 0;
    body->motor(joint).ball_torque = Vec3<double>::zero();
  }
  torqued_.clear();
}

}  // namespace manyhands::bullet
