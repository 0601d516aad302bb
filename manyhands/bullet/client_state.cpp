// Client: where bodies are and how they move.
#include <algorithm>

#include "manyhands/bullet/client_body.h"
#include "manyhands/math/quaternion.h"

namespace manyhands::bullet {

Transform<double> Client::inertial_pose(Body& body, int link) {
  return world_.link_pose(link_id(body, link)) * body.plan.link(link).X_LI;
}

Motion<double> Client::inertial_velocity(Body& body, int link) {
  const LinkId id = link_id(body, link);
  const Motion<double> V = world_.link_velocity(id);
  const Vec3<double>& com = body.plan.link(link).X_LI.p;
  if (com.x == 0 && com.y == 0 && com.z == 0) return V;
  return {V.w, V.v + cross(V.w, world_.link_pose(id).R * com)};
}

Transform<double> Client::base_pose(int id) {
  return inertial_pose(at(id, "GetBasePositionAndOrientation failed."), -1);
}

Motion<double> Client::base_velocity(int id) {
  Body& body = at(id, "getBaseVelocity failed.");
  return body.plan.fixed ? Motion<double>::zero() : inertial_velocity(body, -1);
}

void Client::reset_base_pose(int id, const Transform<double>& X_WI) {
  Body* const body = find(id);
  if (body == nullptr) return;
  const LinkId base = link_id(*body, -1);
  world_.set_link_pose(base, X_WI * inverse(body->plan.base.X_LI));
  if (!body->plan.fixed) world_.set_link_velocity(base, Motion<double>::zero());
}

void Client::reset_base_velocity(int id, const std::optional<Vec3<double>>& linear,
                                 const std::optional<Vec3<double>>& angular) {
  Body* const body = find(id);
  if (body == nullptr || body->plan.fixed) return;
  Motion<double> V = inertial_velocity(*body, -1);
  if (linear) V.v = *linear;
  if (angular) V.w = *angular;
  const LinkId base = link_id(*body, -1);
  const Vec3<double> to_origin = -(world_.link_pose(base).R * body->plan.base.X_LI.p);
  world_.set_link_velocity(base, {V.w, V.v + cross(V.w, to_origin)});
}

JointReading Client::joint_state(int id, int joint) {
  Body& body = at(id, "getJointState failed.");
  require_joint(&body, joint, "getJointState failed (2)");
  JointReading reading;
  const JointId in_world = joint_id(body, joint);
  const MotorMemory& motor = body.motor(joint);
  if (body.dof[static_cast<std::size_t>(joint)] >= 0) {
    const std::span<const double> q = world_.joint_q(in_world), v = world_.joint_v(in_world);
    reading.q.assign(q.begin(), q.end());
    reading.v.assign(v.begin(), v.end());
    reading.motor = world_.joint_forces(in_world);
    const bool drives = !motor.pd && motor.setting.mode != kTorque && motor.setting.force > 0;
    if (!motor.is_default && !drives) std::ranges::fill(reading.motor, 0.0);
  }
  if (!motor.has_sensor || world_.time() == 0) return reading;
  Force<double> F;
  try {
    F = world_.joint_wrench(world_.parts().joint(in_world).name);
  } catch (const std::runtime_error&) {
    return reading;  // before a step, or in a loop
  }
  // From the parent on the child, about its centre of mass, along its inertial axes; without the motor's part.
  const Transform<double> X_WI = inertial_pose(body, joint), X_WL = world_.link_pose(link_id(body, joint));
  Vec3<double> f = F.f, n = F.n - cross(X_WI.p - X_WL.p, F.f);
  if (body.dof[static_cast<std::size_t>(joint)] >= 0) {
    const Vec3<double> axis = X_WL.R * body.plan.link(joint).axis;
    if (body.plan.link(joint).joint == JointType::kPrismatic) {
      f = f - dot(f, axis) * axis;
    } else {
      n = n - dot(F.n, axis) * axis;
    }
  }
  const bool in_joint = (settings_.joint_feedback_mode & 2) != 0,
             in_world_axes = (settings_.joint_feedback_mode & 1) != 0;
  if (in_joint) n = n + cross(X_WI.p - X_WL.p, f);
  if (!in_world_axes) {
    f = transpose_times(X_WI.R, f);
    n = transpose_times(X_WI.R, n);
  }
  reading.reaction = {f.x, f.y, f.z, n.x, n.y, n.z};
  return reading;
}

void Client::reset_joint(int id, int joint, std::span<const double> q, std::span<const double> v) {
  Body* const body = find(id);
  require_joint(body, joint);
  if (body->dof[static_cast<std::size_t>(joint)] < 0) return;
  const JointId in_world = joint_id(*body, joint);
  if (world_.joint_q(in_world).size() != q.size() || world_.joint_v(in_world).size() != v.size()) return;
  world_.set_joint(in_world, q, v);
}

LinkReading Client::link_state(int id, int link) {
  Body& body = at(id, "getLinkState failed.");
  if (link < 0) throw Error("getLinkState failed; invalid linkIndex");
  LinkReading reading;
  reading.X_WL = world_.link_pose(link_id(body, link));
  reading.X_LI = body.plan.link(link).X_LI;
  reading.X_WI = reading.X_WL * reading.X_LI;
  reading.V = inertial_velocity(body, link);
  return reading;
}

void Client::enable_force_torque_sensor(int id, int joint, bool enabled) {
  Body* const body = find(id);
  if (body == nullptr || !body->has_joint(joint)) throw Error("Error: invalid jointIndex.");
  body->motor(joint).has_sensor = enabled;
}

// ---- boxes along the world's axes ---------------------------------------------------------------------------------

namespace {

void widen(Bounds& b, const BodyPlan& plan, const ShapePlan& shape, const Transform<double>& X_WG) {
  const Vec3<double>& s = shape.geom.shape.size;
  const Vec3<double>& z = X_WG.R.z;
  constexpr Vec3<double> kMiddle{0, 0, 0};
  switch (shape.geom.shape.type) {
    case ShapeType::kSphere:
      return b.widen(X_WG.p, {s.x, s.x, s.x});
    case ShapeType::kCapsule:
      return b.widen(X_WG.p, {s.x + s.y * std::abs(z.x), s.x + s.y * std::abs(z.y), s.x + s.y * std::abs(z.z)});
    case ShapeType::kCylinder: {
      const auto reach = [&](double c) { return s.y * std::abs(c) + s.x * std::sqrt(std::max(0.0, 1 - c * c)); };
      return b.widen(X_WG.p, {reach(z.x), reach(z.y), reach(z.z)});
    }
    case ShapeType::kBox:
      return b.widen(X_WG, kMiddle, s);
    case ShapeType::kPlane:
    case ShapeType::kHeightField:
      return b.widen(X_WG.p, {Bounds::kHuge, Bounds::kHuge, Bounds::kHuge});
    default:
      for (const Vec3<float>& p : plan.meshes[shape.geom.shape.mesh.index()].vertices) {
        b.widen(X_WG * Vec3<double>{p.x, p.y, p.z}, kMiddle);
      }
  }
}

}  // namespace

Bounds Client::bounds(int id, int link) {
  Body* const body = find(id);
  if (body == nullptr || !body->has_link(link)) throw Error("getAABB failed.");
  const Transform<double> X_WL = world_.link_pose(link_id(*body, link));
  const std::vector<ShapePlan>& shapes = body->plan.link(link).collisions;
  if (shapes.empty()) return {X_WL.p, X_WL.p};
  Bounds b;
  for (const ShapePlan& shape : shapes) widen(b, body->plan, shape, X_WL * shape.geom.X_LG);
  return b;
}

std::vector<std::array<int, 2>> Client::overlapping(const Bounds& box) {
  constexpr double kThreshold = 0.02;  // that PyBullet adds to the boxes of links [m]
  constexpr Vec3<double> kReach{kThreshold, kThreshold, kThreshold};
  const Bounds wide{box.low - kReach, box.high + kReach};
  std::vector<std::array<int, 2>> found;
  for (const int id : order_) {
    for (int i = -1; i < num_joints(id); ++i) {
      if (find(id)->plan.link(i).collisions.empty()) continue;
      if (wide.meets(bounds(id, i))) found.push_back({id, i});
    }
  }
  return found;
}

}  // namespace manyhands::bullet
