#include "manyhands/model/model.h"

#include <algorithm>

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
  }
  return "unknown";
}

int configuration_size(JointType type) {
  switch (type) {
    case JointType::kFixed:
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

template <class Part>
int find(const std::vector<Part>& parts, std::string_view name, const std::string& model, const char* kind) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].name == name) return static_cast<int>(i);
  }
  std::string message = "model '" + model + "' has no " + kind + " '" + std::string(name) + "'; it has:";
  for (const Part& part : parts) message += " '" + part.name + "'";
  throw std::out_of_range(message);
}

}  // namespace

LinkId Model::root_link(LinkId id) const {
  while (link(id).parent.value() > 0) id = link(id).parent;
  return id;
}

LinkId Model::link_id(std::string_view name) const { return LinkId(find(links_, name, name_, "link")); }
JointId Model::joint_id(std::string_view name) const { return JointId(find(joints_, name, name_, "joint")); }
FrameId Model::frame_id(std::string_view name) const { return FrameId(find(frames_, name, name_, "frame")); }

std::vector<double> Model::neutral_configuration() const {
  std::vector<double> q(static_cast<std::size_t>(nq_), 0.0);
  for (const Body& body : bodies_) {
    const bool has_quaternion = body.type == JointType::kSpherical || body.type == JointType::kFloating;
    if (has_quaternion) q[static_cast<std::size_t>(body.iq + body.nq - 1)] = 1.0;
  }
  return q;
}

std::vector<double> Model::initial_configuration() const {
  std::vector<double> q = neutral_configuration();
  for (const Joint& joint : joints_) std::ranges::copy(joint.initial, q.begin() + std::max(joint.iq, 0));
  return q;
}

}  // namespace manyhands
