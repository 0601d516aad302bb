#include "manyhands/physics/contact/newton_system.h"

#include <algorithm>
#include <cmath>

#include "manyhands/physics/contact/law_residual.h"
#include "manyhands/physics/dynamics/ltdl.h"

namespace manyhands::internal {

namespace {

using Vec = Vec3<double>;

/// How friction follows the normal impulse makes H unsymmetric. Where LU's price is too high for the larger systems, H
/// goes without it: Newton's method then converges linearly where contacts slide.
constexpr std::size_t kMostGeneral = 60;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

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

/// J A J^T of one loop's rows: its diagonal.
Vec loop_size(const ContactProblem& problem, const RowBlock& rows) {
  const RowStore<double>& store = problem.loops.store;
  Vec G = Vec::zero();
  visit_answer(rows, [&](std::size_t entry, std::size_t) {
    const Vec& Y = store.Y[entry];
    G = G + Vec{Y.x * Y.x, Y.y * Y.y, Y.z * Y.z};
  });
  return G;
}

}  // namespace

int NewtonSystem::root(int cluster) {
  while (island_[index(cluster)] != cluster) cluster = island_[index(cluster)];
  return cluster;
}

void NewtonSystem::choose_islands(const ContactProblem& problem, double tolerance) {
  const auto nv = index(problem.tree.nv);
  island_.resize(nv);
  for (std::size_t i = 0; i < nv; ++i) island_[i] = static_cast<int>(i);
  const auto first_of = [](const RowBlock& rows) { return rows.begin_a < rows.end_a ? rows.begin_a : rows.begin_b; };
  const auto moves = [](const RowBlock& rows) { return rows.begin_a < rows.end_a || rows.begin_b < rows.end_b; };
  for (const ContactPoint<double>& point : problem.contacts.points) {
    if (point.rows.begin_a == point.rows.end_a || point.rows.begin_b == point.rows.end_b) continue;
    const int a = root(point.rows.begin_a), b = root(point.rows.begin_b);
    island_[index(std::max(a, b))] = std::min(a, b);
  }
  island_residual_.assign(nv, 0);
  for (const ContactPoint<double>& point : problem.contacts.points) {
    if (!moves(point.rows)) continue;
    double& worst = island_residual_[index(root(first_of(point.rows)))];
    worst = std::max(worst, point_residual(problem, point));
  }
  points_.clear();
  loops_.clear();
  const auto takes_part = [&](const RowBlock& rows) {
    return moves(rows) && island_residual_[index(root(first_of(rows)))] > tolerance;
  };
  for (std::size_t i = 0; i < problem.contacts.points.size(); ++i)
    if (takes_part(problem.contacts.points[i].rows)) points_.push_back(i);
  for (std::size_t i = 0; i < problem.loops.blocks.size(); ++i)
    if (takes_part(problem.loops.blocks[i].rows)) loops_.push_back(i);
}

void NewtonSystem::find_dofs(const ContactProblem& problem) {
  takes_part_.assign(index(problem.tree.nv), false);
  const auto mark = [&](const RowBlock& rows) {
    std::fill(takes_part_.begin() + rows.begin_a, takes_part_.begin() + rows.end_a, true);
    std::fill(takes_part_.begin() + rows.begin_b, takes_part_.begin() + rows.end_b, true);
  };
  for (const std::size_t i : points_) mark(problem.contacts.points[i].rows);
  for (const std::size_t i : loops_) mark(problem.loops.blocks[i].rows);
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

void NewtonSystem::choose(const ContactProblem& problem, double tolerance) {
  choose_islands(problem, tolerance);
  key_.clear();
  find_dofs(problem);
  pair_rows_.clear();
  point_pair_.clear();
  loop_pair_.clear();
  for (const std::size_t i : points_) point_pair_.push_back(pair_of(problem.contacts.points[i].rows));
  for (const std::size_t i : loops_) loop_pair_.push_back(pair_of(problem.loops.blocks[i].rows));
  if (key_ == last_key_) return;
  last_key_ = key_;
  find_columns(problem.tree);
  find_pattern(problem.tree);
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
    visit_rows<double>(tree, rows, [&](std::size_t, std::size_t i, double) { pair_columns_.push_back(column_[i]); });
    pairs_.push_back({first, entries_.size(), pair_columns_.size() - first});
    for (std::size_t i = first; i < pair_columns_.size(); ++i)
      for (std::size_t j = first; j <= i; ++j) entries_.push_back({pair_columns_[i], pair_columns_[j]});
  }
  H_.set_pattern(static_cast<int>(dofs_.size()), entries_, slots_);
}

void NewtonSystem::keep(const ContactProblem& problem) {
  kept_dv_ = problem.joints.dv;
  kept_impulses_.clear();
  for (const ContactPoint<double>& point : problem.contacts.points) kept_impulses_.push_back(point.impulse);
  for (const ContactTorsion<double>& torsion : problem.contacts.torsions) kept_impulses_.push_back(torsion.impulse);
}

void NewtonSystem::take_back(const ContactProblem& problem) const {
  problem.joints.dv = kept_dv_;
  auto kept = kept_impulses_.begin();
  for (ContactPoint<double>& point : problem.contacts.points) point.impulse = *kept++;
  for (ContactTorsion<double>& torsion : problem.contacts.torsions) torsion.impulse = *kept++;
}

void NewtonSystem::find_yielding(const ContactProblem& problem, double softness) {
  const ContactSet<double>& set = problem.contacts;
  const auto inverse = [&](double size, double beside) {
    return size > 1e-12 * beside && size > 0 ? 1 / (softness * size) : 0.0;
  };
  point_yield_.clear();
  torsion_yield_.clear();
  for (const std::size_t i : points_) {
    const ContactPoint<double>& point = set.points[i];
    const ContactStiffness<double>& G = point.stiffness;
    const double r = softness * (G.normal - point.softness) + point.softness;
    point_yield_.push_back({G.normal_inverse > 0 ? 1 / r : 0.0, inverse(tangent_size(G), 1e-6 * G.normal)});
    torsion_yield_.push_back({});
    if (point.torsion < 0) continue;
    const ContactTorsion<double>& torsion = set.torsions[index(point.torsion)];
    const double spin = 1 / torsion.spin_inverse;
    torsion_yield_.back() = {inverse(spin, 0),
                             inverse(0.5 * (torsion.stiffness.sigma_1 + torsion.stiffness.sigma_2), 1e-6 * spin)};
  }
  loop_yield_.clear();
  for (const std::size_t i : loops_) {
    const Vec G = loop_size(problem, problem.loops.blocks[i].rows);
    const double largest = std::max({G.x, G.y, G.z});
    loop_yield_.push_back({inverse(G.x, largest), inverse(G.y, largest), inverse(G.z, largest)});
  }
}

void NewtonSystem::evaluate(const ContactProblem& problem, const std::vector<double>& x) {
  const ContactSet<double>& set = problem.contacts;
  point_law_.assign(points_.size(), {});
  torsion_law_.assign(points_.size(), {});
  loop_change_.assign(loops_.size(), Vec::zero());
  slides_ = false;
  const bool follows = dofs_.size() <= kMostGeneral;
  const auto note_sliding = [&](const MultiplierLaw& law) { slides_ = slides_ || (follows && slides(law)); };
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const ContactPoint<double>& point = set.points[points_[k]];
    const Yield& give = point_yield_[k];
    if (!(give.normal > 0)) continue;
    const double* dv = problem.joints.dv.data();
    const Vec u = point.offset + point_velocity(problem.tree, set, point, dv) +
                  point_velocity(problem.tree, set, point, x.data());
    const Vec& y = point.impulse;
    const double n = y.x - give.normal * (u.x + point.softness * y.x);
    if (!(n > 0)) continue;
    MultiplierLaw& law = point_law_[k];
    law.impulse.x = n;
    law.slope.x = {give.normal, 0, 0};
    if (give.tangent > 0)
      project(y.y - give.tangent * u.y, y.z - give.tangent * u.z, n, 1, give.tangent, give.normal, law);
    note_sliding(law);
    if (point.torsion < 0) continue;
    const ContactTorsion<double>& torsion = set.torsions[index(point.torsion)];
    const Yield& turns = torsion_yield_[k];
    const Vec w = torsion.offset + multiply_rows(problem.tree, torsion.rows, set.store, dv) +
                  multiply_rows(problem.tree, torsion.rows, set.store, x.data());
    const Vec& m = torsion.impulse;
    MultiplierLaw& turning = torsion_law_[k];
    const double spin = m.x - turns.normal * w.x, most = torsion.spinning * n;
    turning.impulse.x = std::clamp(spin, -most, most);
    if (std::abs(spin) <= most) {
      turning.slope.x = {turns.normal, 0, 0};
    } else {
      turning.on_normal.x = std::copysign(torsion.spinning * give.normal, spin);
    }
    if (torsion.rolling > 0 && turns.tangent > 0)
      project(m.y - turns.tangent * w.y, m.z - turns.tangent * w.z, n, torsion.rolling, turns.tangent, give.normal,
              turning);
    note_sliding(turning);
  }
  for (std::size_t k = 0; k < loops_.size(); ++k) {
    const LoopRows<double>& loop = problem.loops.blocks[loops_[k]];
    const Vec u = multiply_rows(problem.tree, loop.rows, problem.loops.store, x.data());
    const Vec& give = loop_yield_[k];
    loop_change_[k] = {-give.x * u.x, -give.y * u.y, -give.z * u.z};
  }
}

double NewtonSystem::find_defect(const ContactProblem& problem, const std::vector<double>& x) {
  evaluate(problem, x);
  const ContactSet<double>& set = problem.contacts;
  defect_.resize(x.size());
  multiply_tree_matrix<double>(problem.tree, problem.dynamics.M.data(), x.data(), defect_.data());
  for (std::size_t i = 0; i < x.size(); ++i) defect_[i] = -(defect_[i] + problem.joints.spring[i] * x[i]);
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const ContactPoint<double>& point = set.points[points_[k]];
    const ContactPatch<double>& patch = set.patches[point.patch];
    add_patch_force(problem.tree, patch, set.store, force_at(patch, point.lever, point_law_[k].impulse - point.impulse),
                    defect_.data());
    if (point.torsion < 0) continue;
    const ContactTorsion<double>& torsion = set.torsions[index(point.torsion)];
    add_row_impulse(problem.tree, torsion.rows, set.store, torsion_law_[k].impulse - torsion.impulse, defect_.data());
  }
  for (std::size_t k = 0; k < loops_.size(); ++k)
    add_row_impulse(problem.tree, problem.loops.blocks[loops_[k]].rows, problem.loops.store, loop_change_[k],
                    defect_.data());
  double square = 0;
  for (const std::size_t i : dofs_) square += defect_[i] * defect_[i];
  return std::sqrt(square);
}

/// J of one point's own rows, by dofs; valid until the next call.
const Vec* NewtonSystem::rows_of(const ContactSet<double>& set, const ContactPoint<double>& point, std::size_t count) {
  const ContactPatch<double>& patch = set.patches[point.patch];
  rows_.resize(std::max(rows_.size(), count));
  for (std::size_t i = 0; i < count; ++i) {
    const Vec w = patch.turns ? set.store.J[patch.angular.J + i] : Vec::zero();
    rows_[i] = velocity_at(patch, point.lever, {w, set.store.J[patch.linear.J + i]});
  }
  return rows_.data();
}

void NewtonSystem::assemble(const ContactProblem& problem) {
  const Tree<double>& tree = problem.tree;
  const ContactSet<double>& set = problem.contacts;
  const std::span<double> H = H_.values();
  std::fill(H.begin(), H.end(), 0.0);
  auto slot = slots_.begin();
  for (const std::size_t i : dofs_) {
    const double* row = problem.dynamics.M.data() + tree.M_row[i];
    H[*slot++] = row[i] + problem.joints.spring[i];
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
    const ContactPoint<double>& point = set.points[points_[k]];
    const Pair& pair = pairs_[point_pair_[k]];
    add(pair, rows_of(set, point, pair.count), point_law_[k].slope);
    if (point.torsion >= 0) add(pair, &set.store.J[set.torsions[index(point.torsion)].rows.J], torsion_law_[k].slope);
  }
  for (std::size_t k = 0; k < loops_.size(); ++k) {
    const Vec& give = loop_yield_[k];
    add(pairs_[loop_pair_[k]], &problem.loops.store.J[problem.loops.blocks[loops_[k]].rows.J],
        {{give.x, 0, 0}, {0, give.y, 0}, {0, 0, give.z}});
  }
}

/// H with all that friction follows.
void NewtonSystem::assemble_general(const ContactProblem& problem) {
  general_.reset(static_cast<int>(dofs_.size()));
  H_.visit([&](int i, int j, double value) { general_.at(i, j) = general_.at(j, i) = value; });
  const ContactSet<double>& set = problem.contacts;
  const auto follow = [&](const Pair& pair, const Vec* J, const Vec* normal, const Vec& on_normal) {
    const int* columns = &pair_columns_[pair.first_column];
    for (std::size_t i = 0; i < pair.count; ++i) {
      const double row = dot(J[i], on_normal);
      for (std::size_t j = 0; j < pair.count; ++j) general_.at(columns[i], columns[j]) += row * normal[j].x;
    }
  };
  for (std::size_t k = 0; k < points_.size(); ++k) {
    if (!(point_law_[k].impulse.x > 0)) continue;
    const ContactPoint<double>& point = set.points[points_[k]];
    const Pair& pair = pairs_[point_pair_[k]];
    const Vec* J = rows_of(set, point, pair.count);
    if (slides(point_law_[k])) follow(pair, J, J, point_law_[k].on_normal);
    if (point.torsion >= 0 && slides(torsion_law_[k]))
      follow(pair, &set.store.J[set.torsions[index(point.torsion)].rows.J], J, torsion_law_[k].on_normal);
  }
}

bool NewtonSystem::solve(const ContactProblem& problem) {
  assemble(problem);
  step_.resize(dofs_.size());
  for (std::size_t i = 0; i < dofs_.size(); ++i) step_[i] = defect_[dofs_[i]];
  if (slides_) {
    assemble_general(problem);
    return general_.solve(step_);
  }
  if (!H_.factor()) return false;
  H_.solve(step_);
  return std::all_of(step_.begin(), step_.end(), [](double x) { return std::isfinite(x); });
}

void NewtonSystem::outer_step(const ContactProblem& problem, double softness, int most_factorisations) {
  find_yielding(problem, softness);
  x_.assign(problem.joints.dv.size(), 0);
  double before = find_defect(problem, x_);
  for (int k = 0; k < most_factorisations && before > 0; ++k) {
    if (!solve(problem)) break;
    double best = std::numeric_limits<double>::infinity(), best_length = 0, at = 0;
    for (const double fraction : {1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125}) {
      trial_ = x_;
      for (std::size_t i = 0; i < dofs_.size(); ++i) trial_[dofs_[i]] += fraction * step_[i];
      const double norm = find_defect(problem, trial_);
      at = fraction;
      if (norm < best) {
        best = norm;
        best_length = fraction;
      }
      if (norm < (1 - 0.1 * fraction) * before) break;
    }
    for (std::size_t i = 0; i < dofs_.size(); ++i) x_[dofs_[i]] += best_length * step_[i];
    if (at != best_length) find_defect(problem, x_);
    const bool done = best < 1e-3 * before;
    before = best;
    if (done) break;
  }
  apply(problem);
}

void NewtonSystem::apply(const ContactProblem& problem) {
  ContactSet<double>& set = problem.contacts;
  begin_change(set.store);
  for (std::size_t k = 0; k < points_.size(); ++k) {
    ContactPoint<double>& point = set.points[points_[k]];
    const ContactPatch<double>& patch = set.patches[point.patch];
    Force<double> change = force_at(patch, point.lever, point_law_[k].impulse - point.impulse);
    point.impulse = point_law_[k].impulse;
    if (point.torsion >= 0) {
      ContactTorsion<double>& torsion = set.torsions[index(point.torsion)];
      change.n += torsion_law_[k].impulse - torsion.impulse;
      torsion.impulse = torsion_law_[k].impulse;
    }
    apply_patch_force(patch, change, set.store);
  }
  end_change(problem.tree, problem.dynamics, set.store, problem.joints);
}

}  // namespace manyhands::internal
