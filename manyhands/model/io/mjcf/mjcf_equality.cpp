// <equality>: connect, weld, joint and tendon as equalities.
#include <algorithm>

#include "manyhands/model/io/mjcf/mjcf_compliance.h"
#include "manyhands/model/io/mjcf/mjcf_scene.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace {

void read_sites(const MjcfScene& scene, const MjcfElement& e, EqualityConstraint& equality) {
  const MjcfSite &a = scene.site(e, "site1"), &b = scene.site(e, "site2");
  equality.link_a = a.link;
  equality.link_b = b.link;
  equality.X_LA = a.X_LS;
  equality.X_LB = b.X_LS;
}

const MjcfBody& second_body(const MjcfScene& scene, const MjcfElement& e) {
  return e.has("body2") ? scene.body(e, "body2") : scene.bodies[0];
}

void read_connect(const MjcfScene& scene, const MjcfElement& e, EqualityConstraint& equality) {
  equality.type = EqualityType::kPoint;
  if (e.has("site1")) return read_sites(scene, e, equality);
  if (!e.has("anchor")) e.fail("attribute 'anchor' of <connect> is missing");
  const MjcfBody &a = scene.body(e, "body1"), &b = second_body(scene, e);
  equality.link_a = a.link;
  equality.link_b = b.link;
  // The point is given on the first body; on the second it is where the file's poses put it.
  equality.X_LA.p = e.vec3_or("anchor", Vec3<double>::zero());
  equality.X_LB.p = inverse(b.X_WB) * (a.X_WB * equality.X_LA.p);
}

void read_weld(const MjcfScene& scene, const MjcfElement& e, EqualityConstraint& equality) {
  equality.type = EqualityType::kFixed;
  if (e.has("site1")) return read_sites(scene, e, equality);
  const MjcfBody &a = scene.body(e, "body1"), &b = second_body(scene, e);
  equality.link_a = a.link;
  equality.link_b = b.link;
  Transform<double> X_AB = placed_in(inverse(a.X_WB), b.X_WB);
  if (e.has("relpose")) {
    const std::vector<double> v = e.numbers("relpose", 7, 7);
    const bool has_quaternion = v[3] != 0 || v[4] != 0 || v[5] != 0 || v[6] != 0;  // else the file's poses count
    if (has_quaternion) X_AB = {to_matrix(quat_from_wxyz(e, &v[3])), {v[0], v[1], v[2]}};
  }
  equality.X_LB.p = e.vec3_or("anchor", Vec3<double>::zero());
  equality.X_LA = X_AB * equality.X_LB;
}

/// q1 - q1_0 = a0 + a1 (q2 - q2_0) + ...; false if it cannot be an equality constraint, which is noted.
bool read_coupled_joints(const MjcfScene& scene, const MjcfElement& e, EqualityConstraint& equality) {
  equality.type = EqualityType::kJoint;
  const MjcfJoint& driven = scene.joint(e, "joint1");
  if (!e.has("joint2")) {
    e.note_serious(LoadAction::kIgnored, "a joint held at one place is not read; give it a range instead");
    return false;
  }
  const MjcfJoint& driver = scene.joint(e, "joint2");
  for (const MjcfJoint* joint : {&driven, &driver}) {
    const JointType type = scene.builder.joints()[joint->id.index()].type;
    if (velocity_size(type) != 1) e.fail("joint " + in_quotes(joint->name) + " is no hinge or slide");
  }
  std::vector<double> c = e.has("polycoef") ? e.numbers("polycoef", 1, 5) : std::vector<double>{};
  constexpr std::array<double, 5> kDefaults{0, 1, 0, 0, 0};
  for (std::size_t i = c.size(); i < kDefaults.size(); ++i) c.push_back(kDefaults[i]);
  if (c[2] != 0 || c[3] != 0 || c[4] != 0) {
    e.note_serious(LoadAction::kRepaired, "the quadratic to quartic coefficients are not used; the linear ones are");
  }
  equality.joint_a = driver.id;
  equality.joint_b = driven.id;
  equality.ratio = c[1];
  equality.offset = driven.reference + c[0] - c[1] * driver.reference;
  return true;
}

/// length1 - length1_0 = a0 + a1 (length2 - length2_0) + ...; false if a tendon was left out, which is noted.
bool read_coupled_tendons(const MjcfScene& scene, const MjcfElement& e, EqualityConstraint& equality) {
  equality.type = EqualityType::kTendon;
  const MjcfTendon& driven = scene.tendon(e, "tendon1");
  const MjcfTendon* const driver = e.has("tendon2") ? &scene.tendon(e, "tendon2") : nullptr;
  if (!driven.id || (driver != nullptr && !driver->id)) {
    e.note_serious(LoadAction::kIgnored, "a tendon of it was left out, and so is it");
    return false;
  }
  const std::vector<double> c = e.numbers("polycoef", 1, 5);
  std::ranges::copy(c, equality.polynomial.begin());
  equality.tendon_b = *driven.id;
  equality.reference_b = driven.length;
  if (driver == nullptr) {
    equality.polynomial = {equality.polynomial[0], 0, 0, 0, 0};
    return true;
  }
  equality.tendon_a = *driver->id;
  equality.reference_a = driver->length;
  return true;
}

void read_equality(MjcfScene& scene, const MjcfElement& element) {
  const std::string kind(element.tag());
  if (kind != "connect" && kind != "weld" && kind != "joint" && kind != "tendon") return;
  const std::string given = element.text_or("name", "");
  const std::string name = given.empty() ? kind + "_" + std::to_string(scene.num_equalities) : given;
  ++scene.num_equalities;
  const MjcfElement e = element.named("equality " + in_quotes(name)).with_defaults(scene.classes, "equality");
  e.expect({"name", "class", "active", "body1", "body2", "anchor", "site1", "site2", "relpose", "torquescale", "joint1",
            "joint2", "tendon1", "tendon2", "polycoef", "solref", "solimp"});
  if (!e.boolean_or("active", true)) {
    e.note(LoadAction::kIgnored, "it is not active, and left out");
    return;
  }
  EqualityConstraint equality{.name = name};
  if (kind == "connect") read_connect(scene, e, equality);
  if (kind == "weld") read_weld(scene, e, equality);
  if (kind == "joint" && !read_coupled_joints(scene, e, equality)) return;
  if (kind == "tendon" && !read_coupled_tendons(scene, e, equality)) return;
  equality.compliance = read_compliance(e, scene.compliance, "solref", "solimp");
  if (kind == "weld" && equality.compliance) {
    equality.torque_scale = e.number_or("torquescale", 1);
  } else {
    e.ignore({"torquescale"});
  }
  checked(e, [&] { scene.builder.add_equality(equality); });
}

}  // namespace

void read_equalities(MjcfScene& scene) {
  if (!scene.settings.flags.equality) return;
  for (const MjcfElement& section : scene.sections("equality")) {
    section.named("equality").expect({}, {"connect", "weld", "joint", "tendon"});
    for (const MjcfElement& element : scene.elements(section)) read_equality(scene, element);
  }
}

}  // namespace manyhands::io
