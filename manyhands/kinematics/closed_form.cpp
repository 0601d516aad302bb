#include "manyhands/kinematics/closed_form.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "manyhands/kinematics/ik_search.h"

namespace manyhands {

namespace {

using Vec = Vec3<double>;
using Mat = Mat3<double>;

constexpr double kParallel = 1e-9;  // sine of the angle between axes that count as parallel
constexpr double kTogether = 1e-9;  // between axes that count as meeting [m]
constexpr double kReach = 1e-7;  // beyond reach, relative, that rounding explains: angles near 0 have half the digits

Mat turn(const Vec& axis, double angle) { return to_matrix(quat_from_rotation_vector(angle * axis)); }

double wrapped(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

/// Whether two solutions are one: where branches meet, at singular poses, they differ by rounding.
template <class Angles>
bool are_same(const Angles& a, const Angles& b) {
  constexpr double kSame = 1e-6;  // angles near a singular one have half the digits
  return std::ranges::equal(a, b, [](double x, double y) { return std::abs(wrapped(x - y)) < kSame; });
}

/// The angle about `axis` that turns p to q, as seen along it; 0 where p lies on it.
double angle_between(const Vec& axis, const Vec& p, const Vec& q) {
  const double sine = dot(q, cross(axis, p)), cosine = dot(q, p) - dot(axis, p) * dot(axis, q);
  constexpr double kOnAxis = 1e-7;  // angles near 0 have half the digits
  return std::hypot(sine, cosine) < kOnAxis ? 0 : std::atan2(sine, cosine);
}

/// The angles about `axis` for which h . turn(axis, angle) p = d: two, equal ones at the edge of reach, or none.
std::vector<double> angles_of_component(const Vec& h, const Vec& axis, const Vec& p, double d) {
  const double fixed = dot(h, axis) * dot(axis, p);
  const double cosine = dot(h, p) - fixed, sine = dot(h, cross(axis, p)), r = std::hypot(cosine, sine);
  const double ratio = (d - fixed) / r;
  if (!(std::abs(ratio) <= 1 + kReach)) return {};
  const double middle = std::atan2(sine, cosine), half = std::acos(clamp(ratio, -1.0, 1.0));
  return {middle - half, middle + half};
}

bool are_parallel(const Vec& a, const Vec& b) { return norm(cross(a, b)) < kParallel; }

Vec normal_of(const Vec& a) {
  const Vec n = cross(a, std::abs(a.x) < 0.7 ? Vec{1, 0, 0} : Vec{0, 1, 0});
  return (1 / norm(n)) * n;
}

/// The angle that is `angle` but for whole turns, within limits and as near to `here` as these allow; none if there is
/// none.
std::optional<double> turned_near(double angle, double here, const JointLimits& limits) {
  constexpr double kTurn = 2 * std::numbers::pi, kHair = 1e-12;
  const double least = std::ceil((limits.lower - angle) / kTurn - kHair);
  const double most = std::floor((limits.upper - angle) / kTurn + kHair);
  if (!(least <= most)) return std::nullopt;
  return clamp(angle + kTurn * clamp(std::round((here - angle) / kTurn), least, most), limits.lower, limits.upper);
}

}  // namespace

std::optional<ClosedForm> ClosedForm::of(const Model& model, FrameId frame) {
  const IkChain chain(model, frame);
  if (chain.dofs.size() != kJoints) return std::nullopt;
  const std::vector<double> zero = model.neutral_configuration();
  const ScrewAxes screws = screw_axes(model, frame, zero);
  ClosedForm arm;
  arm.dofs_ = chain.dofs;
  for (std::size_t k = 0; k < kJoints; ++k) {
    const Motion<double>& S = screws.axes[chain.dofs[k]];
    if (!(norm(S.w) > 0.5)) return std::nullopt;  // it slides
    arm.axes_[k] = {S.w, cross(S.w, S.v)};
  }
  arm.home_inverse_ = inverse(screws.home);
  if (!arm.find_kind()) return std::nullopt;
  return arm;
}

bool ClosedForm::find_kind() {
  const auto& [first, second, third, fourth, fifth, sixth] = axes_;
  if (!are_parallel(second.direction, third.direction) || are_parallel(first.direction, second.direction)) return false;
  if (are_parallel(fifth.direction, sixth.direction)) return false;
  const Vec across = cross(fifth.direction, sixth.direction);
  const Vec between = sixth.point - fifth.point;
  if (std::abs(dot(between, across)) > kTogether * norm(across)) return false;
  const double along = dot(cross(between, sixth.direction), across) / squared_norm(across);
  centre_ = fifth.point + along * fifth.direction;
  has_wrist_ = norm(cross(centre_ - fourth.point, fourth.direction)) < kTogether &&
               !are_parallel(fourth.direction, fifth.direction);
  return has_wrist_ ||
         (are_parallel(second.direction, fourth.direction) && !are_parallel(fourth.direction, fifth.direction));
}

std::vector<ClosedForm::Angles> ClosedForm::solve(const Transform<double>& X_WF) const {
  const Transform<double> X = X_WF * home_inverse_;  // what the joints do together
  const Axis &first = axes_[0], &second = axes_[1];
  const Vec at = X.R * centre_ + X.p - first.point;
  std::vector<Angles> found;
  // The second to fourth joints, as far as they move the centre, leave its component along their axes.
  for (const double back :
       angles_of_component(second.direction, first.direction, at, dot(second.direction, centre_ - first.point))) {
    const Mat R = turn(first.direction, back);
    const Transform<double> rest{R * X.R, R * (X.p - first.point) + first.point};
    if (has_wrist_) {
      solve_wrist(rest, -back, found);
    } else {
      solve_parallel(rest, -back, found);
    }
  }
  std::vector<Angles> distinct;
  for (Angles& q : found) {
    for (double& angle : q) angle = wrapped(angle);
    if (std::ranges::none_of(distinct, [&](const Angles& other) { return are_same(q, other); })) distinct.push_back(q);
  }
  return distinct;
}

std::vector<std::vector<double>> ClosedForm::within_limits(const Model& model, const Transform<double>& X_WF,
                                                           std::span<const double> start) const {
  if (start.size() != static_cast<std::size_t>(model.nq()))
    throw std::invalid_argument("the start has " + std::to_string(start.size()) + " numbers; the model's q has " +
                                std::to_string(model.nq()));
  std::vector<std::pair<double, std::vector<double>>> found;
  const std::vector<double> rest = manyhands::within_limits(model, start);
  for (const Angles& angles : solve(X_WF)) {
    std::vector<double> q = rest;
    double distance2 = 0;
    bool fits = true;
    for (std::size_t k = 0; k < kJoints; ++k) {
      const Joint& joint = model.joint(JointId(model.dof_joint()[dofs_[k]]));
      const auto i = static_cast<std::size_t>(joint.iq);
      const std::optional<double> near = turned_near(angles[k], start[i], joint.limits);
      fits = fits && near.has_value();
      if (!near) continue;
      distance2 += square(*near - start[i]);
      q[i] = *near;
    }
    if (fits) found.emplace_back(distance2, std::move(q));
  }
  std::ranges::sort(found);
  std::vector<std::vector<double>> rows;
  for (auto& [distance2, q] : found) rows.push_back(std::move(q));
  return rows;
}

/// Calls visit(q2, q3) where the second and third joints bring the point `from` to `to`.
template <class Visit>
void ClosedForm::visit_elbow(const Vec& from, const Vec& to, const Visit& visit) const {
  const Axis &second = axes_[1], &third = axes_[2];
  const Vec p = from - third.point, b = third.point - second.point, wanted = to - second.point;
  // Lengths are those across the axes, along which nothing moves.
  const auto across = [&](const Vec& v) { return v - dot(second.direction, v) * second.direction; };
  const Vec p2 = across(p), b2 = across(b);
  const double d = (squared_norm(across(wanted)) - squared_norm(p2) - squared_norm(b2)) / 2;
  for (const double q3 : angles_of_component(b2, third.direction, p2, d)) {
    const Vec bent = turn(third.direction, q3) * p + b;
    visit(angle_between(second.direction, bent, wanted), q3);
  }
}

void ClosedForm::solve_wrist(const Transform<double>& X, double q1, std::vector<Angles>& found) const {
  const Vec h4 = axes_[3].direction, h5 = axes_[4].direction, h6 = axes_[5].direction, n = normal_of(h6);
  visit_elbow(centre_, X.R * centre_ + X.p, [&](double q2, double q3) {
    const Mat R = turn(axes_[2].direction, -q3) * turn(axes_[1].direction, -q2) * X.R;
    for (const double q5 : angles_of_component(h4, h5, h6, dot(h4, R * h6))) {
      const Mat R5 = turn(h5, q5);
      const double q4 = angle_between(h4, R5 * h6, R * h6);
      const double q6 = angle_between(h6, n, transpose(turn(h4, q4) * R5) * (R * n));
      found.push_back({q1, q2, q3, q4, q5, q6});
    }
  });
}

void ClosedForm::solve_parallel(const Transform<double>& X, double q1, std::vector<Angles>& found) const {
  const Axis &third = axes_[2], &fourth = axes_[3];
  const Vec h2 = axes_[1].direction, h5 = axes_[4].direction, h6 = axes_[5].direction, n = normal_of(h2);
  for (const double q5 : angles_of_component(h2, h5, h6, dot(h2, X.R * h6))) {
    const Mat R5 = turn(h5, q5);
    const double q6 = angle_between(h6, transpose(X.R) * h2, transpose(R5) * h2);
    const Mat last = R5 * turn(h6, q6);
    const Mat R = X.R * transpose(last);  // of the second to the fourth joint: all turn about h2
    const double all = angle_between(h2, n, R * n);
    // The last two leave the centre where it is, so the other three take it to where it goes.
    const Vec joint = X.R * centre_ + X.p + R * (fourth.point - centre_);
    visit_elbow(fourth.point, joint, [&](double q2, double q3) {
      const double left = all - q2 - dot(h2, third.direction) * q3;
      found.push_back({q1, q2, q3, dot(h2, fourth.direction) * left, q5, q6});
    });
  }
}

}  // namespace manyhands
