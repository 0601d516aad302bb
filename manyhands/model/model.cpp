#include "manyhands/model/model.h"

#include <algorithm>

#include "manyhands/math/quaternion.h"

namespace manyhands {

const char* to_string(JointType type) {
  switch (type) {
    case JointType::kFixed:
      return "fixed";
    case JointType::kRevolute:
      return "revolute";
    case JointType::kContinuous:
      return "continuous";
    case JointType::kPrismatic:
      return "prismatic";
    case JointType::kSpherical:
      return "spherical";
    case JointType::kPlanar:
      return "planar";
    case JointType::kFloating:
      return "floating";
    case JointType::kMocap:
      return "mocap";
  }
  return "unknown";
}

int configuration_size(JointType type) {
  switch (type) {
    case JointType::kFixed:
    case JointType::kMocap:
      return 0;
    case JointType::kRevolute:
    case JointType::kContinuous:
    case JointType::kPrismatic:
      return 1;
    case JointType::kSpherical:
      return 4;
    case JointType::kPlanar:
      return 3;
    case JointType::kFloating:
      return 7;
  }
  return 0;
}

int velocity_size(JointType type) {
  switch (type) {
    case JointType::kSpherical:
      return 3;
    case JointType::kFloating:
      return 6;
    default:
      return configuration_size(type);
  }
}

RigidInertia<double> Inertial::about_origin() const {
  const RigidInertia<double> at_com{mass, Vec3<double>::zero(), inertia};
  return transformed({Mat3<double>::identity(), com}, at_com);
}

namespace {

/// Parts that were removed have no name.
template <class Part>
[[noreturn]] void throw_unknown(const std::vector<Part>& parts, std::string_view name, const std::string& model,
                                const char* kind) {
  std::string message = "model '" + model + "' has no " + kind + " '" + std::string(name) + "'; it has:";
  for (const Part& part : parts) {
    if (!part.name.empty()) message += " '" + part.name + "'";
  }
  throw std::out_of_range(message);
}

}  // namespace

const Keyframe& Model::keyframe(std::string_view name) const {
  const auto found = std::ranges::find(keyframes_, name, &Keyframe::name);
  if (found == keyframes_.end()) throw_unknown(keyframes_, name, name_, "keyframe");
  return *found;
}

LinkId Model::root_link(LinkId id) const {
  while (link(id).parent.value() > 0) id = link(id).parent;
  return id;
}

LinkId Model::find_link(std::string_view name) const {
  const auto found = link_names_.find(name);
  return found == link_names_.end() ? LinkId() : LinkId(found->second);
}

GeomId Model::find_geom(std::string_view name) const {
  const auto found = geom_names_.find(name);
  return found == geom_names_.end() ? GeomId() : GeomId(found->second);
}

std::vector<LinkId> Model::find_links(std::string_view name) const {
  std::vector<LinkId> found;
  if (const LinkId link = find_link(name); link.is_valid()) found.push_back(link);
  const std::string within = std::string(name) + "/";
  for (auto at = link_names_.lower_bound(within); at != link_names_.end() && at->first.starts_with(within); ++at) {
    found.emplace_back(at->second);
  }
  return found;
}

LinkId Model::link_id(std::string_view name) const {
  const LinkId id = find_link(name);
  if (!id.is_valid()) throw_unknown(links_, name, name_, "link");
  return id;
}

JointId Model::joint_id(std::string_view name) const {
  const auto found = joint_names_.find(name);
  if (found == joint_names_.end()) throw_unknown(joints_, name, name_, "joint");
  return JointId(found->second);
}

FrameId Model::frame_id(std::string_view name) const {
  if (const LinkId link = find_link(name); link.is_valid()) return FrameId(link.value());
  const auto found = frame_names_.find(name);
  if (found == frame_names_.end()) throw_unknown(frames_, name, name_, "frame");
  return FrameId(found->second);
}

TendonId Model::tendon_id(std::string_view name) const {
  const auto found = std::ranges::find(tendons_, name, &Tendon::name);
  if (found == tendons_.end()) throw_unknown(tendons_, name, name_, "tendon");
  return TendonId(static_cast<std::size_t>(found - tendons_.begin()));
}

/// What names and parts belong to, once the parts stand.
void Model::index_parts() {
  for (std::size_t i = links_.size(); i < frames_.size(); ++i) {
    frame_names_.emplace(frames_[i].name, static_cast<int>(i));
  }
  link_geoms_.resize(links_.size());
  for (std::size_t i = 0; i < geoms_.size(); ++i) {
    if (!geoms_[i].name.empty()) geom_names_.emplace(geoms_[i].name, static_cast<int>(i));
    link_geoms_[geoms_[i].link.index()].push_back(GeomId(i));
  }
  link_children_.resize(links_.size());
  body_links_.resize(bodies_.size());
  for (std::size_t i = 0; i < links_.size(); ++i) {
    if (i > 0) link_children_[links_[i].parent.index()].push_back(LinkId(i));
    body_links_[links_[i].body.index()].push_back(LinkId(i));
  }
}

const Sensor& Model::sensor(std::string_view name) const {
  const auto found = std::ranges::find(sensors_, name, &Sensor::name);
  if (found == sensors_.end()) throw_unknown(sensors_, name, name_, "sensor");
  return *found;
}

std::size_t Model::mocap_index(std::string_view name) const {
  const Link& found = link(link_id(name));
  const auto place = std::ranges::find(mocap_bodies_, found.body);
  const bool is_root = found.joint.is_valid() && joint(found.joint).type == JointType::kMocap;
  if (is_root && place != mocap_bodies_.end()) return static_cast<std::size_t>(place - mocap_bodies_.begin());
  throw std::invalid_argument("link '" + found.name + "' is no mocap body: expected one that a mocap joint carries");
}

std::vector<double> Model::neutral_configuration() const {
  std::vector<double> q(static_cast<std::size_t>(nq_), 0.0);
  for (const Body& body : bodies_) {
    const bool has_quaternion = body.type == JointType::kSpherical || body.type == JointType::kFloating;
    if (has_quaternion) q[static_cast<std::size_t>(body.iq + body.nq - 1)] = 1.0;
  }
  return q;
}

std::vector<double> Model::initial_mocap() const {
  std::vector<double> poses;
  for (const BodyId id : mocap_bodies_) {
    const Transform<double>& X = body(id).X_PF;
    const Quat<double> r = to_quat(X.R);
    poses.insert(poses.end(), {X.p.x, X.p.y, X.p.z, r.x, r.y, r.z, r.w});
  }
  return poses;
}

std::vector<double> Model::spring_reference() const {
  std::vector<double> q = neutral_configuration();
  for (const Joint& joint : joints_) std::ranges::copy(joint.spring_reference, q.begin() + std::max(joint.iq, 0));
  return q;
}

std::vector<double> Model::initial_configuration() const {
  std::vector<double> q = neutral_configuration();
  for (const Joint& joint : joints_) std::ranges::copy(joint.initial, q.begin() + std::max(joint.iq, 0));
  return q;
}

}  // namespace manyhands
