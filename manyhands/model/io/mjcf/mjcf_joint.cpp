// <joint> and <freejoint>: the links and joints that carry a body.
#include <algorithm>
#include <cmath>

#include "manyhands/model/io/mjcf/mjcf_compliance.h"
#include "manyhands/model/io/mjcf/mjcf_scene.h"
#include "manyhands/model/io/text_numbers.h"
#include "manyhands/model/unit.h"

namespace manyhands::io {

double linear_part(const MjcfElement& e, const char* attribute) {
  if (!e.has(attribute)) return 0;
  const std::vector<double> values = e.numbers(attribute, 1, 3);
  if (std::ranges::any_of(values.begin() + 1, values.end(), [](double x) { return x != 0; })) {
    e.note_serious(LoadAction::kIgnored, std::string("the nonlinear part of '") + attribute + "' is not used");
  }
  if (values[0] >= 0) return values[0];
  e.note_serious(LoadAction::kRepaired,
                 std::string(attribute) + " " + format_number(values[0]) + " is negative; 0 taken");
  return 0;
}

namespace {

struct Read {
  Joint joint;
  Vec3<double> anchor{};  ///< in the body frame
  double reference = 0;
  std::array<double, 2> spring_damper{};  ///< see MjcfJoint
};

JointType type_of(const MjcfElement& e) {
  // Bullet has a type of its own, which leaves the body where it is.
  if (e.source().is_bullet() && e.text_or("type", "") == "fixed") return JointType::kFixed;
  const std::string word = e.word_or("type", {"hinge", "slide", "ball", "free"}, "hinge");
  return word == "hinge"   ? JointType::kRevolute
         : word == "slide" ? JointType::kPrismatic
         : word == "ball"  ? JointType::kSpherical
                           : JointType::kFloating;
}

void read_range(const MjcfScene& scene, const MjcfElement& e, Joint& joint) {
  const MjcfSettings& settings = scene.settings_of(e);
  const std::vector<double> range = e.has("range") ? e.numbers("range", 2, 2) : std::vector<double>{0, 0};
  const std::string limited = e.word_or("limited", {"true", "false", "auto"}, "auto");
  if (limited == "auto" && e.has("range") && !settings.autolimits) {
    e.fail("it has 'range' but not 'limited', and autolimits is false; expected limited=\"true\" or \"false\"");
  }
  const bool is_limited = limited == "true" || (limited == "auto" && e.has("range") && range[0] != range[1]);
  if (!is_limited) {
    if (joint.type == JointType::kRevolute) joint.type = JointType::kContinuous;
    return;
  }
  if (joint.type == JointType::kSpherical || joint.type == JointType::kFloating) {
    e.note_serious(LoadAction::kIgnored, "the range of a ball or free joint is not used");
    return;
  }
  if (!(range[0] < range[1])) {
    e.fail("its range is " + format_number(range[0]) + " to " + format_number(range[1]) +
           "; expected the lower limit first");
  }
  const double unit = joint.type == JointType::kRevolute ? settings.radians(1) : 1;
  if (range[0] > -kMjcfUnlimited) joint.limits.lower = unit * range[0];
  if (range[1] < kMjcfUnlimited) joint.limits.upper = unit * range[1];
  joint.limits.compliance = read_compliance(e, scene.compliance, "solreflimit", "solimplimit");
}

void read_effort(const MjcfElement& e, Joint& joint) {
  if (!e.has("actuatorfrcrange") || e.text_or("actuatorfrclimited", "auto") == "false") return;
  const std::vector<double> range = e.numbers("actuatorfrcrange", 2, 2);
  joint.limits.effort = std::max(std::abs(range[0]), std::abs(range[1]));
  if (range[0] != -range[1]) {
    e.note(LoadAction::kRepaired, "'actuatorfrcrange' is not symmetric; an effort of " +
                                      format_number(joint.limits.effort) + " both ways taken");
  }
}

Read read_joint(const MjcfScene& scene, const MjcfElement& e, const Transform<double>& X_BF) {
  Read result;
  Joint& joint = result.joint;
  if (e.tag() == "freejoint") {
    e.expect({"name", "align", "group"});
    joint.type = JointType::kFloating;
    return result;
  }
  e.expect({"name",
            "class",
            "type",
            "pos",
            "axis",
            "range",
            "limited",
            "ref",
            "damping",
            "armature",
            "frictionloss",
            "solreflimit",
            "solimplimit",
            "actuatorfrcrange",
            "actuatorfrclimited",
            "stiffness",
            "springref",
            "springdamper",
            "align",
            "group"});
  e.ignore({"solreffriction", "solimpfriction", "margin", "actuatorgravcomp", "user"});
  joint.type = type_of(e);
  if (joint.type == JointType::kFixed) return result;
  joint.stiffness = linear_part(e, "stiffness");
  if (e.has("springdamper")) {
    const std::vector<double> pair = e.numbers("springdamper", 2, 2);
    result.spring_damper = {pair[0], pair[1]};
  }
  joint.damping = linear_part(e, "damping");
  joint.friction = linear_part(e, "frictionloss");
  joint.armature = e.positive_or("armature", 0);
  read_range(scene, e, joint);
  read_effort(e, joint);
  if (joint.type == JointType::kFloating) return result;
  result.anchor = X_BF * e.vec3_or("pos", Vec3<double>::zero());
  if (joint.type == JointType::kSpherical) return result;
  const Vec3<double> axis = e.vec3_or("axis", {0, 0, 1});
  if (!(norm(axis) > 1e-10)) e.fail("its axis is 0; expected a direction such as \"0 0 1\"");
  joint.axis = X_BF.R * at_unit_length(axis);
  const double unit = joint.type == JointType::kPrismatic ? 1 : scene.settings_of(e).radians(1);
  result.reference = e.source().is_bullet() ? 0 : unit * e.number_or("ref", 0);
  joint.spring_reference = {unit * e.number_or("springref", 0)};
  return result;
}

/// A name for a part that MuJoCo does not have.
template <class Part>
std::string unused_name(const MjcfScene& scene, const std::vector<Part>& parts, std::string name) {
  const auto is_this = [&](const Part& part) { return part.name == name; };
  while (scene.reserved.contains(name) || std::ranges::any_of(parts, is_this)) name += '_';
  return name;
}

}  // namespace

Transform<double> joint_frame(const Transform<double>& X_PB, const Vec3<double>& anchor, const Joint& joint,
                              double reference) {
  const Transform<double> X_PF = X_PB * Transform<double>{Mat3<double>::identity(), anchor};
  const Vec3<double> back = -reference * joint.axis;
  if (joint.type == JointType::kPrismatic) return {X_PF.R, X_PF * back};
  return {X_PF.R * to_matrix(quat_from_rotation_vector(back)), X_PF.p};
}

namespace {

/// Bullet's name for a link that the file gives none.
std::string bullets_name(MjcfBulletCounts& counts) {
  return "link" + std::to_string(counts.bodies - 1) + "_" + std::to_string(counts.links++);
}

LinkId add_joint(MjcfScene& scene, Joint joint, LinkId parent, const std::string& link) {
  joint.parent = parent;
  joint.child = scene.builder.add_link(link);
  const LinkId child = joint.child;
  scene.builder.add_joint(std::move(joint));
  return child;
}

}  // namespace

LinkId add_bullets_base(MjcfScene& scene, std::string name, const Transform<double>& X_WB, bool is_free) {
  while (std::ranges::any_of(scene.builder.links(), [&](const Link& link) { return link.name == name; })) name += '_';
  Joint joint{.name = unused_name(scene, scene.builder.joints(), name + "_base"), .type = JointType::kFixed};
  if (is_free) {
    const Quat<double> r = to_quat(X_WB.R);
    joint.type = JointType::kFloating;
    joint.initial = {X_WB.p.x, X_WB.p.y, X_WB.p.z, r.x, r.y, r.z, r.w};
  } else {
    joint.X_PF = X_WB;
  }
  return add_joint(scene, std::move(joint), scene.builder.world(), name);
}

// Bullet makes a link without mass of every joint, and fixes the body to the last of them, at the place that it has
// from the first. What joints move in the world stands on a base without mass, and what none do is free.
LinkId add_bullets_joints(MjcfScene& scene, MjcfBody& body, LinkId parent, const Transform<double>& X_PB,
                          const std::vector<MjcfPlaced>& joints) {
  MjcfBulletCounts& counts = scene.bullet_counts;
  const bool on_world = body.parent == 0;
  if (on_world) counts = {.bodies = counts.bodies + 1, .fixed = counts.fixed};
  body.bullet_number = counts.links;
  const std::string unnamed = bullets_name(counts), own = body.source->has_own("name") ? body.name : unnamed;
  const auto is_free = [&](const MjcfPlaced& joint) {
    return joint.element.tag() == "freejoint" ||
           joint.element.with_defaults(scene.classes, "joint").text_or("type", "") == "free";
  };
  if (on_world && std::ranges::all_of(joints, is_free)) return add_bullets_base(scene, own, X_PB, true);
  LinkId carrier =
      on_world ? add_bullets_base(scene, bullets_name(counts), Transform<double>::identity(), false) : parent;
  Transform<double> X_CB = X_PB, X_LB = X_PB;  // the body in the last link made, and where it is fixed to that
  int number = scene.bodies[static_cast<std::size_t>(body.parent)].bullet_number;
  for (const MjcfPlaced& placed : joints) {
    const std::string name =
        claim_name(scene.joint_names, placed.element, "joint", scene.joints.size(), scene.reserved);
    const MjcfElement element = placed.element.named("joint '" + name + "'").with_defaults(scene.classes, "joint");
    Read read = read_joint(scene, element, placed.X_BF);
    if (read.joint.type == JointType::kFloating) element.fail("a free joint is the only one of a body in <worldbody>");
    read.joint.X_PF = X_CB * Transform<double>{Mat3<double>::identity(), read.anchor};
    read.joint.name = name;
    number = counts.links;
    carrier = checked(element, [&] { return add_joint(scene, read.joint, carrier, bullets_name(counts)); });
    X_CB = {Mat3<double>::identity(), -read.anchor};
    if (&placed == &joints.front()) X_LB = X_CB;
  }
  body.bullet_carrier = number;
  // It is named once all that hangs on the body has been read.
  return add_joint(scene, {.name = "fixed to " + own, .type = JointType::kFixed, .X_PF = X_LB}, carrier, own);
}

void name_bullets_joint(MjcfScene& scene, const MjcfBody& body) {
  if (body.bullet_carrier < 0) return;
  const JointId id = scene.builder.link(body.link).joint;
  scene.builder.joint(id).name =
      "jointfix_" + std::to_string(scene.bullet_counts.fixed++) + "_" + std::to_string(body.bullet_carrier);
}

// MuJoCo lets joints of one body act in turn, each about its own anchor. Here each gets a link whose frame is the
// joint's; the body's own link is the last of them, or is fixed to it where the anchor is not the body's origin.
LinkId add_joints(MjcfScene& scene, MjcfBody& body, LinkId parent, const Transform<double>& X_PB,
                  const std::vector<MjcfPlaced>& joints) {
  if (scene.root.source().is_bullet()) return add_bullets_joints(scene, body, parent, X_PB, joints);
  ModelBuilder& builder = scene.builder;
  const auto fixed = [&](LinkId to, const Transform<double>& X) {
    const LinkId link = builder.add_link(body.name);
    builder.add_joint({.name = unused_name(scene, builder.joints(), body.name + (body.is_mocap ? "_mocap" : "_fixed")),
                       .type = body.is_mocap ? JointType::kMocap : JointType::kFixed,
                       .parent = to,
                       .child = link,
                       .X_PF = X});
    return link;
  };
  if (joints.empty()) return fixed(parent, X_PB);
  LinkId carrier = parent;
  Transform<double> X_CB = X_PB;  // the body, as the file places it, in the carrier's frame at the joints' references
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::string name =
        claim_name(scene.joint_names, joints[i].element, "joint", scene.joints.size(), scene.reserved);
    const MjcfElement element = joints[i].element.named("joint '" + name + "'").with_defaults(scene.classes, "joint");
    Read read = read_joint(scene, element, joints[i].X_BF);
    if (read.joint.type == JointType::kFloating) {
      if (body.parent != 0) element.fail("a free joint belongs to a body in <worldbody>, not to one inside another");
      if (joints.size() > 1) element.fail("a free joint must be the only joint of its body");
      const Quat<double> r = to_quat(X_CB.R);
      const Vec3<double>& p = X_CB.p;
      read.joint.initial = read.joint.spring_reference = {p.x, p.y, p.z, r.x, r.y, r.z, r.w};
    } else {
      read.joint.X_PF = joint_frame(X_CB, read.anchor, read.joint, read.reference);
      if (read.reference != 0) read.joint.initial = {read.reference};
    }
    const bool ends_in_body = i + 1 == joints.size() && squared_norm(read.anchor) == 0;
    const LinkId link =
        builder.add_link(ends_in_body ? body.name : unused_name(scene, builder.links(), body.name + "_" + name));
    read.joint.name = name;
    read.joint.parent = carrier;
    read.joint.child = link;
    const JointId id = checked(element, [&] { return builder.add_joint(read.joint); });
    scene.joints.push_back({name, id, read.reference, static_cast<int>(scene.bodies.size()), body.X_WB * read.anchor,
                            body.X_WB.R * read.joint.axis, read.spring_damper});
    carrier = link;
    X_CB = {Mat3<double>::identity(), -read.anchor};
    if (ends_in_body) return link;
  }
  return fixed(carrier, X_CB);
}

}  // namespace manyhands::io
