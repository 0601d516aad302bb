// Client: what drives and pushes bodies.
#include "manyhands/bullet/client_body.h"

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
  const bool is_round = body.plan.link(joint).joint == JointType::kSpherical;
  if (setting.mode == kTorque) {
    motor.torque += setting.force;
    motor.round_torque = motor.round_torque + setting.torque;
    const Vec3<double>& t = motor.round_torque;
    const std::vector<double> tau =
        is_round ? std::vector{t.x, t.y, t.z} : std::vector(world_.joint_v(in_world).size(), motor.torque);
    world_.set_joint_tau(in_world, tau);
    torqued_.push_back({body.id, joint});
    return;
  }
  if (setting.mode == kPd || setting.mode == kStablePd) {
    motor.pd = {setting.kp, setting.kd, setting.target_q, setting.target_v, setting.force};
    if (setting.force == 0) motor.pd.clear();
    body.has_clamps = true;
    return;
  }
  motor.is_default = false;
  motor.setting = setting;
  if (setting.mode == kVelocity) motor.max_velocity = std::numeric_limits<double>::infinity();
  if (setting.max_velocity && *setting.max_velocity >= 0) motor.max_velocity = *setting.max_velocity;
  body.has_clamps = body.has_clamps || is_finite(motor.max_velocity) || setting.target_r.has_value();
  write_motor(body, joint);
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
