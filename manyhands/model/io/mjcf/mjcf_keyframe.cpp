// <keyframe>: states with names.
#include <algorithm>
#include <numeric>

#include "manyhands/model/io/mjcf/mjcf_scene.h"

namespace manyhands::io {

namespace {

/// qpos and qvel of MuJoCo become q and v: quaternions from wxyz to xyzw, angular velocities from body to joint axes.
void turn_joints(const MjcfScene& scene, const MjcfElement& e, std::vector<double>& q, std::vector<double>& v) {
  std::size_t iq = 0, iv = 0;
  for (const MjcfJoint& joint : scene.joints) {
    const JointType type = scene.builder.joints()[joint.id.index()].type;
    const bool is_free = type == JointType::kFloating;
    if (is_free || type == JointType::kSpherical) {
      double* const r = &q[iq + (is_free ? 3 : 0)];
      const Quat<double> turn = quat_from_wxyz(e, r);
      r[0] = turn.x;
      r[1] = turn.y;
      r[2] = turn.z;
      r[3] = turn.w;
      double* const w = &v[iv];
      const Vec3<double> linear{w[0], w[1], w[2]};
      const Vec3<double> omega = to_matrix(turn) * (is_free ? Vec3<double>{w[3], w[4], w[5]} : linear);
      w[0] = omega.x;
      w[1] = omega.y;
      w[2] = omega.z;
      if (is_free) {
        w[3] = linear.x;
        w[4] = linear.y;
        w[5] = linear.z;
      }
    }
    iq += static_cast<std::size_t>(configuration_size(type));
    iv += static_cast<std::size_t>(velocity_size(type));
  }
}

/// mpos and mquat of the mocap bodies; where they do not say, the poses that the file gives the bodies.
std::vector<double> read_mocap(const MjcfScene& scene, const MjcfElement& e) {
  std::vector<double> poses;
  const auto count = static_cast<std::size_t>(std::ranges::count_if(scene.bodies, &MjcfBody::is_mocap));
  const std::vector<double> positions = e.numbers("mpos", 3 * count, 3 * count);
  const std::vector<double> turns = e.numbers("mquat", 4 * count, 4 * count);
  for (const MjcfBody& body : scene.bodies) {
    if (!body.is_mocap) continue;
    const std::size_t i = poses.size() / 7;
    const Vec3<double> p =
        positions.empty() ? body.X_WB.p : Vec3<double>{positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
    const Quat<double> r = turns.empty() ? to_quat(body.X_WB.R) : quat_from_wxyz(e, &turns[4 * i]);
    poses.insert(poses.end(), {p.x, p.y, p.z, r.x, r.y, r.z, r.w});
  }
  return poses;
}

/// What the file has for actuators that were left out is passed over.
void read_activations(const MjcfScene& scene, const MjcfElement& e, Keyframe& key) {
  if (!e.has("act")) return;
  const std::size_t count = std::accumulate(scene.activations.begin(), scene.activations.end(), std::size_t{0});
  const std::vector<double> act = e.numbers("act", count, count);
  for (std::size_t i = 0, next = 0; i < scene.actuators.size(); next += scene.activations[i++]) {
    if (scene.activations[i] > 0 && scene.actuators[i] >= 0) key.act.push_back(act[next]);
  }
}

void read_key(MjcfScene& scene, const MjcfElement& element, std::size_t index) {
  const std::string given = element.text_or("name", "");
  Keyframe key{.name = given.empty() ? "key_" + std::to_string(index) : given};
  const MjcfElement e = element.named("key '" + key.name + "'");
  e.expect({"name", "time", "qpos", "qvel", "ctrl", "act", "mpos", "mquat"});
  key.time = e.number_or("time", 0);
  std::size_t nq = 0, nv = 0;
  for (const MjcfJoint& joint : scene.joints) {
    const JointType type = scene.builder.joints()[joint.id.index()].type;
    nq += static_cast<std::size_t>(configuration_size(type));
    nv += static_cast<std::size_t>(velocity_size(type));
  }
  if (e.has("qpos")) key.q = e.numbers("qpos", nq, nq);
  key.v = e.has("qvel") ? e.numbers("qvel", nv, nv) : std::vector<double>(nv, 0.0);
  if (!key.q.empty()) {
    turn_joints(scene, e, key.q, key.v);
  } else if (e.has("qvel")) {
    e.note(LoadAction::kIgnored, "'qvel' without 'qpos' is not used");
    key.v.assign(nv, 0.0);
  }
  const std::vector<double> ctrl = e.numbers("ctrl", scene.actuators.size(), scene.actuators.size());
  for (std::size_t i = 0; i < ctrl.size(); ++i) {
    if (scene.actuators[i] >= 0) key.ctrl.push_back(ctrl[i]);
  }
  read_activations(scene, e, key);
  key.mocap = read_mocap(scene, e);
  scene.builder.add_keyframe(std::move(key));
}

}  // namespace

void read_keyframes(MjcfScene& scene) {
  std::size_t index = 0;
  for (const MjcfElement& section : scene.root.children("keyframe")) {
    section.named("keyframe").expect({}, {"key"});
    for (const MjcfElement& element : section.children("key")) read_key(scene, element, index++);
  }
  int asked = 0;
  for (const MjcfElement& size : scene.root.children("size")) asked = std::max(asked, size.integer_or("nkey", 0));
  constexpr int kMostKeys = 10'000;
  if (asked > kMostKeys) scene.root.fail("nkey is " + std::to_string(asked) + "; expected at most 10000");
  while (index < static_cast<std::size_t>(asked)) {
    scene.builder.add_keyframe({.name = "key_" + std::to_string(index++), .mocap = read_mocap(scene, scene.root)});
  }
  for (const MjcfElement& other : scene.attached) {
    for (const MjcfElement& section : other.children("keyframe")) {
      section.named("keyframe").note(LoadAction::kIgnored, "keyframes of attached models are not read");
    }
  }
}

}  // namespace manyhands::io
