// Client: constraints that users make between bodies.
#include <algorithm>

#include "manyhands/bullet/client_body.h"
#include "manyhands/math/quaternion.h"

namespace manyhands::bullet {

namespace {

std::string constraint_label(int id) { return "c" + std::to_string(id); }

/// A rotation that takes z to the axis.
Mat3<double> to_axis(const Vec3<double>& axis) {
  const double length = norm(axis);
  if (!(length > 1e-12)) return Mat3<double>::identity();
  const Vec3<double> z = (1 / length) * axis;
  const Vec3<double> side = std::abs(z.x) < 0.5 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0};
  Vec3<double> y = cross(z, side);
  y = (1 / norm(y)) * y;
  return {cross(y, z), y, z};
}

/// The pose that is `share` of the way from one to another.
Transform<double> between(const Transform<double>& from, const Transform<double>& to, double share) {
  Quat<double> r = to_quat(inverse(from).R * to.R);
  if (r.w < 0) r = {-r.x, -r.y, -r.z, -r.w};
  const double s = std::sqrt(r.x * r.x + r.y * r.y + r.z * r.z);
  const double half = share * std::atan2(s, r.w), factor = s > 1e-12 ? std::sin(half) / s : 0;
  const Quat<double> part{factor * r.x, factor * r.y, factor * r.z, std::cos(half)};
  return {from.R * to_matrix(normalized(part)), from.p + share * (to.p - from.p)};
}

/// Whether it closes a loop of a body's own links. Joints of a file are never quite parallel: to hold such a loop
/// exactly in the direction along them would lock it.
bool holds_loop(const UserConstraint& c) { return c.type == kPoint && c.parent == c.child && !c.has_max_force; }

/// What takes back a fifth of its error in a step, and gives way by a thousandth of what moves there.
Compliance soft(double h) {
  constexpr double kErrorReduction = 0.2, kImpedance = 0.999;
  return {.stiffness = kErrorReduction / (h * h),
          .damping = 1 / h,
          .impedance = kImpedance,
          .largest_impedance = kImpedance};
}

}  // namespace

/// The constraint in the world's terms; its frames where they belong.
EqualityConstraint Client::equality_of(int id, const UserConstraint& c) {
  Body& parent = *find(c.parent);
  Body* const child = find(c.child);
  EqualityConstraint equality{.name = constraint_label(id)};
  if (c.has_max_force) equality.max_force = c.max_force;
  if (c.type == kGear) {
    // v_parent + ratio v_child = 0; with an error reduction also of positions.
    equality.type = c.erp > 0 ? EqualityType::kJoint : EqualityType::kGear;
    equality.joint_a = joint_id(*child, c.child_link);
    equality.joint_b = joint_id(parent, c.parent_link);
    equality.ratio = -c.gear_ratio;
    equality.offset = c.erp > 0 ? c.relative_target : 0;
    return equality;
  }
  const Mat3<double> turn = c.type == kPrismatic ? to_axis(c.axis) : Mat3<double>::identity();
  const auto turned = [&](const Transform<double>& X) { return Transform<double>{X.R * turn, X.p}; };
  equality.type = c.type == kFixed       ? EqualityType::kFixed
                  : c.type == kPrismatic ? EqualityType::kPrismatic
                                         : EqualityType::kPoint;
  if (holds_loop(c)) equality.compliance = soft(world_.time_step());
  equality.link_a = link_id(parent, c.parent_link);
  equality.X_LA = turned(parent.plan.link(c.parent_link).X_LI * c.X_parent);
  equality.link_b = child == nullptr ? LinkId(0) : link_id(*child, c.child_link);
  equality.X_LB = turned(child == nullptr ? c.X_child : child->plan.link(c.child_link).X_LI * c.X_child);
  return equality;
}

int Client::create_constraint(const UserConstraint& given) {
  constexpr const char* kError = "createConstraint failed.";
  UserConstraint c = given;
  Body& parent = at(c.parent, kError);
  if (!has_body(c.child)) c.child = c.child_link = -1;
  Body* const child = find(c.child);
  if (!parent.has_link(c.parent_link) || (child != nullptr && !child->has_link(c.child_link))) throw Error(kError);
  if (c.type != kFixed && c.type != kPoint && c.type != kPrismatic && c.type != kGear) throw Error(kError);
  const bool one_part = c.parent == c.child && c.parent_link == c.child_link;
  const auto turns = [&](const Body* body, int link) {
    return body != nullptr && body->has_joint(link) && velocity_size(body->plan.link(link).joint) == 1;
  };
  if (one_part || (c.type == kGear && !(turns(&parent, c.parent_link) && turns(child, c.child_link)))) {
    throw Error(kError);
  }
  keep_contacts();
  const int id = next_constraint_++;
  world_.add_equality(equality_of(id, c));
  constraints_[id] = c;
  constraint_order_.push_back(id);
  return id;
}

void Client::change_constraint(int id, const ConstraintChange& change) {
  const auto found = constraints_.find(id);
  if (found == constraints_.end()) return;
  UserConstraint& c = found->second;
  const bool had_erp = c.erp > 0;
  if (change.child_pivot) c.X_child.p = *change.child_pivot;
  if (change.child_orientation) c.X_child.R = to_matrix(normalized(*change.child_orientation));
  if (change.max_force && *change.max_force >= 0) {
    c.max_force = *change.max_force;
    c.has_max_force = true;
  }
  if (change.gear_ratio) {
    c.gear_ratio = *change.gear_ratio;
    c.has_gear_ratio = true;
  }
  if (change.gear_aux_link && *change.gear_aux_link >= 0) c.gear_aux_link = *change.gear_aux_link;
  if (change.relative_target) c.relative_target = *change.relative_target;
  if (change.erp && *change.erp >= 0) c.erp = *change.erp;
  if (c.type == kGear && had_erp != (c.erp > 0)) {
    keep_contacts();
    world_.remove_equality(constraint_label(id));
    world_.add_equality(equality_of(id, c));
  } else {
    world_.set_equality(equality_of(id, c));
  }
}

void Client::remove_constraint(int id) {
  if (!constraints_.contains(id)) return;
  drop_constraint(id);
  keep_contacts();
  world_.remove_equality(constraint_label(id));
}

const UserConstraint& Client::constraint(int id) const {
  const auto found = constraints_.find(id);
  if (found == constraints_.end()) throw Error("Couldn't get user constraint info");
  return found->second;
}

/// The last one takes the serial number of one that goes.
void Client::drop_constraint(int id) {
  constraints_.erase(id);
  *std::ranges::find(constraint_order_, id) = constraint_order_.back();
  constraint_order_.pop_back();
}

/// Makes the world's constraints those of the client, after bodies have been made anew.
void Client::write_constraints() {
  std::vector<std::string> old;
  for (const EqualityConstraint& equality : world_.model().equalities()) {
    if (equality.name.starts_with('c')) old.push_back(equality.name);
  }
  for (const std::string& name : old) world_.remove_equality(name);
  for (const auto& [id, c] : constraints_) world_.add_equality(equality_of(id, c));
}

/// PyBullet takes back a fifth of a constraint's error in a step: frames that are apart meet over some steps.
void Client::approach_constraints() {
  constexpr double kErrorReduction = 0.2, kClose = 1e-6;
  for (const auto& [id, c] : constraints_) {
    if (c.type == kGear || holds_loop(c)) continue;
    EqualityConstraint equality = equality_of(id, c);
    const Transform<double> X_WA = world_.link_pose(equality.link_a) * equality.X_LA;
    const Transform<double> X_WLb = world_.link_pose(equality.link_b);
    const Transform<double> X_WB = X_WLb * equality.X_LB;
    const Mat3<double> R = inverse(X_WA).R * X_WB.R;
    const double angle = c.type == kPoint ? 0 : norm(Vec3<double>{R.y.z - R.z.y, R.z.x - R.x.z, R.x.y - R.y.x});
    const bool is_close = norm(X_WB.p - X_WA.p) + angle < kClose && R.x.x + R.y.y + R.z.z > -0.9;
    if (!is_close) equality.X_LB = inverse(X_WLb) * between(X_WA, X_WB, kErrorReduction);
    world_.aim_equality(equality);
  }
}

}  // namespace manyhands::bullet
