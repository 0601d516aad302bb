// <tendon>: fixed tendons over joints, and spatial ones through sites.
#include "manyhands/model/io/mjcf/mjcf_compliance.h"
#include "manyhands/model/io/mjcf/mjcf_scene.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace {

/// Lengths of a tendon: at qpos0, and where all joints' springs are at rest (MuJoCo's qpos_spring).
struct Lengths {
  double start = 0, rest = 0;
};

/// Where the joint has its child in F while its spring is at rest.
Transform<double> at_rest(const Joint& joint) {
  const std::vector<double>& q = joint.spring_reference;
  const Mat3<double> unturned = Mat3<double>::identity();
  if (q.empty()) return {unturned, Vec3<double>::zero()};
  switch (joint.type) {
    case JointType::kRevolute:
    case JointType::kContinuous:
      return {to_matrix(quat_from_rotation_vector(q[0] * joint.axis)), Vec3<double>::zero()};
    case JointType::kPrismatic:
      return {unturned, q[0] * joint.axis};
    case JointType::kSpherical:
      return {to_matrix(Quat<double>{q[0], q[1], q[2], q[3]}), Vec3<double>::zero()};
    default:
      return {to_matrix(Quat<double>{q[3], q[4], q[5], q[6]}), {q[0], q[1], q[2]}};
  }
}

/// The poses of all links in that configuration.
std::vector<Transform<double>> poses_at_rest(const ModelBuilder& builder) {
  std::vector<Transform<double>> poses;
  for (const Link& link : builder.links()) {
    if (!link.joint.is_valid()) {
      poses.push_back(link.X_BL);
      continue;
    }
    const Joint& joint = builder.joints()[link.joint.index()];
    poses.push_back(poses[joint.parent.index()] * joint.X_PF * at_rest(joint));
  }
  return poses;
}

/// The coefficients of joints, and what they add up to.
Lengths read_joints(const MjcfScene& scene, const MjcfElement& e, Tendon& tendon) {
  Lengths lengths;
  for (const MjcfElement& child : e.children("joint")) {
    const MjcfElement part = child.named(e.what() + ", joint");
    part.expect({"joint", "coef"});
    const MjcfJoint& read = scene.joint(part, "joint");
    const Joint& joint = scene.builder.joints()[read.id.index()];
    if (velocity_size(joint.type) != 1)
      part.fail("joint " + in_quotes(read.name) + " is no hinge or slide; expected one");
    const double coefficient = part.number_or("coef", 1);
    lengths.start += coefficient * read.reference;
    lengths.rest += coefficient * joint.spring_reference[0];
    if (coefficient != 0) tendon.joints.push_back({.joint = read.id, .coefficient = coefficient});
  }
  return lengths;
}

/// The way through sites; nothing, with a note, if it wraps around something.
std::optional<Lengths> read_path(const MjcfScene& scene, const MjcfElement& e, Tendon& tendon) {
  const std::vector<Transform<double>> resting = poses_at_rest(scene.builder);
  Lengths lengths;
  Vec3<double> last_start{}, last_rest{};
  tendon.branches.emplace_back();
  for (const MjcfElement& child : e.children()) {
    const MjcfElement part = child.named(e.what() + ", " + std::string(child.tag()));
    if (child.tag() == "geom") {
      e.note_serious(LoadAction::kIgnored, "it wraps around a geom, which is not read; it is left out");
      return std::nullopt;
    }
    if (child.tag() == "pulley") {
      part.expect({"divisor"});
      if (tendon.branches.back().points.empty()) tendon.branches.pop_back();
      tendon.branches.push_back({.divisor = part.number_or("divisor", 0)});
      continue;
    }
    part.expect({"site"});
    const MjcfSite& site = scene.site(part, "site");
    const auto is_its = [&](const MjcfBody& body) { return body.link == site.link; };
    const Vec3<double> start = std::ranges::find_if(scene.bodies, is_its)->X_WB * site.X_LS.p;
    const Vec3<double> rest = resting[site.link.index()] * site.X_LS.p;
    TendonBranch& branch = tendon.branches.back();
    if (!branch.points.empty()) {
      lengths.start += norm(start - last_start) / branch.divisor;
      lengths.rest += norm(rest - last_rest) / branch.divisor;
    }
    last_start = start;
    last_rest = rest;
    branch.points.push_back({.link = site.link, .p_L = site.X_LS.p});
  }
  return lengths;
}

/// Where the spring rests: at one length or between two; -1 is the length at qpos_spring.
void read_spring(const MjcfElement& e, double length, Tendon& tendon) {
  std::vector<double> rest = e.numbers("springlength", 1, 2);
  if (rest.empty()) rest = {-1};
  if (rest.size() == 1) rest.push_back(rest[0]);
  if (rest[0] == -1 && rest[1] == -1) rest = {length, length};
  tendon.spring_lower = rest[0];
  tendon.spring_upper = rest[1];
  tendon.stiffness = linear_part(e, "stiffness");
}

void read_tendon(MjcfScene& scene, const MjcfElement& element, const std::string& name) {
  const MjcfElement e = element.named("tendon " + in_quotes(name)).with_defaults(scene.classes, "tendon");
  e.expect({"name",
            "class",
            "group",
            "limited",
            "range",
            "margin",
            "solreflimit",
            "solimplimit",
            "solreffriction",
            "solimpfriction",
            "frictionloss",
            "damping",
            "stiffness",
            "springlength",
            "armature",
            "width",
            "material",
            "rgba",
            "actuatorfrclimited",
            "actuatorfrcrange"},
           {"joint", "site", "geom", "pulley"});
  e.ignore({"margin", "solreffriction", "solimpfriction"});
  if (e.has("actuatorfrcrange"))
    e.note_serious(LoadAction::kIgnored, "the bound 'actuatorfrcrange' of its actuators is not used");
  Tendon tendon{.name = name};
  const bool is_fixed = e.tag() == "fixed";
  const std::optional<Lengths> lengths = is_fixed ? read_joints(scene, e, tendon) : read_path(scene, e, tendon);
  MjcfTendon& read = scene.tendons.emplace_back(MjcfTendon{.name = name});
  if (!lengths) return;
  if (tendon.joints.empty() && tendon.branches.empty()) {
    e.note(LoadAction::kIgnored, "nothing moves it; it is left out");
    return;
  }
  read.length = lengths->start;
  read_spring(e, lengths->rest, tendon);
  tendon.damping = linear_part(e, "damping");
  tendon.armature = e.positive_or("armature", 0);
  tendon.friction = linear_part(e, "frictionloss");
  if (is_limited(scene, e, "range", "limited")) {
    const std::vector<double> range = e.numbers("range", 2, 2);
    if (range[0] > -kMjcfUnlimited) tendon.lower = range[0];
    if (range[1] < kMjcfUnlimited) tendon.upper = range[1];
    tendon.compliance = read_compliance(e, scene.compliance, "solreflimit", "solimplimit");
  }
  read.id = checked(e, [&] { return scene.builder.add_tendon(tendon); });
}

}  // namespace

void read_tendons(MjcfScene& scene) {
  for (const MjcfElement& section : scene.sections("tendon")) {
    section.named("tendon").expect({}, {"fixed", "spatial"});
    for (const MjcfElement& element : scene.elements(section)) {
      if (element.tag() != "fixed" && element.tag() != "spatial") continue;
      const std::string name =
          claim_name(scene.tendon_names, element.named("tendon"), "tendon", scene.tendons.size(), scene.reserved);
      read_tendon(scene, element, name);
    }
  }
}

}  // namespace manyhands::io
