#include "manyhands/physics/contact/newton/newton_laws.h"

#include <algorithm>
#include <cmath>

#include "manyhands/physics/contact/newton/law_residual.h"

namespace manyhands::internal {

namespace {

using Vec = Vec3<double>;
using Mat = Mat3<double>;

void add(Mat& to, const Mat& m) { to = {to.x + m.x, to.y + m.y, to.z + m.z}; }
Mat no_slope() { return {Vec::zero(), Vec::zero(), Vec::zero()}; }

/// Rows 2 and 3 of the law: P(trial) onto a disc of radius `ratio` n, where d n / d u_n = -give_n.
void project(double trial_1, double trial_2, double n, double ratio, double give, double give_n, MultiplierLaw& law) {
  const double size = length(trial_1, trial_2), radius = ratio * n;
  if (size <= radius) {
    law.impulse.y = trial_1;
    law.impulse.z = trial_2;
    law.slope.y = {0, give, 0};
    law.slope.z = {0, 0, give};
    return;
  }
  const double d_1 = trial_1 / size, d_2 = trial_2 / size, turn = give * radius / size;
  law.impulse.y = radius * d_1;
  law.impulse.z = radius * d_2;
  law.slope.y = {0, turn * (1 - d_1 * d_1), -turn * d_1 * d_2};
  law.slope.z = {0, -turn * d_1 * d_2, turn * (1 - d_2 * d_2)};
  law.on_normal.y = ratio * give_n * d_1;
  law.on_normal.z = ratio * give_n * d_2;
}

double inverse(double softness, double size, double beside) {
  return size > 1e-12 * beside && size > 0 ? 1 / (softness * size) : 0.0;
}

/// The diagonal of J A J^T of three rows.
Vec response_diagonal(const NewtonContext& context, const RowBlock& rows) {
  Vec G = Vec::zero();
  visit_Y(rows, [&](std::size_t entry, std::size_t) {
    const Vec& Y = context.factors.Y[entry];
    G = G + Vec{Y.x * Y.x, Y.y * Y.y, Y.z * Y.z};
  });
  return G;
}

/// The velocity of a point is v + B w of its patch's motion.
Mat turning_of(const ContactPatch<double>& patch, const Vec& l) {
  const double f_1 = patch.friction_1, f_2 = patch.friction_2;
  return {{0, -f_1 * l.z, f_2 * l.y}, {l.z, 0, -f_2 * l.x}, {-l.y, f_1 * l.x, 0}};
}

}  // namespace

void NewtonLaws::begin(const NewtonContext& context, double softness, RowVelocities& velocities) {
  const ContactProblem<double>& problem = context.problem;
  velocities.points.clear();
  velocities.torsions.clear();
  velocities.equalities.assign(equalities.size(), Vec::zero());
  first_.clear();
  point_yield_.clear();
  torsion_yield_.clear();
  for (const std::size_t p : patches) {
    const ContactPatch<double>& patch = problem.patches[p];
    first_.push_back(point_yield_.size());
    for (std::size_t i = patch.first; i < patch.first + patch.count; ++i) {
      const ContactPoint<double>& point = problem.points[i];
      const DelassusBlock<double>& G = context.factors.points[i];
      const double opening = asked_opening(problem, context.factors, i);
      const double yields = G.yields(context.iterate.points[i].impulse.x, opening);
      velocities.points.push_back(context.factors.offsets[i] + Vec{yields, 0, 0});
      velocities.torsions.push_back(Vec::zero());
      const double own = G.softness + G.opening_softness, r = softness * (G.normal - own) + own;
      point_yield_.push_back({G.normal_inverse > 0 ? 1 / r : 0.0, inverse(softness, tangent_size(G), 1e-6 * G.normal)});
      torsion_yield_.push_back({});
      if (point.torsion < 0) continue;
      velocities.torsions.back() = problem.torsions[index(point.torsion)].offset;
      const DelassusBlock<double>& rolling = context.factors.torsions[index(point.torsion)];
      const double spin = 1 / context.factors.spin_inverse[index(point.torsion)];
      torsion_yield_.back() = {inverse(softness, spin, 0),
                               inverse(softness, 0.5 * (rolling.sigma_1 + rolling.sigma_2), 1e-6 * spin)};
    }
  }
  point_law_.resize(point_yield_.size());
  torsion_law_.resize(point_yield_.size());
  equality_yield_.clear();
  for (const std::size_t i : equalities) {
    const EqualityRows<double>& block = problem.equalities[i];
    const Vec size = response_diagonal(context, block.rows);
    const double least = context.factors.K_immovable[block.first];  // of all its rows
    const Vec G{size.x > least ? size.x : 0, size.y > least ? size.y : 0, size.z > least ? size.z : 0};
    const double largest = std::max({G.x, G.y, G.z});
    equality_yield_.push_back(
        {inverse(softness, G.x, largest), inverse(softness, G.y, largest), inverse(softness, G.z, largest)});
  }
}

void NewtonLaws::multiply_J(const NewtonContext& context, const double* x, RowVelocities& velocities) const {
  const ContactProblem<double>& problem = context.problem;
  velocities.points.clear();
  velocities.torsions.clear();
  velocities.equalities.clear();
  for (const std::size_t p : patches) {
    const ContactPatch<double>& patch = problem.patches[p];
    const Motion<double> motion = patch_motion(context.tree(), patch, problem.rows, x);
    for (std::size_t i = patch.first; i < patch.first + patch.count; ++i) {
      velocities.points.push_back(velocity_at(patch, problem.points[i].lever, motion));
      velocities.torsions.push_back(motion.w);
    }
  }
  for (const std::size_t i : equalities)
    velocities.equalities.push_back(manyhands::multiply_J(context.tree(), problem.equalities[i].rows, problem.rows, x));
}

void NewtonLaws::evaluate(const NewtonContext& context, const RowVelocities& from, double t,
                          const RowVelocities& change) {
  presses_.assign(patches.size(), false);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const ContactPatch<double>& patch = context.problem.patches[patches[p]];
    for (std::size_t c = 0; c < patch.count; ++c) {
      const std::size_t k = first_[p] + c;
      point_law_[k] = torsion_law_[k] = {};
      evaluate_point(context, patch.first + c, k, fma(t, change.points[k], from.points[k]),
                     fma(t, change.torsions[k], from.torsions[k]));
      presses_[p] = presses_[p] || point_law_[k].impulse.x > 0;
    }
  }
  equality_change_.resize(equalities.size());
  for (std::size_t k = 0; k < equalities.size(); ++k) {
    const Vec u = fma(t, change.equalities[k], from.equalities[k]);
    const Vec& give = equality_yield_[k];
    equality_change_[k] = {-give.x * u.x, -give.y * u.y, -give.z * u.z};
  }
}

void NewtonLaws::evaluate_point(const NewtonContext& context, std::size_t i, std::size_t k, const Vec& u,
                                const Vec& w) {
  const Yield& give = point_yield_[k];
  if (!(give.normal > 0)) return;
  const Vec& y = context.iterate.points[i].impulse;
  const double n = y.x - give.normal * u.x;
  if (!(n > 0)) return;
  MultiplierLaw& law = point_law_[k];
  law.impulse.x = n;
  law.slope.x = {give.normal, 0, 0};
  if (give.tangent > 0)
    project(y.y - give.tangent * u.y, y.z - give.tangent * u.z, n, 1, give.tangent, give.normal, law);
  const int torsion = context.problem.points[i].torsion;
  if (torsion >= 0) evaluate_torsion(context, index(torsion), k, w);
}

void NewtonLaws::evaluate_torsion(const NewtonContext& context, std::size_t j, std::size_t k, const Vec& w) {
  const ContactPatch<double>& patch = context.problem.patches[context.problem.torsions[j].patch];
  const Vec& m = context.iterate.torsions[j].impulse;
  const Yield& give = torsion_yield_[k];
  const double n = point_law_[k].impulse.x, give_n = point_yield_[k].normal;
  MultiplierLaw& law = torsion_law_[k];
  const double spin = m.x - give.normal * w.x, most = patch.spinning * n;
  law.impulse.x = std::clamp(spin, -most, most);
  if (std::abs(spin) <= most) {
    law.slope.x = {give.normal, 0, 0};
  } else {
    law.on_normal.x = std::copysign(patch.spinning * give_n, spin);
  }
  if (patch.rolling > 0 && give.tangent > 0)
    project(m.y - give.tangent * w.y, m.z - give.tangent * w.z, n, patch.rolling, give.tangent, give_n, law);
}

/// Of the force on patch p of those that take part.
Force<double> NewtonLaws::patch_change(const NewtonContext& context, std::size_t p) const {
  const ContactPatch<double>& patch = context.problem.patches[patches[p]];
  Force<double> change = Force<double>::zero();
  for (std::size_t c = 0; c < patch.count; ++c) {
    const std::size_t i = patch.first + c, k = first_[p] + c;
    const ContactPoint<double>& point = context.problem.points[i];
    change = change + force_at(patch, point.lever, point_law_[k].impulse - context.iterate.points[i].impulse);
    if (point.torsion >= 0)
      change.n += torsion_law_[k].impulse - context.iterate.torsions[index(point.torsion)].impulse;
  }
  return change;
}

void NewtonLaws::add_changes(const NewtonContext& context, double* x) const {
  const ContactProblem<double>& problem = context.problem;
  for (std::size_t p = 0; p < patches.size(); ++p)
    add_patch_JT(context.tree(), problem.patches[patches[p]], problem.rows, patch_change(context, p), x);
  for (std::size_t k = 0; k < equalities.size(); ++k)
    add_JT(context.tree(), problem.equalities[equalities[k]].rows, problem.rows, equality_change_[k], x);
}

void NewtonLaws::apply(const NewtonContext& context) const {
  Iterate<double>& iterate = context.iterate;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const ContactPatch<double>& patch = context.problem.patches[patches[p]];
    add_patch_YT(patch, context.factors.Y.data(), patch_change(context, p), iterate.y.data());
    for (std::size_t c = 0; c < patch.count; ++c) {
      const std::size_t i = patch.first + c, k = first_[p] + c;
      iterate.points[i].impulse = point_law_[k].impulse;
      const int torsion = context.problem.points[i].torsion;
      if (torsion >= 0) iterate.torsions[index(torsion)].impulse = torsion_law_[k].impulse;
    }
  }
}

PatchSlope NewtonLaws::patch_slope(const NewtonContext& context, std::size_t k) const {
  const ContactPatch<double>& patch = context.problem.patches[patches[k]];
  PatchSlope sum{no_slope(), no_slope(), no_slope(), no_slope()};
  for (std::size_t c = 0; c < patch.count; ++c) {
    const Mat& slope = point_law_[first_[k] + c].slope;
    add(sum.vv, slope);
    if (!patch.turns) continue;
    const Mat B = turning_of(patch, context.problem.points[patch.first + c].lever), slope_B = slope * B;
    add(sum.vw, slope_B);
    add(sum.wv, transpose(B) * slope);
    add(sum.ww, transpose(B) * slope_B);
    add(sum.ww, torsion_law_[first_[k] + c].slope);
  }
  return sum;
}

PatchSlope NewtonLaws::equality_slope(std::size_t k) const {
  const Vec& give = equality_yield_[k];
  return {{{give.x, 0, 0}, {0, give.y, 0}, {0, 0, give.z}}, no_slope(), no_slope(), no_slope()};
}

void NewtonLaws::find_following(const NewtonContext& context, std::vector<Following>& following) const {
  following.clear();
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const ContactPatch<double>& patch = context.problem.patches[patches[p]];
    for (std::size_t c = 0; c < patch.count; ++c) {
      const Vec &on_point = point_law_[first_[p] + c].on_normal, &on_torsion = torsion_law_[first_[p] + c].on_normal;
      if (squared_norm(on_point) + squared_norm(on_torsion) == 0) continue;
      const Vec& lever = context.problem.points[patch.first + c].lever;
      Force<double> force = force_at(patch, lever, on_point);
      force.n += on_torsion;
      const Force<double> normal = force_at(patch, lever, {1, 0, 0});
      following.push_back({p, force, {normal.n, normal.f}});
    }
  }
}

}  // namespace manyhands::internal
