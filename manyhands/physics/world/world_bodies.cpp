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
  const LinkId id = loose().model->link_id(name);
  const Link& link = loose().model->link(id);
  if (loose().model->body(link.body).type == JointType::kMocap) (void)free_body(loose(), link, "pose");
  set_link_pose(id, X_WL);
}

void World::set_mocap(std::string_view name, const Transform<double>& X_WL) {
  (void)loose().model->mocap_index(name);
  set_link_pose(loose().model->link_id(name), X_WL);
}

std::span<const double> World::mocap() const {
  const WorldCore& now = core();
  return {now.state.mocap(), kPoseNumbers * now.model->mocap_bodies().size()};
}

void World::set_body_velocity(std::string_view name, const Motion<double>& V_WL) {
  set_link_velocity(loose().model->link_id(name), V_WL);
}

void World::apply_force(std::string_view name, const Vec3<double>& force, const Vec3<double>& torque,
                        const std::optional<Vec3<double>>& point) {
  const WorldCore& now = loose();
  const LinkId id = now.model->link_id(name);
  const Link& link = now.model->link(id);
  apply_link_force(id, force, torque,
                   point ? *point : frame_pose(link.body, link.X_BL, now.placed()) * link.inertial.com);
}

}  // namespace manyhands
