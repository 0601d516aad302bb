// Client: what drives and pushes bodies.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "manyhands/bullet/aim.h"
#include "manyhands/bullet/client_body.h"
#include "manyhands/math/quaternion.h"

namespace manyhands::bullet {

void Client::write_motor(Body& body, int joint) {
  if (body.dof[static_cast<std::size_t>(joint)] < 0) return;
  constexpr double kDefaultImpulse = 1.0, kSphericalImpulse = 1000.0;  // [N s], per step
  const MotorMemory& motor = body.motor(joint);
  const bool round = body.plan.link(joint).joint == JointType::kSpherical;
  JointMotor command{.kp = 0, .kd = 1};
  if (motor.is_default) {
    command.max_force = (round ? kSphericalImpulse : kDefaultImpulse) / world_.time_step();
  } else {
    const MotorSetting& s = motor.setting;
    command = {.target_q = s.target_q,
               .target_v = s.target_v,
               .kp = s.mode == kPosition ? s.kp : 0,
               .kd = s.kd,
               .max_force = s.force};
  }
  world_.set_joint_motor(joint_id(body, joint), command);
}

void Client::set_motor(int id, int joint, const MotorSetting& setting) {
  Body* const body = find(id);
  require_joint(body, joint);
  set_motor(*body, joint, setting);
}

void Client::set_motors(int id, std::span<const int> joints, std::span<const MotorSetting> settings) {
  Body* const body = find(id);
  for (const int joint : joints) require_joint(body, joint);
  for (std::size_t i = 0; i < joints.size(); ++i) set_motor(*body, joints[i], settings[i]);
}

void Client::set_motor(Body& body, int joint, const MotorSetting& setting) {
  if (body.dof[static_cast<std::size_t>(joint)] < 0) return;
  MotorMemory& motor = body.motor(joint);
  const JointId in_world = joint_id(body, joint);
  if (setting.mode == kTorque) {
    motor.torque += setting.force;
    const std::vector<double> tau(world_.joint_v(in_world).size(), motor.torque);
    world_.set_joint_tau(in_world, tau);
    torqued_.push_back({body.id, joint});
    return;
  }
  if (setting.mode == kPd || setting.mode == kStablePd) {
    motor.pd = setting;
    if (setting.force == 0) stop_pd(body, joint);
    body.has_clamps = true;
    return;
  }
  motor.is_default = false;
  motor.setting = setting;
  if (setting.mode == kVelocity) motor.max_velocity = std::numeric_limits<double>::infinity();
  if (setting.max_velocity && *setting.max_velocity >= 0) motor.max_velocity = *setting.max_velocity;
  body.has_clamps = body.has_clamps || is_finite(motor.max_velocity);
  write_motor(body, joint);
}

void Client::stop_pd(Body& body, int joint) {
  body.motor(joint).pd.reset();
  body.motor(joint).ball_pd.reset();
  world_.set_joint_damping(joint_id(body, joint), body.plan.link(joint).damping);
}

bool Client::is_ball(int id, int joint) const {
  const Body* const body = find(id);
  require_joint(body, joint);
  return body->plan.links[static_cast<std::size_t>(joint)].joint == JointType::kSpherical;
}

void Client::set_ball_motor(int id, int joint, const BallSetting& setting) {
  Body& body = *find(id);
  MotorMemory& motor = body.motor(joint);
  if (setting.mode == kTorque) {
    motor.ball_torque = motor.ball_torque + setting.force;
    const std::array<double, 3> tau{motor.ball_torque.x, motor.ball_torque.y, motor.ball_torque.z};
    world_.set_joint_tau(joint_id(body, joint), tau);
    torqued_.push_back({body.id, joint});
    return;
  }
  body.has_clamps = true;
  if (setting.mode == kPd || setting.mode == kStablePd) {
    motor.ball_pd = setting;
    if (norm(setting.force) == 0) stop_pd(body, joint);
    return;
  }
  motor.is_default = false;
  motor.setting = {.mode = setting.mode, .force = norm(setting.force)};
  motor.ball = setting;
}

namespace {

/// The smallest rotation from the joint's position to a target, in the joint's frame; none without a target.
Vec3<double> error_of(const BallSetting& setting, std::span<const double> q) {
  if (!setting.target_q) return Vec3<double>::zero();
  return rotation_vector(*setting.target_q * Quat<double>{-q[0], -q[1], -q[2], q[3]});
}

}  // namespace

/// A spherical joint's motor drives each of its dofs as another motor drives its one, but is softer.
void Client::apply_ball_motor(Body& body, int joint, double h) {
  const BallSetting& s = *body.motor(joint).ball;
  const JointId in_world = joint_id(body, joint);
  const std::span<const double> q = world_.joint_q(in_world);
  const Vec3<double> angles = s.target_q ? aiming_angles({q[0], q[1], q[2], q[3]}, *s.target_q) : Vec3<double>::zero();
  constexpr double kShare = 0.2;  // of the angles that the gain counts by; in PyBullet all else counts for nothing
  const Mat3<double> R =
      to_matrix(Quat<double>{q[0], q[1], q[2], q[3]});  // of the link, whose axes the angles are along
  const Vec3<double> v = (-kShare * s.kp / h) * (R * angles);
  const std::array<JointMotor, 3> motors{JointMotor{.target_v = v.x, .kd = 1, .max_force = s.force.x},
                                         JointMotor{.target_v = v.y, .kd = 1, .max_force = s.force.x},
                                         JointMotor{.target_v = v.z, .kd = 1, .max_force = s.force.x}};
  world_.set_joint_motors(in_world, motors);
}

/// PD controllers. A stable one acts on the position and velocity at the end of the step: its gain is a damping of the
/// joint, which the step takes into account. Where its force would exceed its bounds, both gains are less.
void Client::apply_pd(Body& body, int joint, double h) {
  const MotorMemory& motor = body.motor(joint);
  const JointId in_world = joint_id(body, joint);
  const std::span<const double> q = world_.joint_q(in_world), v = world_.joint_v(in_world);
  std::array<double, 3> e{}, target_v{}, most{}, tau{};
  double kp = 0, kd = 0;
  bool is_stable = false;
  if (motor.ball_pd) {
    const BallSetting& s = *motor.ball_pd;
    const Vec3<double> error = error_of(s, q), added = motor.ball_torque;
    std::tie(kp, kd, is_stable) = std::tuple(s.kp, s.kd, s.mode == kStablePd);
    e = {error.x, error.y, error.z};
    target_v = {s.target_v.x, s.target_v.y, s.target_v.z};
    most = {s.force.x, s.force.y, s.force.z};
    tau = {added.x, added.y, added.z};
  } else {
    const MotorSetting& s = *motor.pd;
    std::tie(kp, kd, is_stable) = std::tuple(s.kp, s.kd, s.mode == kStablePd);
    std::tie(e[0], target_v[0], most[0], tau[0]) = std::tuple(s.target_q - q[0], s.target_v, s.force, motor.torque);
  }
  if (is_stable) {
    double share = 1;
    for (std::size_t k = 0; k < v.size(); ++k) {
      share = std::min(share, most[k] / std::max(std::abs(kp * e[k] + kd * (target_v[k] - v[k])), 1e-300));
    }
    std::tie(kp, kd) = std::pair(share * kp, share * kd);
    world_.set_joint_damping(in_world, body.plan.link(joint).damping + kd);
  }
  for (std::size_t k = 0; k < v.size(); ++k) {
    tau[k] += is_stable ? kp * (e[k] - h * v[k]) + kd * target_v[k]
                        : std::clamp(kp * e[k] + kd * (target_v[k] - v[k]), -most[k], most[k]);
  }
  world_.set_joint_tau(in_world, std::span(tau).first(v.size()));
  torqued_.push_back({body.id, joint});
}

void Client::apply_force(int id, int link, const Vec3<double>& force, const Vec3<double>& point, bool in_link_frame) {
  Body* const body = find(id);
  if (body == nullptr) return;
  if (!body->has_link(link)) throw Error("applyExternalForce: link index out-of-range.");
  if (body->plan.fixed && link < 0) return;
  const Transform<double> X_WI = inertial_pose(*body, link);
  world_.apply_link_force(link_id(*body, link), in_link_frame ? X_WI.R * force : force, Vec3<double>::zero(),
                          in_link_frame ? X_WI * point : point);
}

void Client::apply_torque(int id, int link, const Vec3<double>& torque, bool in_link_frame) {
  Body* const body = find(id);
  if (body == nullptr) return;
  if (!body->has_link(link)) throw Error("applyExternalTorque: link index out-of-range.");
  if (body->plan.fixed && link < 0) return;
  const Transform<double> X_WI = inertial_pose(*body, link);
  world_.apply_link_force(link_id(*body, link), Vec3<double>::zero(), in_link_frame ? X_WI.R * torque : torque, X_WI.p);
}

}  // namespace manyhands::bullet
