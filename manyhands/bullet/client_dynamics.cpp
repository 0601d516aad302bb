// Client: masses, materials and what else changes while running.
#include "manyhands/bullet/client_body.h"
#include "manyhands/bullet/inertia.h"

namespace manyhands::bullet {

void Client::write_inertial(Body& body, int link) {
  const LinkPlan& plan = body.plan.link(link);
  if (link < 0 && body.plan.fixed) return;
  const Vec3<double>& I = plan.inertia;
  const bool turns = I.x > 0 && I.y > 0 && I.z > 0;
  const double m = plan.mass;
  const Vec3<double> moments = turns || link >= 0 ? I : Vec3<double>{m, m, m};
  world_.set_link_inertial(
      link_id(body, link),
      {.mass = m,
       .com = plan.X_LI.p,
       .inertia = rotated(plan.X_LI.R, SymMat3<double>{moments.x, moments.y, moments.z, 0, 0, 0})});
}

void Client::write_surface(Body& body, int link) {
  world_.set_link_surface(link_id(body, link), body.plan.link(link).surface);
}

void Client::change_dynamics(int id, int link, const DynamicsChange& change) {
  if (change.contact_stiffness.has_value() != change.contact_damping.has_value()) {
    throw Error("Both contactStiffness and contactDamping needs to be set together.");
  }
  Body* const body = find(id);
  if (body == nullptr || !body->has_link(link)) return;
  LinkPlan& plan = body->plan.link(link);
  bool rebuild = false;
  if (change.mass && *change.mass >= 0) {
    plan.mass = *change.mass;
    plan.inertia = inertia_of_shapes(body->plan, plan, plan.mass);
    if (change.inertia) plan.inertia = *change.inertia;
    const bool fixed = link < 0 && plan.mass == 0;
    rebuild = link < 0 && fixed != body->plan.fixed;
    if (link < 0) body->plan.fixed = fixed;
    if (!rebuild && plan.mass > 0) write_inertial(*body, link);
  } else if (change.inertia) {
    plan.inertia = *change.inertia;
    if (plan.mass > 0) write_inertial(*body, link);
  }
  SurfaceMaterial& surface = plan.surface;
  const auto take = [](const std::optional<double>& from, double& to) {
    if (from && *from >= 0) to = *from;
    return from && *from >= 0;
  };
  bool touched = take(change.lateral_friction, surface.lateral_friction);
  touched = take(change.spinning_friction, surface.spinning_friction) || touched;
  touched = take(change.rolling_friction, surface.rolling_friction) || touched;
  touched = take(change.restitution, surface.restitution) || touched;
  if (touched) write_surface(*body, link);
  (void)take(change.linear_damping, body->linear_damping);
  (void)take(change.angular_damping, body->angular_damping);
  if (take(change.max_joint_velocity, body->max_joint_velocity)) body->is_capped = true;
  if (!plan.is_round()) (void)take(change.collision_margin, body->of(link).margin);
  if (change.contact_stiffness) {
    body->of(link).contact_stiffness = surface.stiffness = change.contact_stiffness;
    body->of(link).contact_damping = surface.damping = change.contact_damping;
    rebuild = true;
  }
  if (link >= 0 && take(change.joint_damping, plan.damping)) {
    world_.set_joint_damping(joint_id(*body, link), plan.damping);
  }
  if (link >= 0 && change.limits && (*change.limits)[0] <= (*change.limits)[1]) {
    const bool had = plan.is_limited();
    plan.lower = (*change.limits)[0];
    plan.upper = (*change.limits)[1];
    if (had) {
      world_.set_joint_limits(joint_id(*body, link), plan.lower, plan.upper);
    } else if (plan.joint == JointType::kContinuous || plan.joint == JointType::kRevolute ||
               plan.joint == JointType::kPrismatic) {
      if (plan.joint == JointType::kContinuous) plan.joint = JointType::kRevolute;
      rebuild = true;
    }
  }
  if (rebuild) replace(*body);
}

DynamicsReading Client::dynamics(int id, int link) const {
  const Body& body = at(id, "getDynamicsInfo failed; invalid return status");
  if (!body.has_link(link)) throw Error("getDynamicsInfo failed: link index out-of-range.");
  const LinkPlan& plan = body.plan.link(link);
  const bool still = link < 0 && body.plan.fixed;
  const LinkMemory& memory = body.of(link);
  return {.mass = still ? 0 : plan.mass,
          .lateral_friction = plan.surface.lateral_friction,
          .inertia = plan.inertia,
          .X_LI = plan.X_LI,
          .restitution = plan.surface.restitution,
          .rolling_friction = plan.surface.rolling_friction,
          .spinning_friction = plan.surface.spinning_friction,
          .contact_damping = memory.contact_damping.value_or(-1),
          .contact_stiffness = memory.contact_stiffness.value_or(-1),
          .body_type = 2,
          .margin = memory.margin};
}

}  // namespace manyhands::bullet
