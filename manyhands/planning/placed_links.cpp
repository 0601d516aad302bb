#include "manyhands/planning/placed_links.h"

#include "manyhands/physics/dynamics/kinematics.h"
#include "manyhands/planning/checks.h"

namespace manyhands {

PlacedLinks::PlacedLinks(const Model& model, std::span<const double> q, std::span<const double> mocap)
    : model_(model), tree_(model), colliders_(model, PairSearch::kSwept), ws_(tree_) {
  const std::vector<double> initial = model.initial_mocap();
  const std::span<const double> poses = mocap.empty() ? std::span<const double>(initial) : mocap;
  require_rows("q", q, 1, static_cast<std::size_t>(model.nq()));
  require_rows("mocap", poses, 1, model.mocap_bodies().size() * kPoseNumbers);
  place_mocap(tree_, poses.data(), ws_);
  forward_kinematics(tree_, q.data(), ws_);
}

std::vector<PlacedShape> PlacedLinks::shapes_of(LinkId link) const {
  std::vector<PlacedShape> found;
  for (const Collider<double>& geom : colliders_.geoms) {
    if (geom.link != link.index()) continue;
    found.push_back(
        {{geom.type, model_.geoms()[geom.geom].shape.size, geom.hull.get(), geom.mesh.get(), geom.height_field.get()},
         body_pose(geom.body, ws_) * geom.X_BG});
  }
  return found;
}

Vec3<double> PlacedLinks::com_of(LinkId link) const {
  const Link& of = model_.link(link);
  return body_pose(of.body.index(), ws_) * (of.X_BL * of.inertial.com);
}

}  // namespace manyhands
