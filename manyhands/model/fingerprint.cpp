#include "manyhands/model/fingerprint.h"

#include "manyhands/base/hash.h"

namespace manyhands {

namespace {

class Fingerprint {
 public:
  template <class Number>
    requires std::is_arithmetic_v<Number>
  void add(Number number) {
    hash_.add(static_cast<Number>(number + Number(0)));  // -0 and 0 are one number
  }
  template <class Enum>
    requires std::is_enum_v<Enum>
  void add(Enum value) {
    hash_.add(static_cast<int>(value));
  }
  template <class Number>
  void add(const std::optional<Number>& number) {
    hash_.add(number.has_value());
    if (number) add(*number);
  }
  template <class... Values>
    requires(sizeof...(Values) > 1)
  void add(const Values&... values) {
    (add(values), ...);
  }
  void add(const std::string& text) {
    for (const char c : text) hash_.add(c);
    hash_.add('\0');
  }
  template <class R>
  void add(const Vec3<R>& a) {
    add(a.x, a.y, a.z);
  }
  void add(const SymMat3<double>& m) { add(m.xx, m.yy, m.zz, m.xy, m.xz, m.yz); }
  void add(const Transform<double>& X) { add(X.R.x, X.R.y, X.R.z, X.p); }
  void add(const SurfaceMaterial& surface) {
    std::apply([this](const auto&... fields) { add(fields...); }, surface.fields());
    add_given(surface.compliance);
  }
  /// Nothing of what holds exactly.
  void add_given(const std::optional<Compliance>& compliance) {
    if (compliance) std::apply([this](const auto&... fields) { add(fields...); }, compliance->fields());
  }
  void add(const Link& link) {
    add(link.name, link.inertial.mass, link.inertial.com, link.inertial.inertia, link.parent.value(), link.body.value(),
        link.gravity_compensation);
    if (link.body.value() != 0) add(link.X_BL);
  }
  void add(const Joint& joint) {
    add(joint.name, joint.type, joint.parent.value(), joint.child.value(), joint.X_PF, joint.axis, joint.iq, joint.iv);
    add(joint.limits.lower, joint.limits.upper, joint.damping, joint.friction, joint.armature, joint.stiffness);
    add_given(joint.limits.compliance);
  }
  void add(const Geom& geom) {
    add(geom.name, geom.link.value(), geom.X_LG, geom.shape.type, geom.shape.size, geom.shape.mesh.value());
    add(geom.shape.height_field.value(), geom.surface, geom.filter.group, geom.filter.mask, geom.margin);
  }
  void add(const Mesh& mesh) {
    for (const Vec3<float>& vertex : mesh.vertices) add(vertex);
    for (const std::array<int, 3>& triangle : mesh.triangles) add(triangle[0], triangle[1], triangle[2]);
  }
  void add(const HeightField& field) {
    add(field.columns, field.rows, field.dx, field.dy);
    for (const double height : field.height) add(height);
  }
  void add(const Tendon& t) {
    add(t.name, t.lower, t.upper, t.damping, t.friction, t.armature, t.stiffness, t.spring_lower, t.spring_upper);
    for (const TendonJoint& part : t.joints) add(part.joint.value(), part.coefficient);
    for (const TendonBranch& branch : t.branches) {
      add(branch.divisor, branch.points.size());
      for (const TendonPoint& point : branch.points) add(point.link.value(), point.p_L);
    }
    add_given(t.compliance);
  }
  void add(const EqualityConstraint& e) {
    add(e.name, e.type, e.link_a.value(), e.link_b.value(), e.X_LA, e.X_LB, e.joint_a.value(), e.joint_b.value());
    add(e.ratio, e.offset, e.max_force);
    add_given(e.compliance);
    if (e.compliance && e.torque_scale != 1) add(e.torque_scale);
    if (e.type != EqualityType::kTendon) return;
    add(e.tendon_a.value(), e.tendon_b.value(), e.reference_a, e.reference_b);
    for (const double coefficient : e.polynomial) add(coefficient);
  }
  void add(const Actuator& a) {
    add(a.name, a.type, a.joint.value(), a.gear, a.kp, a.kd, a.min_ctrl, a.max_ctrl, a.max_force);
    if (a.tendon.is_valid()) add(a.tendon.value());
    if (a.ctrl_scale != 1 || a.ctrl_offset != 0) add(a.ctrl_scale, a.ctrl_offset);
    if (a.type == ActuatorType::kAffine) add(a.gain[0], a.gain[1], a.gain[2], a.bias[0], a.bias[1], a.bias[2]);
    if (a.least_force() != -a.max_force) add(a.least_force());
    if (a.has_activation()) add(a.activation);
    if (a.site) add(*a.site);
  }
  void add(const Activation& a) { add(a.type, a.time_constant, a.lower, a.upper, a.early); }
  void add(const ActuatorSite& site) {
    add(site.link.value(), site.X_LS, site.reference.value(), site.X_LR, site.force, site.torque);
  }
  void add(const ContactExclusion& exclusion) { add(exclusion.a.value(), exclusion.b.value()); }
  void add(const ContactPair& pair) { add(pair.a.value(), pair.b.value(), pair.surface); }
  template <class Item>
  void add(std::span<const Item> items) {
    hash_.add(items.size());
    for (const Item& item : items) add(item);
  }

  [[nodiscard]] std::uint64_t value() const { return hash_.value(); }

 private:
  Hash hash_;
};

}  // namespace

std::uint64_t fingerprint(const Model& model) {
  Fingerprint sum;
  sum.add(model.links());
  sum.add(model.joints());
  for (const Geom& geom : model.geoms()) {
    if (geom.role == GeomRole::kCollision) sum.add(model.link(geom.link).X_BL, geom);
  }
  for (const Geom& geom : model.geoms()) {
    const bool has_mesh = geom.role == GeomRole::kCollision && geom.shape.mesh.is_valid();
    if (has_mesh) sum.add(model.meshes()[geom.shape.mesh.index()]);
  }
  sum.add(model.height_fields());
  if (!model.tendons().empty()) sum.add(model.tendons());
  sum.add(model.equalities());
  sum.add(model.actuators());
  sum.add(model.exclusions());
  sum.add(model.contact_pairs());
  const ContactRules& rules = model.contact_rules();
  sum.add(rules.friction, rules.restitution, rules.self_collision, rules.contacts);
  sum.add(model.gravity());
  if (model.medium().drags()) sum.add(model.medium().density, model.medium().viscosity, model.medium().wind);
  for (const double q : model.initial_configuration()) sum.add(q);
  const std::vector<double> reference = model.spring_reference();
  for (const Joint& joint : model.joints()) {
    const auto first = static_cast<std::size_t>(std::max(joint.iq, 0));
    for (std::size_t i = 0; joint.stiffness > 0 && i < static_cast<std::size_t>(configuration_size(joint.type)); ++i) {
      sum.add(reference[first + i]);
    }
  }
  return sum.value();
}

}  // namespace manyhands
