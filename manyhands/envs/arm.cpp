#include "manyhands/envs/arm.h"

#include <algorithm>

#include "manyhands/envs/require.h"

namespace manyhands {

namespace {

const Body& body_of(const Model& scene, const std::string& joint) {
  const bool known = std::ranges::any_of(scene.joints(), [&](const Joint& j) { return j.name == joint; });
  std::string message = "the arm has no joint '" + joint + "'; those that move are:";
  for (const Joint& j : scene.joints()) {
    const bool moves =
        j.type == JointType::kRevolute || j.type == JointType::kContinuous || j.type == JointType::kPrismatic;
    if (moves) message += " '" + j.name + "'";
  }
  require(known, message);
  const Body& body = scene.body(scene.link(scene.joint(scene.joint_id(joint)).child).body);
  require(body.nq == 1 && body.iq == body.iv,
          "joint '" + joint + "': an arm's joints must have one degree of freedom each");
  return body;
}

/// Throws std::invalid_argument on a name that is listed before.
void require_distinct(const ArmSpec& spec) {
  std::vector<std::string> names = spec.joints;
  names.insert(names.end(), spec.fingers.begin(), spec.fingers.end());
  for (auto name = names.begin(); name != names.end(); ++name)
    require(std::find(names.begin(), name, *name) == name, "joint '" + *name + "' is listed twice in the arm's joints");
}

std::vector<std::size_t> dofs_of(const Model& scene, const std::vector<std::string>& names) {
  std::vector<std::size_t> dofs;
  dofs.reserve(names.size());
  for (const std::string& name : names) dofs.push_back(static_cast<std::size_t>(body_of(scene, name).iv));
  return dofs;
}

/// By how much the hand opens per unit of each finger.
std::vector<double> opening_of(const ArmSpec& spec, const Model& scene) {
  if (!spec.opening.empty()) return spec.opening;
  for (const std::string& name : spec.fingers)
    require(body_of(scene, name).type == JointType::kPrismatic,
            "joint '" + name + "': fingers must slide, or `opening` says by how much the hand opens per rad");
  return std::vector<double>(spec.fingers.size(), 1.0);
}

FrameId hand_of(const Model& scene, const std::string& name) {
  const bool known = std::ranges::any_of(scene.frames(), [&](const Frame& frame) { return frame.name == name; });
  require(known, "the arm has no link or frame '" + name + "' to be its hand");
  return scene.frame_id(name);
}

/// Where a joint is with the arm in its neutral pose, `q` (nq) of joints that follow no others.
double place_of(const Model& scene, const Joint& joint, const std::vector<double>& q,
                const std::vector<std::size_t>& driven) {
  const auto dof = static_cast<std::size_t>(joint.iq);
  if (!joint.mimic || std::ranges::count(driven, dof) > 0) return q[dof];
  const Joint& driver = scene.joint(scene.joint_id(joint.mimic->joint));
  return joint.mimic->multiplier * place_of(scene, driver, q, driven) + joint.mimic->offset;
}

/// The joints that mimic others and are not driven themselves.
std::vector<Follower> followers_of(const Model& scene, const Arm& arm) {
  std::vector<std::size_t> driven = arm.joints;
  driven.insert(driven.end(), arm.fingers.begin(), arm.fingers.end());
  std::vector<double> q = scene.initial_configuration();
  for (std::size_t i = 0; i < driven.size(); ++i) q[driven[i]] = arm.neutral[i];
  std::vector<Follower> followers;
  for (const Joint& joint : scene.joints()) {
    const auto dof = static_cast<std::size_t>(joint.iq);
    if (joint.mimic && std::ranges::count(driven, dof) == 0)
      followers.push_back({dof, place_of(scene, joint, q, driven)});
  }
  return followers;
}

/// One finite number for each finger.
void check_fingers(const std::string& what, const std::vector<double>& numbers, std::size_t count) {
  require(numbers.size() == count && std::ranges::all_of(numbers, [](double x) { return is_finite(x); }),
          "an arm of " + std::to_string(count) + " fingers needs as many finite numbers in " + what);
}

/// One finite number for each joint, `least` or more.
void check(const std::string& what, const std::vector<double>& numbers, std::size_t count, double least) {
  require(numbers.size() == count, "an arm of " + std::to_string(count) + " joints, fingers included, has " +
                                       std::to_string(numbers.size()) + " numbers in " + what);
  for (const double x : numbers)
    require(is_finite(x) && x >= least,
            what + " holds " + std::to_string(x) + (least == 0 ? "; expected 0 or more" : "; expected finite numbers"));
}

/// Meets a pose that is in reach; where none is, as near as the limits let it.
IkSettings exact_ik() { return {.max_iterations = 20, .damping = 1e-4}; }

}  // namespace

Arm::Arm(const ArmSpec& spec, const Model& scene, ArmControl control_, bool has_gripper_, const Impedance& impedance_)
    : control(control_),
      impedance(impedance_),
      has_gripper(has_gripper_),
      joints(dofs_of(scene, spec.joints)),
      fingers(dofs_of(scene, spec.fingers)),
      neutral(spec.neutral),
      max_force(spec.max_force),
      closed(spec.closed.empty() ? std::vector<double>(fingers.size(), 0.0) : spec.closed),
      opening(opening_of(spec, scene)),
      hand(hand_of(scene, spec.hand)),
      chain(scene, hand),
      ik(control == ArmControl::kEndEffector ? panda_gym_ik() : exact_ik()) {
  const std::size_t count = joints.size() + fingers.size();
  require_distinct(spec);
  require(!joints.empty() && joints.size() < kMostActions,
          "an arm has " + std::to_string(joints.size()) + " joints; expected 1 to " + std::to_string(kMostActions - 1));
  require(!has_gripper || !fingers.empty(), "the task needs a gripper, but the arm has no fingers");
  check("neutral", neutral, count, -std::numeric_limits<double>::infinity());
  check("max_force", max_force, count, 0);
  check_fingers("closed", closed, fingers.size());
  check_fingers("opening", opening, fingers.size());
  for (const double opens : opening) {
    require(opens != 0, "opening holds 0; expected by how much the hand opens as the finger moves");
    per_width.push_back(1 / (static_cast<double>(fingers.size()) * opens));
  }
  followers = followers_of(scene, *this);
  check("the impedance",
        {impedance.stiffness, impedance.damping, impedance.rotational_stiffness, impedance.rotational_damping}, 4, 0);
}

IkSettings panda_gym_ik() {
  return {.max_iterations = 20,
          .damping = 0.5,
          .error_damping = 0,
          .position_tolerance = 1e-4,
          .rotation_tolerance = std::numeric_limits<double>::infinity(),
          .respect_limits = false};
}

}  // namespace manyhands
