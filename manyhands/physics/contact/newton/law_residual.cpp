#include "manyhands/physics/contact/newton/law_residual.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace manyhands::internal {

namespace {

using Vec = Vec3<double>;

/// What is not finite breaks the law beyond measure: std::max would pass over it.
constexpr double kBeyondMeasure = std::numeric_limits<double>::infinity();

bool are_finite(const Vec& a, const Vec& b) { return std::isfinite(a.x + a.y + a.z + b.x + b.y + b.z); }

/// |G y - P(G y - u)|, P onto the disc of the given radius (times G).
double disc_residual(double G, double y_1, double y_2, double u_1, double u_2, double radius) {
  const double a = G * y_1 - u_1, b = G * y_2 - u_2, size = length(a, b), rim = G * std::max(radius, 0.0);
  const double scale = size > rim ? rim / size : 1;
  return length(G * y_1 - scale * a, G * y_2 - scale * b);
}

double torsion_residual(const NewtonContext& context, std::size_t j, const Vec& turning, double n) {
  const ContactTorsion<double>& torsion = context.problem.torsions[j];
  const ContactPatch<double>& patch = context.problem.patches[torsion.patch];
  const DelassusBlock<double>& rolling = context.factors.torsions[j];
  const Vec u = torsion.offset + turning;
  const Vec& m = context.iterate.torsions[j].impulse;
  if (!are_finite(m, u)) return kBeyondMeasure;
  const double G = 1 / context.factors.spin_inverse[j], most = G * patch.spinning * n;
  const double spin = std::abs(G * m.x - std::clamp(G * m.x - u.x, -most, most));
  const double size = 0.5 * (rolling.sigma_1 + rolling.sigma_2);
  const double roll = disc_residual(size, m.y, m.z, u.y, u.z, patch.rolling * n);
  return std::max(patch.spinning * spin, patch.rolling * roll);
}

double point_residual(const NewtonContext& context, std::size_t i, const Motion<double>& motion) {
  const ContactPoint<double>& point = context.problem.points[i];
  const DelassusBlock<double>& G = context.factors.points[i];
  if (!(G.normal_inverse > 0)) return 0;
  const Vec& y = context.iterate.points[i].impulse;
  const Vec moves = velocity_at(context.problem.patches[point.patch], point.lever, motion);
  Vec u = context.factors.offsets[i] + moves;
  u.x += G.yields(y.x, asked_opening(context.problem, context.factors, i));
  if (!are_finite(y, u)) return kBeyondMeasure;
  const double signorini = std::abs(std::min(G.normal * y.x, u.x));
  const double worst = std::max(signorini, disc_residual(tangent_size(G), y.y, y.z, u.y, u.z, y.x));
  if (point.torsion < 0) return worst;
  return std::max(worst, torsion_residual(context, index(point.torsion), motion.w, y.x));
}

}  // namespace

double tangent_size(const DelassusBlock<double>& G) {
  const double coupling = (G.slope_1 * G.slope_1 + G.slope_2 * G.slope_2) * G.normal;
  return 0.5 * (G.sigma_1 + G.sigma_2 + coupling);
}

double patch_residual(const NewtonContext& context, const ContactPatch<double>& patch) {
  const double* dv = context.iterate.dv.data();
  const Motion<double> motion = patch_motion(context.tree(), patch, context.problem.rows, dv);
  double worst = 0;
  for (std::size_t i = patch.first; i < patch.first + patch.count; ++i)
    worst = std::max(worst, point_residual(context, i, motion));
  return worst;
}

double law_residual(const NewtonContext& context) {
  double worst = 0;
  for (const ContactPatch<double>& patch : context.problem.patches)
    worst = std::max(worst, patch_residual(context, patch));
  return worst;
}

}  // namespace manyhands::internal
