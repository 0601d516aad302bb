// <equality> and <keyframe>.
#include <algorithm>
#include <cmath>

#include "manyhands/model/io/mjcf/mjcf_compliance.h"
#include "manyhands/model/io/mjcf/mjcf_settings.h"
#include "manyhands/model/io/mjcf/mjcf_writer.h"
#include "manyhands/model/unit.h"

namespace manyhands::io {

namespace {

using Pose = Transform<double>;

class EqualityWriter {
 public:
  EqualityWriter(MjcfWriter& writer, pugi::xml_node section) : writer_(writer), section_(section) {}

  void write(const EqualityConstraint& e) {
    const std::string what = part("equality", e.name);
    if (std::isfinite(e.max_force)) {
      writer_.notes.loss(LoadAction::kIgnored, what, "its largest force is left out: MJCF has none");
    }
    switch (e.type) {
      case EqualityType::kPoint:
        return write_point(e);
      case EqualityType::kHinge:
        return write_hinge(e, what);
      case EqualityType::kFixed:
        return write_weld(e);
      case EqualityType::kJoint:
        return write_joint(e);
      case EqualityType::kGear:
        writer_.notes.loss(LoadAction::kRepaired, what, "a gear, which couples velocities, becomes a joint equality");
        return write_joint(e);
      case EqualityType::kTendon:
        return write_tendon(e);
      case EqualityType::kPrismatic:
      case EqualityType::kSlider:
        return writer_.notes.loss(LoadAction::kIgnored, what, "a slider between two bodies of a loop is left out");
    }
  }

 private:
  [[nodiscard]] pugi::xml_node add(const char* kind, const EqualityConstraint& e, const std::string& name) {
    pugi::xml_node node = section_.append_child(kind);
    set(node, "name", writer_.names.claim("equality", name, kind, writer_.notes));
    write_compliance(writer_, node, part("equality", name), e.compliance, "solref", "solimp");
    if (e.compliance && e.type == EqualityType::kFixed) set_unless(node, "torquescale", e.torque_scale, 1);
    return node;
  }

  /// By one anchor, if readers find the other point where it is: by the poses at the start.
  void write_point(const EqualityConstraint& e) {
    const Vec3<double> p_B = inverse(writer_.place_of(e.link_b).X_WB) * (writer_.place_of(e.link_a).X_WB * e.X_LA.p);
    const bool is_turned = !same(e.X_LA.R, Mat3<double>::identity()) || !same(e.X_LB.R, Mat3<double>::identity());
    if (is_turned || !same(p_B, e.X_LB.p)) return write_poses("connect", e, e.name, e.X_LA, e.X_LB);
    pugi::xml_node node = add("connect", e, e.name);
    set(node, "body1", writer_.body(e.link_a));
    set(node, "body2", writer_.body(e.link_b));
    set(node, "anchor", e.X_LA.p);
  }

  void write_poses(const char* kind, const EqualityConstraint& e, const std::string& name, const Pose& X_LA,
                   const Pose& X_LB) {
    pugi::xml_node node = add(kind, e, name);
    const std::string stem = node.attribute("name").value();
    set(node, "site1", site_at(writer_, e.link_a, X_LA, stem + "_a"));
    set(node, "site2", site_at(writer_, e.link_b, X_LB, stem + "_b"));
  }

  /// Two points on the axis.
  void write_hinge(const EqualityConstraint& e, const std::string& what) {
    constexpr double kApart = 0.1;  // [m]
    const Pose up{Mat3<double>::identity(), {0, 0, kApart}};
    write_poses("connect", e, e.name, e.X_LA, e.X_LB);
    write_poses("connect", e, e.name.empty() ? "" : e.name + "_axis", e.X_LA * up, e.X_LB * up);
    writer_.notes.changed(what, "a hinge of a loop becomes two points on its axis");
  }

  /// X_LA is relpose times the anchor.
  void write_weld(const EqualityConstraint& e) {
    if (!same(e.X_LB.R, Mat3<double>::identity())) return write_poses("weld", e, e.name, e.X_LA, e.X_LB);
    pugi::xml_node node = add("weld", e, e.name);
    set(node, "body1", writer_.body(e.link_a));
    set(node, "body2", writer_.body(e.link_b));
    set(node, "anchor", e.X_LB.p);
    const Quat<double> q = quat_for(e.X_LA.R);
    const Mat3<double> R = to_matrix(q);
    const auto read = [&](const Vec3<double>& p) { return Pose{R, p} * e.X_LB.p; };
    const Vec3<double> p = point_for(e.X_LA.p - R * e.X_LB.p, e.X_LA.p, read);
    const std::array<double, 4> turn = wxyz(q);
    set(node, "relpose", std::array{p.x, p.y, p.z, turn[0], turn[1], turn[2], turn[3]});
  }

  /// MuJoCo counts both joints from their references.
  void write_joint(const EqualityConstraint& e) {
    const Joint &a = writer_.model.joint(e.joint_a), &b = writer_.model.joint(e.joint_b);
    const auto reference = [](const Joint& joint) { return joint.initial.empty() ? 0 : joint.initial[0]; };
    const double from = reference(a), to = reference(b);
    pugi::xml_node node = add("joint", e, e.name);
    set(node, "joint1", b.name);
    set(node, "joint2", a.name);
    const auto read = [&](double c) { return to + c - e.ratio * from; };
    const double offset = number_for(e.offset - to + e.ratio * from, e.offset, read);
    set(node, "polycoef", std::array{offset, e.ratio, 0.0, 0.0, 0.0});
  }

  /// MuJoCo counts both tendons from their lengths at the start.
  void write_tendon(const EqualityConstraint& e) {
    pugi::xml_node node = add("tendon", e, e.name);
    const Tendon& b = writer_.model.tendons()[e.tendon_b.index()];
    set(node, "tendon1", b.name);
    std::array<double, 5> c = e.polynomial;
    if (e.tendon_a.is_valid()) {
      const Tendon& a = writer_.model.tendons()[e.tendon_a.index()];
      set(node, "tendon2", a.name);
      shift(beyond_rounding(length_at_start(writer_, a), e.reference_a), c);
    }
    c[0] -= beyond_rounding(length_at_start(writer_, b), e.reference_b);
    set(node, "polycoef", c);
  }

  /// a - b, or 0 where that is rounding.
  static double beyond_rounding(double a, double b) { return std::abs(a - b) < 1e-12 * (1 + std::abs(a)) ? 0 : a - b; }

  /// The polynomial of x + d.
  static void shift(double d, std::array<double, 5>& c) {
    for (std::size_t i = 0; i + 1 < c.size(); ++i) {
      for (std::size_t k = c.size() - 1; k-- > i;) c[k] += d * c[k + 1];
    }
  }

  MjcfWriter& writer_;
  pugi::xml_node section_;
};

bool is_written(const MjcfWriter& writer, const EqualityConstraint& e) {
  const auto has_name = [&](JointId id) { return !id.is_valid() || !writer.model.joint(id).name.empty(); };
  const auto has_body = [&](LinkId id) { return !id.is_valid() || writer.carried_by[id.index()].is_valid(); };
  return has_name(e.joint_a) && has_name(e.joint_b) && has_body(e.link_a) && has_body(e.link_b);
}

/// Poses of mocap bodies, in the order in which these are written: that of their joints.
void write_mocap(const MjcfWriter& writer, pugi::xml_node node, const std::vector<double>& poses) {
  std::vector<double> positions, turns;
  for (const Joint& joint : writer.model.joints()) {
    if (joint.type != JointType::kMocap || joint.name.empty()) continue;
    const double* const pose = &poses[7 * writer.model.mocap_index(writer.model.link(joint.child).name)];
    positions.insert(positions.end(), pose, pose + 3);
    const std::array<double, 4> turn = wxyz({pose[3], pose[4], pose[5], pose[6]});
    turns.insert(turns.end(), turn.begin(), turn.end());
  }
  set(node, "mpos", positions);
  set(node, "mquat", turns);
}

/// q and v as MuJoCo's qpos and qvel, joint by joint in the order of q.
void write_key(MjcfWriter& writer, pugi::xml_node section, const Keyframe& key) {
  pugi::xml_node node = section.append_child("key");
  set(node, "name", writer.names.claim("key", key.name, "key", writer.notes));
  set_unless(node, "time", key.time, 0);
  std::vector<double> qpos = key.q, qvel = key.v;
  for (const Body& body : writer.model.bodies()) {
    const bool is_free = body.type == JointType::kFloating;
    if (!is_free && body.type != JointType::kSpherical) continue;
    double* const r = &qpos[static_cast<std::size_t>(body.iq + (is_free ? 3 : 0))];
    double* const w = &qvel[static_cast<std::size_t>(body.iv)];
    const Quat<double> q = at_unit_length(Quat<double>{r[0], r[1], r[2], r[3]});
    std::ranges::copy(wxyz(q), r);
    const Mat3<double> R = to_matrix(q);
    const Vec3<double> turning = vector_for(R, {w[0], w[1], w[2]});
    if (!is_free) {
      std::ranges::copy(std::array{turning.x, turning.y, turning.z}, w);
    } else {
      std::ranges::copy(std::array{w[3], w[4], w[5], turning.x, turning.y, turning.z}, w);
    }
  }
  set(node, "qpos", qpos);
  if (std::ranges::any_of(qvel, [](double x) { return x != 0; })) set(node, "qvel", qvel);
  if (std::ranges::any_of(key.ctrl, [](double x) { return x != 0; })) set(node, "ctrl", key.ctrl);
  if (std::ranges::any_of(key.act, [](double x) { return x != 0; })) set(node, "act", key.act);
  if (key.mocap != writer.model.initial_mocap()) write_mocap(writer, node, key.mocap);
}

}  // namespace

void write_equalities(MjcfWriter& writer) {
  if (writer.model.equalities().empty()) return;
  EqualityWriter equalities(writer, writer.root.append_child("equality"));
  for (const EqualityConstraint& equality : writer.model.equalities()) {
    if (is_written(writer, equality)) equalities.write(equality);
  }
}

void write_keyframes(MjcfWriter& writer) {
  if (writer.model.keyframes().empty()) return;
  pugi::xml_node section = writer.root.append_child("keyframe");
  for (const Keyframe& key : writer.model.keyframes()) write_key(writer, section, key);
}

}  // namespace manyhands::io
