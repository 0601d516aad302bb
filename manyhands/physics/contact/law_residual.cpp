#include "manyhands/physics/contact/law_residual.h"

#include <algorithm>
#include <cmath>

namespace manyhands::internal {

namespace {

using Vec = Vec3<double>;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

double length(double a, double b) { return std::sqrt(a * a + b * b); }

/// |G y - P(G y - u)|, P onto the disc of the given radius (times G).
double disc_residual(double G, double y_1, double y_2, double u_1, double u_2, double radius) {
  const double a = G * y_1 - u_1, b = G * y_2 - u_2, size = length(a, b), rim = G * std::max(radius, 0.0);
  const double scale = size > rim ? rim / size : 1;
  return length(G * y_1 - scale * a, G * y_2 - scale * b);
}

double torsion_residual(const ContactProblem& problem, const ContactTorsion<double>& torsion, double n) {
  const Vec u =
      torsion.offset + multiply_rows(problem.tree, torsion.rows, problem.contacts.store, problem.joints.dv.data());
  const Vec& m = torsion.impulse;
  const double G = 1 / torsion.spin_inverse, most = G * torsion.spinning * n;
  const double spin = std::abs(G * m.x - std::clamp(G * m.x - u.x, -most, most));
  const double size = 0.5 * (torsion.stiffness.sigma_1 + torsion.stiffness.sigma_2);
  const double roll = disc_residual(size, m.y, m.z, u.y, u.z, torsion.rolling * n);
  return std::max(torsion.spinning * spin, torsion.rolling * roll);
}

}  // namespace

double tangent_size(const ContactStiffness<double>& G) {
  const double coupling = (G.slope_1 * G.slope_1 + G.slope_2 * G.slope_2) * G.normal;
  return 0.5 * (G.sigma_1 + G.sigma_2 + coupling);
}

double point_residual(const ContactProblem& problem, const ContactPoint<double>& point) {
  const ContactSet<double>& set = problem.contacts;
  if (!(point.stiffness.normal_inverse > 0)) return 0;
  Vec u = point.offset + point_velocity(problem.tree, set, point, problem.joints.dv.data());
  u.x += point.softness * point.impulse.x;
  const Vec& y = point.impulse;
  const double signorini = std::abs(std::min(point.stiffness.normal * y.x, u.x));
  double worst = std::max(signorini, disc_residual(tangent_size(point.stiffness), y.y, y.z, u.y, u.z, y.x));
  if (point.torsion >= 0) worst = std::max(worst, torsion_residual(problem, set.torsions[index(point.torsion)], y.x));
  return worst;
}

double law_residual(const ContactProblem& problem) {
  double worst = 0;
  for (const ContactPoint<double>& point : problem.contacts.points)
    worst = std::max(worst, point_residual(problem, point));
  return worst;
}

}  // namespace manyhands::internal
