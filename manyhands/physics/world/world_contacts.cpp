// World: contacts, net forces and reactions of the last step.
#include <algorithm>

#include "manyhands/physics/world/contact_forces.h"
#include "manyhands/physics/world/contact_residuals.h"
#include "manyhands/physics/world/sensor_reading.h"
#include "manyhands/physics/world/world_impl.h"

namespace manyhands {

namespace {

Contact report_of(const WorldCore& core, const ContactPatch<double>& patch, const ContactPoint<double>& point,
                  const Vec3<double>& y, double inverse_h) {
  const Colliders<double>& colliders = core.system.colliders;
  const auto [a, b] = core.colliders_of(patch);
  Contact contact{.geom_a = GeomId(colliders.geoms[a].geom),
                  .geom_b = GeomId(colliders.geoms[b].geom),
                  .position = point.p,
                  .normal = patch.normal,
                  .distance = point.phi,
                  .normal_force = inverse_h * y.x};
  contact.link_a = core.model->geoms()[contact.geom_a.index()].link;
  contact.link_b = core.model->geoms()[contact.geom_b.index()].link;
  const Vec3<double> friction = y.y * patch.e_1 + y.z * patch.e_2;
  contact.friction_force = inverse_h * friction;
  contact.impulse = y.x * patch.normal + friction;
  contact.force = inverse_h * contact.impulse;
  return contact;
}

/// The pose of a link before the last step.
Transform<double> pose_before(const Link& link, const Workspace<double>& ws) {
  return frame_pose(link.body, link.X_BL, ws);
}

}  // namespace

std::vector<Contact> World::contacts() const {
  const WorldCore& now = loose();
  std::vector<Contact> found;
  if (!now.has_stepped) return found;
  const double inverse_h = 1 / time_step_;
  const ContactSolver<double>& contact = now.step.contact;
  for (std::size_t i = 0; i < contact.problem.points.size(); ++i) {
    const ContactPoint<double>& point = contact.problem.points[i];
    const ContactPatch<double>& patch = contact.problem.patches[point.patch];
    const Vec3<double>& y = contact.iterate.points[i].impulse;
    if (!is_finite(point.phi) || (point.phi > 0 && !(y.x > 0))) continue;
    found.push_back(report_of(now, patch, point, y, inverse_h));
    if (point.torsion < 0) continue;
    const Vec3<double>& m = contact.iterate.torsions[static_cast<std::size_t>(point.torsion)].impulse;
    found.back().moment = inverse_h * (m.x * patch.normal + m.y * patch.t_1 + m.z * patch.t_2);
  }
  return found;
}

ContactWrench World::contact_wrench(std::string_view link_name, std::string_view other_name) const {
  const WorldCore& now = loose();
  const LinkId link = now.model->link_id(link_name);
  const LinkId other = other_name.empty() ? LinkId() : now.model->link_id(other_name);
  ContactWrench sum;
  if (!now.has_stepped) return sum;
  const Vec3<double> origin = pose_before(now.model->link(link), now.step.dynamics).p;
  for (const Contact& contact : contacts()) {
    if (contact.link_a != link && contact.link_b != link) continue;
    const bool is_b = contact.link_b == link;
    if (other.is_valid() && (is_b ? contact.link_a : contact.link_b) != other) continue;
    const PointForces<double> forces{contact.normal_force * contact.normal, contact.friction_force};
    add_forces(forces, contact.position - origin, is_b ? 1.0 : -1.0, sum);
    sum.friction.n = fma(is_b ? 1.0 : -1.0, contact.moment, sum.friction.n);
  }
  return sum;
}

ContactResiduals World::residuals() const {
  const WorldCore& now = loose();
  return now.has_stepped ? contact_residuals(now.step) : ContactResiduals{};
}

double World::max_penetration() const {
  const WorldCore& now = loose();
  double deepest = 0;
  for (const ContactPoint<double>& point : now.step.contact.problem.points) deepest = std::max(deepest, -point.phi);
  return deepest;
}

namespace {

/// What of the tree hangs on a link, the link included: 1 for each such link.
std::vector<std::uint8_t> subtree_of(const Model& model, LinkId root) {
  std::vector<std::uint8_t> inside(model.links().size(), 0);
  for (std::size_t i = 0; i < inside.size(); ++i) {
    for (LinkId id(i); id.is_valid(); id = model.link(id).parent) {
      if (id == root) inside[i] = 1;
    }
  }
  return inside;
}

/// Rate of change of the links' momentum less gravity's part as far as nothing carries it, about the world's origin, in
/// the step from `before`.
Force<double> inertial_force(const WorldCore& core, const std::vector<std::uint8_t>& inside, double h) {
  const Model& model = *core.model;
  place_last_step(core, h);
  const Workspace<double>& ws = core.scratch;
  Force<double> sum = Force<double>::zero();
  for (std::size_t i = 1; i < inside.size(); ++i) {
    const Link& link = model.links()[i];
    if (inside[i] == 0 || !(link.inertial.mass > 0)) continue;
    const double factor = core.extras.link_mass[i] / link.inertial.mass;
    const std::size_t b = link.body.index();
    const Transform<double> X_OL = Transform<double>{ws.R_WB[b], ws.p_OB[b]} * link.X_BL;
    const RigidInertia<double> I = transformed(X_OL, link.inertial.about_origin());
    const Motion<double> A = fma(-link.gravity_compensation, internal::minus_gravity<double>(core.params), ws.A[b]);
    const Force<double> F = factor * (I * A + cross(ws.V[b], I * ws.V[b]));
    sum = sum + Force<double>{F.n + cross(ws.p_WO[b], F.f), F.f};
  }
  return sum;
}

/// What the rows of equality constraints between a part of the links and the rest did to that part in the last step,
/// about the world's origin.
Force<double> equality_force(const WorldCore& core, const std::vector<std::uint8_t>& inside, double inverse_h) {
  const ContactProblem<double>& problem = core.step.contact.problem;
  const std::span<const EqualityConstraint> equalities = core.model->equalities();
  Force<double> sum = Force<double>::zero();
  for (std::size_t k = 0; k < problem.equalities.size(); ++k) {
    const EqualityRows<double>& rows = problem.equalities[k];
    const EqualityConstraint& equality = equalities[rows.equality];
    if (!equality.link_a.is_valid() || inside[equality.link_a.index()] == inside[equality.link_b.index()]) continue;
    const auto pose = [&](LinkId id, const Transform<double>& X) {
      return pose_before(core.model->link(id), core.step.dynamics) * X;
    };
    const Vec3<double> y = (inside[equality.link_b.index()] != 0 ? inverse_h : -inverse_h) *
                           (pose(equality.link_a, equality.X_LA).R * core.step.contact.iterate.equalities[k]);
    const bool turns = rows.cache != core.system.tree.equalities[rows.equality].row;
    const Vec3<double> p = pose(equality.link_b, equality.X_LB).p;
    sum = sum + (turns ? Force<double>{y, Vec3<double>::zero()} : Force<double>{cross(p, y), y});
  }
  return sum;
}

}  // namespace

Force<double> World::wrench_into(const WorldCore& now, LinkId link) const {
  const std::vector<std::uint8_t> inside = subtree_of(*now.model, link);
  Force<double> F = inertial_force(now, inside, time_step_) - equality_force(now, inside, 1 / time_step_);
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (inside[i] != 0) F = F - now.external_before[i];
  }
  for (const Contact& contact : contacts()) {
    const double on_subtree =
        (inside[contact.link_b.index()] != 0 ? 1.0 : 0.0) - (inside[contact.link_a.index()] != 0 ? 1.0 : 0.0);
    if (on_subtree == 0) continue;
    const Force<double> on_b{cross(contact.position, contact.force) + contact.moment, contact.force};
    F = F - on_subtree * on_b;
  }
  return F;
}

Force<double> World::joint_wrench(std::string_view joint_name) const {
  const WorldCore& now = loose();
  const Joint& joint = now.model->joint(now.model->joint_id(joint_name));
  if (!now.has_stepped) {
    throw std::runtime_error("joint_wrench tells of the last step, and there is none yet" +
                             std::string(integrator_ == Integrator::kRungeKutta4 ? ": rk4 has no reactions" : ""));
  }
  const std::vector<std::uint8_t> inside = subtree_of(*now.model, joint.child);
  for (const EqualityConstraint& loop : now.model->equalities()) {
    const bool joints = loop.type == EqualityType::kJoint || loop.type == EqualityType::kGear;
    const LinkId a = joints ? now.model->joint(loop.joint_a).child : loop.link_a;
    const LinkId b = joints ? now.model->joint(loop.joint_b).child : loop.link_b;
    if (joints || inside[a.index()] == inside[b.index()]) continue;
    throw std::runtime_error("joint '" + joint.name + "' lies within the closed loop '" + loop.name +
                             "', whose forces share its load");
  }
  const Force<double> F = wrench_into(now, joint.child);
  const Vec3<double> origin = pose_before(now.model->link(joint.child), now.step.dynamics).p;
  return {F.n - cross(origin, F.f), F.f};
}

}  // namespace manyhands
