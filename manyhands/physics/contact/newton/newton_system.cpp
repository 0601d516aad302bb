#include "manyhands/physics/contact/newton/newton_system.h"

#include <algorithm>
#include <cmath>

#include "manyhands/physics/dynamics/ltdl.h"

namespace manyhands::internal {

namespace {

using Vec = Vec3<double>;

double length(double a, double b) { return std::sqrt(a * a + b * b); }

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

bool slides(const MultiplierLaw& law) { return law.on_normal.x != 0 || law.on_normal.y != 0 || law.on_normal.z != 0; }

const RowBlock& rows_of_point(const ContactProblem<double>& problem, std::size_t i) {
  return problem.patches[problem.points[i].patch].linear;
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

}  // namespace

int NewtonSystem::island_of(int cluster) {
  while (island_[index(cluster)] != cluster) cluster = island_[index(cluster)];
  return cluster;
}

void NewtonSystem::choose_islands(const NewtonContext& context, double tolerance) {
  const auto nv = index(context.tree().nv);
  island_.resize(nv);
  for (std::size_t i = 0; i < nv; ++i) island_[i] = static_cast<int>(i);
  const auto first_of = [](const RowBlock& rows) { return rows.begin_a < rows.end_a ? rows.begin_a : rows.begin_b; };
  const auto moves = [](const RowBlock& rows) { return rows.begin_a < rows.end_a || rows.begin_b < rows.end_b; };
  const ContactProblem<double>& problem = context.problem;
  for (const ContactPatch<double>& patch : problem.patches) {
    const RowBlock& rows = patch.linear;
    if (rows.begin_a == rows.end_a || rows.begin_b == rows.end_b) continue;
    const int a = island_of(rows.begin_a), b = island_of(rows.begin_b);
    island_[index(std::max(a, b))] = std::min(a, b);
  }
  island_residual_.assign(nv, 0);
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    const RowBlock& rows = rows_of_point(problem, i);
    if (!moves(rows)) continue;
    double& worst = island_residual_[index(island_of(first_of(rows)))];
    worst = std::max(worst, point_residual(context, i));
  }
  points_.clear();
  equalities_.clear();
  const auto takes_part = [&](const RowBlock& rows) {
    return moves(rows) && island_residual_[index(island_of(first_of(rows)))] > tolerance;
  };
  for (std::size_t i = 0; i < problem.points.size(); ++i)
    if (takes_part(rows_of_point(problem, i))) points_.push_back(i);
  for (std::size_t i = 0; i < problem.equalities.size(); ++i)
    if (takes_part(problem.equalities[i].rows)) equalities_.push_back(i);
}

void NewtonSystem::find_dofs(const NewtonContext& context) {
  takes_part_.assign(index(context.tree().nv), false);
  const auto mark = [&](const RowBlock& rows) {
    std::fill(takes_part_.begin() + rows.begin_a, takes_part_.begin() + rows.end_a, true);
    std::fill(takes_part_.begin() + rows.begin_b, takes_part_.begin() + rows.end_b, true);
  };
  for (const std::size_t i : points_) mark(rows_of_point(context.problem, i));
  for (const std::size_t i : equalities_) mark(context.problem.equalities[i].rows);
  for (std::size_t i = 0; i < takes_part_.size(); ++i)
    if (takes_part_[i]) key_.push_back(i);
  key_.push_back(takes_part_.size());
}

std::size_t NewtonSystem::pair_of(const RowBlock& rows) {
  const bool same =
      !pair_rows_.empty() && pair_rows_.back().body_a == rows.body_a && pair_rows_.back().body_b == rows.body_b;
  if (!same) {
    pair_rows_.push_back(rows);
    key_.push_back(rows.body_a);
    key_.push_back(rows.body_b);
  }
  return pair_rows_.size() - 1;
}

void NewtonSystem::choose(const NewtonContext& context, double tolerance) {
  choose_islands(context, tolerance);
  key_.clear();
  find_dofs(context);
  pair_rows_.clear();
  point_pair_.clear();
  equality_pair_.clear();
  for (const std::size_t i : points_) point_pair_.push_back(pair_of(rows_of_point(context.problem, i)));
  for (const std::size_t i : equalities_) equality_pair_.push_back(pair_of(context.problem.equalities[i].rows));
  if (key_ == last_key_) return;
  last_key_ = key_;
  find_columns(context.tree());
  find_pattern(context.tree());
}

/// Trees in the order of minimum degree, each from its leaves: within a tree that fills nothing in.
void NewtonSystem::find_columns(const Tree<double>& tree) {
  node_.assign(takes_part_.size(), -1);
  trees_.clear();
  for (std::size_t i = 0; i < takes_part_.size(); ++i) {
    if (!takes_part_[i] || index(tree.root_dof[i]) != i) continue;
    node_[i] = static_cast<int>(trees_.size());
    trees_.push_back(i);
  }
  order_.reset(static_cast<int>(trees_.size()));
  for (const RowBlock& rows : pair_rows_) {
    const int a = tree.last_dof[rows.body_a], b = tree.last_dof[rows.body_b];
    if (a >= 0 && b >= 0) order_.connect(node_[index(tree.root_dof[index(a)])], node_[index(tree.root_dof[index(b)])]);
  }
  dofs_.clear();
  column_.assign(takes_part_.size(), -1);
  for (const int node : order_.find_order()) {
    const std::size_t first = trees_[index(node)];
    for (std::size_t i = index(tree.end_dof[first]); i-- > first;) {
      column_[i] = static_cast<int>(dofs_.size());
      dofs_.push_back(i);
    }
  }
}

void NewtonSystem::find_pattern(const Tree<double>& tree) {
  entries_.clear();
  for (const std::size_t i : dofs_) {
    for (int j = static_cast<int>(i); j >= 0; j = tree.dof_parent[index(j)])
      entries_.push_back({column_[i], column_[index(j)]});
  }
  pairs_.clear();
  pair_columns_.clear();
  for (const RowBlock& rows : pair_rows_) {
    const std::size_t first = pair_columns_.size();
    visit_J(tree, rows, [&](std::size_t, std::size_t i, double) { pair_columns_.push_back(column_[i]); });
    pairs_.push_back({first, entries_.size(), pair_columns_.size() - first});
    for (std::size_t i = first; i < pair_columns_.size(); ++i)
      for (std::size_t j = first; j <= i; ++j) entries_.push_back({pair_columns_[i], pair_columns_[j]});
  }
  H_.set_pattern(static_cast<int>(dofs_.size()), entries_, slots_);
}

void NewtonSystem::keep(const NewtonContext& context) {
  kept_dv_ = context.iterate.dv;
  kept_impulses_.clear();
  for (const PointImpulse<double>& point : context.iterate.points) kept_impulses_.push_back(point.impulse);
  for (const PointImpulse<double>& torsion : context.iterate.torsions) kept_impulses_.push_back(torsion.impulse);
}

void NewtonSystem::take_back(const NewtonContext& context) const {
  context.iterate.dv = kept_dv_;
  auto kept = kept_impulses_.begin();
  for (PointImpulse<double>& point : context.iterate.points) point.impulse = *kept++;
  for (PointImpulse<double>& torsion : context.iterate.torsions) torsion.impulse = *kept++;
}

void NewtonSystem::find_yielding(const NewtonContext& context, double softness) {
  const ContactProblem<double>& problem = context.problem;
  const auto inverse = [&](double size, double beside) {
    return size > 1e-12 * beside && size > 0 ? 1 / (softness * size) : 0.0;
  };
  point_yield_.clear();
  torsion_yield_.clear();
  for (const std::size_t i : points_) {
    const ContactPoint<double>& point = problem.points[i];
    const DelassusBlock<double>& G = context.factors.points[i];
    const double r = softness * (G.normal - point.softness) + point.softness;
    point_yield_.push_back({G.normal_inverse > 0 ? 1 / r : 0.0, inverse(tangent_size(G), 1e-6 * G.normal)});
    torsion_yield_.push_back({});
    if (point.torsion < 0) continue;
    const DelassusBlock<double>& rolling = context.factors.torsions[index(point.torsion)];
    const double spin = 1 / context.factors.spin_inverse[index(point.torsion)];
    torsion_yield_.back() = {inverse(spin, 0), inverse(0.5 * (rolling.sigma_1 + rolling.sigma_2), 1e-6 * spin)};
  }
  equality_yield_.clear();
  for (const std::size_t i : equalities_) {
    const EqualityRows<double>& block = context.problem.equalities[i];
    const Vec size = response_diagonal(context, block.rows);
    const double least = context.factors.K_immovable[block.first];  // of all its rows
    const Vec G{size.x > least ? size.x : 0, size.y > least ? size.y : 0, size.z > least ? size.z : 0};
    const double largest = std::max({G.x, G.y, G.z});
    equality_yield_.push_back({inverse(G.x, largest), inverse(G.y, largest), inverse(G.z, largest)});
  }
}

void NewtonSystem::evaluate(const NewtonContext& context, const std::vector<double>& x) {
  const ContactProblem<double>& problem = context.problem;
  point_law_.assign(points_.size(), {});
  torsion_law_.assign(points_.size(), {});
  equality_change_.assign(equalities_.size(), Vec::zero());
  slides_ = false;
  const bool follows = dofs_.size() <= contact_settings::kMaxUnsymmetric;
  const auto note_sliding = [&](const MultiplierLaw& law) { slides_ = slides_ || (follows && slides(law)); };
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const ContactPoint<double>& point = problem.points[points_[k]];
    const Yield& give = point_yield_[k];
    if (!(give.normal > 0)) continue;
    const double* dv = context.iterate.dv.data();
    const Vec u = context.factors.offsets[points_[k]] + point_velocity(problem, point, dv) +
                  point_velocity(problem, point, x.data());
    const Vec& y = context.iterate.points[points_[k]].impulse;
    const double n = y.x - give.normal * (u.x + point.softness * y.x);
    if (!(n > 0)) continue;
    MultiplierLaw& law = point_law_[k];
    law.impulse.x = n;
    law.slope.x = {give.normal, 0, 0};
    if (give.tangent > 0)
      project(y.y - give.tangent * u.y, y.z - give.tangent * u.z, n, 1, give.tangent, give.normal, law);
    note_sliding(law);
    if (point.torsion < 0) continue;
    const ContactTorsion<double>& torsion = problem.torsions[index(point.torsion)];
    const Yield& turns = torsion_yield_[k];
    const ContactPatch<double>& patch = problem.patches[point.patch];
    const Vec w = torsion.offset + multiply_J(context.tree(), patch.angular, problem.rows, dv) +
                  multiply_J(context.tree(), patch.angular, problem.rows, x.data());
    const Vec& m = context.iterate.torsions[index(point.torsion)].impulse;
    MultiplierLaw& turning = torsion_law_[k];
    const double spin = m.x - turns.normal * w.x, most = patch.spinning * n;
    turning.impulse.x = std::clamp(spin, -most, most);
    if (std::abs(spin) <= most) {
      turning.slope.x = {turns.normal, 0, 0};
    } else {
      turning.on_normal.x = std::copysign(patch.spinning * give.normal, spin);
    }
    if (patch.rolling > 0 && turns.tangent > 0)
      project(m.y - turns.tangent * w.y, m.z - turns.tangent * w.z, n, patch.rolling, turns.tangent, give.normal,
              turning);
    note_sliding(turning);
  }
  for (std::size_t k = 0; k < equalities_.size(); ++k) {
    const EqualityRows<double>& equality = context.problem.equalities[equalities_[k]];
    const Vec u = multiply_J(context.tree(), equality.rows, context.problem.rows, x.data());
    const Vec& give = equality_yield_[k];
    equality_change_[k] = {-give.x * u.x, -give.y * u.y, -give.z * u.z};
  }
}

double NewtonSystem::find_defect(const NewtonContext& context, const std::vector<double>& x) {
  evaluate(context, x);
  const ContactProblem<double>& problem = context.problem;
  defect_.resize(x.size());
  multiply_tree_matrix<double>(context.tree(), context.problem.M(), x.data(), defect_.data());
  for (std::size_t i = 0; i < x.size(); ++i) defect_[i] = -(defect_[i] + context.factors.penalty[i] * x[i]);
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const ContactPoint<double>& point = problem.points[points_[k]];
    const ContactPatch<double>& patch = problem.patches[point.patch];
    add_patch_JT(context.tree(), patch, problem.rows,
                 force_at(patch, point.lever, point_law_[k].impulse - context.iterate.points[points_[k]].impulse),
                 defect_.data());
    if (point.torsion < 0) continue;
    const Vec& old = context.iterate.torsions[index(point.torsion)].impulse;
    add_JT(context.tree(), patch.angular, problem.rows, torsion_law_[k].impulse - old, defect_.data());
  }
  for (std::size_t k = 0; k < equalities_.size(); ++k)
    add_JT(context.tree(), context.problem.equalities[equalities_[k]].rows, context.problem.rows, equality_change_[k],
           defect_.data());
  double square = 0;
  for (const std::size_t i : dofs_) square += defect_[i] * defect_[i];
  return std::sqrt(square);
}

/// J of one point's own rows, by dofs; valid until the next call.
const Vec* NewtonSystem::rows_of(const ContactProblem<double>& problem, const ContactPoint<double>& point,
                                 std::size_t count) {
  const ContactPatch<double>& patch = problem.patches[point.patch];
  rows_.resize(std::max(rows_.size(), count));
  for (std::size_t i = 0; i < count; ++i) {
    const Vec w = patch.turns ? problem.rows.J[patch.angular.J + i] : Vec::zero();
    rows_[i] = velocity_at(patch, point.lever, {w, problem.rows.J[patch.linear.J + i]});
  }
  return rows_.data();
}

void NewtonSystem::assemble(const NewtonContext& context) {
  const Tree<double>& tree = context.tree();
  const ContactProblem<double>& problem = context.problem;
  const std::span<double> H = H_.values();
  std::fill(H.begin(), H.end(), 0.0);
  auto slot = slots_.begin();
  for (const std::size_t i : dofs_) {
    const double* row = context.problem.M() + tree.M_row[i];
    H[*slot++] = row[i] + context.factors.penalty[i];
    for (int j = tree.dof_parent[i]; j >= 0; j = tree.dof_parent[index(j)]) H[*slot++] = row[j];
  }
  const auto add = [&](const Pair& pair, const Vec* J, const Mat3<double>& A) {
    const std::size_t* to = &slots_[pair.first_slot];
    for (std::size_t i = 0; i < pair.count; ++i) {
      const Vec row = J[i].x * A.x + J[i].y * A.y + J[i].z * A.z;
      for (std::size_t j = 0; j <= i; ++j) H[*to++] += dot(row, J[j]);
    }
  };
  for (std::size_t k = 0; k < points_.size(); ++k) {
    if (!(point_law_[k].impulse.x > 0)) continue;
    const ContactPoint<double>& point = problem.points[points_[k]];
    const Pair& pair = pairs_[point_pair_[k]];
    add(pair, rows_of(problem, point, pair.count), point_law_[k].slope);
    if (point.torsion >= 0) add(pair, &problem.rows.J[problem.patches[point.patch].angular.J], torsion_law_[k].slope);
  }
  for (std::size_t k = 0; k < equalities_.size(); ++k) {
    const Vec& give = equality_yield_[k];
    add(pairs_[equality_pair_[k]], &context.problem.rows.J[context.problem.equalities[equalities_[k]].rows.J],
        {{give.x, 0, 0}, {0, give.y, 0}, {0, 0, give.z}});
  }
}

/// H with all that friction follows.
void NewtonSystem::assemble_general(const NewtonContext& context) {
  general_.reset(static_cast<int>(dofs_.size()));
  H_.visit([&](int i, int j, double value) { general_.at(i, j) = general_.at(j, i) = value; });
  const ContactProblem<double>& problem = context.problem;
  const auto follow = [&](const Pair& pair, const Vec* J, const Vec* normal, const Vec& on_normal) {
    const int* columns = &pair_columns_[pair.first_column];
    for (std::size_t i = 0; i < pair.count; ++i) {
      const double row = dot(J[i], on_normal);
      for (std::size_t j = 0; j < pair.count; ++j) general_.at(columns[i], columns[j]) += row * normal[j].x;
    }
  };
  for (std::size_t k = 0; k < points_.size(); ++k) {
    if (!(point_law_[k].impulse.x > 0)) continue;
    const ContactPoint<double>& point = problem.points[points_[k]];
    const Pair& pair = pairs_[point_pair_[k]];
    const Vec* J = rows_of(problem, point, pair.count);
    if (slides(point_law_[k])) follow(pair, J, J, point_law_[k].on_normal);
    if (point.torsion >= 0 && slides(torsion_law_[k]))
      follow(pair, &problem.rows.J[problem.patches[point.patch].angular.J], J, torsion_law_[k].on_normal);
  }
}

bool NewtonSystem::solve(const NewtonContext& context) {
  assemble(context);
  step_.resize(dofs_.size());
  for (std::size_t i = 0; i < dofs_.size(); ++i) step_[i] = defect_[dofs_[i]];
  if (slides_) {
    assemble_general(context);
    return general_.solve(step_);
  }
  if (!H_.factor()) return false;
  H_.solve(step_);
  return std::all_of(step_.begin(), step_.end(), [](double x) { return std::isfinite(x); });
}

void NewtonSystem::outer_step(const NewtonContext& context, double softness, int most_factorisations) {
  find_yielding(context, softness);
  x_.assign(context.iterate.dv.size(), 0);
  double before = find_defect(context, x_);
  for (int k = 0; k < most_factorisations && before > 0; ++k) {
    if (!solve(context)) break;
    double best = std::numeric_limits<double>::infinity(), best_length = 0, at = 0;
    for (const double fraction : {1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125}) {
      trial_ = x_;
      for (std::size_t i = 0; i < dofs_.size(); ++i) trial_[dofs_[i]] += fraction * step_[i];
      const double norm = find_defect(context, trial_);
      at = fraction;
      if (norm < best) {
        best = norm;
        best_length = fraction;
      }
      if (norm < (1 - 0.1 * fraction) * before) break;
    }
    for (std::size_t i = 0; i < dofs_.size(); ++i) x_[dofs_[i]] += best_length * step_[i];
    if (at != best_length) find_defect(context, x_);
    const bool done = best < 1e-3 * before;
    before = best;
    if (done) break;
  }
  apply(context);
}

void NewtonSystem::apply(const NewtonContext& context) {
  Iterate<double>& iterate = context.iterate;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const ContactPoint<double>& point = context.problem.points[points_[k]];
    const ContactPatch<double>& patch = context.problem.patches[point.patch];
    Vec& impulse = iterate.points[points_[k]].impulse;
    Force<double> change = force_at(patch, point.lever, point_law_[k].impulse - impulse);
    impulse = point_law_[k].impulse;
    if (point.torsion >= 0) {
      Vec& moment = iterate.torsions[index(point.torsion)].impulse;
      change.n += torsion_law_[k].impulse - moment;
      moment = torsion_law_[k].impulse;
    }
    add_patch_YT(patch, context.factors.Y.data(), change, iterate.y.data());
  }
  apply_change(context.problem, context.factors, iterate);
}

}  // namespace manyhands::internal
