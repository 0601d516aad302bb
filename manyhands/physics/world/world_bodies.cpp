// World: where bodies are, how they move, and what pushes them.
#include "manyhands/base/float_environment.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/physics/world/world_impl.h"

namespace manyhands {

using internal::require_pose;
using internal::require_vector;

Transform<double> World::body_pose(std::string_view name) const {
  const WorldCore& now = loose();
  const Frame& frame = now.model->frame(now.model->frame_id(name));
  return frame_pose(frame.body, frame.X_BF, now.placed());
}

Motion<double> World::body_velocity(std::string_view name) const {
  const WorldCore& now = loose();
  const Frame& frame = now.model->frame(now.model->frame_id(name));
  const Workspace<double>& ws = now.placed();
  const std::size_t b = frame.body.index();
  return at_point(ws.V[b], ws.R_WB[b] * frame.X_BF.p + ws.p_OB[b]);
}

/// The body of a link that a floating joint carries in the world.
const Body& World::free_body(const WorldCore& core, const Link& link, const char* what) const {
  const Body& body = core.model->body(link.body);
  if (body.type == JointType::kFloating && body.parent.value() == 0) return body;
  const bool welded = link.body.value() == 0;
  throw std::invalid_argument("link '" + link.name + "' has no " + what + " of its own to set: it " +
                              (body.type == JointType::kMocap ? "is a mocap body; use set_mocap"
                               : welded ? "is fixed to the world"
                                        : "hangs on joint '" + core.model->joint(body.joint).name + "'; set q and v"));
}

void World::set_body_pose(std::string_view name, const Transform<double>& X_WL) {
  const FloatEnvironment floats;
  require_pose("link '" + std::string(name) + "'", X_WL);
  const LinkId id = loose().model->link_id(name);
  if (id.value() != 0 && loose().model->link(id).joint.value() < 0) {
    loose().place_root(id, X_WL);
    return;
  }
  WorldCore& now = loose();
  const Link& link = now.model->link(id);
  const Body& body = free_body(now, link, "pose");
  const Transform<double> X_FB = inverse(body.X_PF) * (X_WL * inverse(link.X_BL));
  const Quat<double> r = normalized(to_quat(X_FB.R));
  const std::array<double, 7> q{X_FB.p.x, X_FB.p.y, X_FB.p.z, r.x, r.y, r.z, r.w};
  std::copy(q.begin(), q.end(), now.state.q() + body.iq);
  now.moved();
}

void World::set_mocap(std::string_view name, const Transform<double>& X_WL) {
  const FloatEnvironment floats;
  require_pose("link '" + std::string(name) + "'", X_WL);
  WorldCore& now = loose();
  const Quat<double> r = normalized(to_quat(X_WL.R));
  const std::array<double, kPoseNumbers> pose{X_WL.p.x, X_WL.p.y, X_WL.p.z, r.x, r.y, r.z, r.w};
  std::ranges::copy(pose, now.state.mocap() + kPoseNumbers * now.model->mocap_index(name));
  now.moved();
}

std::span<const double> World::mocap() const {
  const WorldCore& now = core();
  return {now.state.mocap(), kPoseNumbers * now.model->mocap_bodies().size()};
}

void World::set_body_velocity(std::string_view name, const Motion<double>& V_WL) {
  const FloatEnvironment floats;
  require_vector("the angular velocity of link '" + std::string(name) + "'", V_WL.w);
  require_vector("the velocity of link '" + std::string(name) + "'", V_WL.v);
  WorldCore& now = loose();
  const Link& link = now.model->link(now.model->link_id(name));
  const Body& body = free_body(now, link, "velocity");
  const Vec3<double> p_LB = -(now.placed().R_WB[link.body.index()] * link.X_BL.p);
  const Vec3<double> w = transpose_times(body.X_PF.R, V_WL.w);
  const Vec3<double> v = transpose_times(body.X_PF.R, V_WL.v + cross(V_WL.w, p_LB));
  const std::array<double, 6> numbers{w.x, w.y, w.z, v.x, v.y, v.z};
  std::copy(numbers.begin(), numbers.end(), now.state.v() + body.iv);
  now.moved();
}

void World::apply_force(std::string_view name, const Vec3<double>& force, const Vec3<double>& torque,
                        const std::optional<Vec3<double>>& point) {
  const FloatEnvironment floats;
  require_vector("the force on '" + std::string(name) + "'", force);
  require_vector("the torque on '" + std::string(name) + "'", torque);
  if (point) require_vector("the point of the force on '" + std::string(name) + "'", *point);
  WorldCore& now = loose();
  const LinkId id = now.model->link_id(name);
  const Link& link = now.model->link(id);
  const Vec3<double> p = point ? *point : frame_pose(link.body, link.X_BL, now.placed()) * link.inertial.com;
  Force<double>& sum = now.extras.external[id.index()];
  sum = sum + Force<double>{torque + cross(p, force), force};
  now.extras.pushed[0] = 1;
}

}  // namespace manyhands
