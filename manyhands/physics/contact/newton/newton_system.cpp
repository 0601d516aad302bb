#include "manyhands/physics/contact/newton/newton_system.h"

#include <algorithm>
#include <cmath>

#include "manyhands/physics/contact/gauss_seidel.h"
#include "manyhands/physics/dynamics/ltdl.h"

namespace manyhands::internal {

namespace {

using Vec = Vec3<double>;

/// Calls body(J_i^T slope J_j) for dofs j <= i, of which v and w are the rows; without rows w where that is null.
template <class Body>
void visit_products(const Vec* v, const Vec* w, const PatchSlope& slope, std::size_t count, Body&& body) {
  for (std::size_t i = 0; i < count; ++i) {
    if (w == nullptr) {
      const Vec on_v = slope.vv * v[i];
      for (std::size_t j = 0; j <= i; ++j) body(dot(on_v, v[j]));
      continue;
    }
    const Vec on_v = slope.vv * v[i] + slope.vw * w[i], on_w = slope.wv * v[i] + slope.ww * w[i];
    for (std::size_t j = 0; j <= i; ++j) body(dot(on_v, v[j]) + dot(on_w, w[j]));
  }
}

/// Calls body(impulse) for every impulse of contacts and torsions of the patches.
template <class Body>
void visit_impulses(const NewtonContext& context, const std::vector<std::size_t>& patches, Body&& body) {
  for (const std::size_t k : patches) {
    const ContactPatch<double>& patch = context.problem.patches[k];
    for (std::size_t i = patch.first; i < patch.first + patch.count; ++i) {
      body(context.iterate.points[i].impulse);
      const int torsion = context.problem.points[i].torsion;
      if (torsion >= 0) body(context.iterate.torsions[index(torsion)].impulse);
    }
  }
}

}  // namespace

void NewtonSystem::find_dofs(const NewtonContext& context) {
  takes_part_.assign(index(context.tree().nv), false);
  const auto mark = [&](const RowBlock& rows) {
    std::fill(takes_part_.begin() + rows.begin_a, takes_part_.begin() + rows.end_a, true);
    std::fill(takes_part_.begin() + rows.begin_b, takes_part_.begin() + rows.end_b, true);
  };
  for (const std::size_t i : laws_.patches) mark(context.problem.patches[i].linear);
  for (const std::size_t i : laws_.equalities) mark(context.problem.equalities[i].rows);
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

void NewtonSystem::choose(const NewtonContext& context, const ContactIsland& island) {
  laws_.patches = island.patches;
  laws_.equalities = island.equalities;
  key_.clear();
  find_dofs(context);
  pair_rows_.clear();
  patch_pair_.clear();
  equality_pair_.clear();
  for (const std::size_t i : laws_.patches) patch_pair_.push_back(pair_of(context.problem.patches[i].linear));
  for (const std::size_t i : laws_.equalities) equality_pair_.push_back(pair_of(context.problem.equalities[i].rows));
  if (key_ != last_key_) {
    last_key_ = key_;
    find_columns(context.tree());
    find_pattern(context.tree());
  }
  free_dofs_.clear();
  for (const int i : context.factors.free_dofs)
    if (takes_part_[index(i)]) free_dofs_.push_back(i);
  step_.assign(takes_part_.size(), 0);
  for (std::vector<double>* numbers : {&defect_, &momentum_, &step_momentum_}) numbers->resize(takes_part_.size());
  make_room(context);
}

/// So that no step allocates because more contacts slide.
void NewtonSystem::make_room(const NewtonContext& context) {
  std::size_t points = 0;
  for (const std::size_t i : laws_.patches) points += context.problem.patches[i].count;
  const std::size_t most = std::min(points, contact_settings::kMaxFollowing);
  following_.reserve(points);
  answers_.reserve((most + SparseLdl::kSeveral) * dofs_.size());
  correction_.reserve(most);
  small_.reset(static_cast<int>(most));
}

/// Trees in the order of minimum degree, each from its leaves: within M's pattern that fills nothing in.
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
    for (int j = static_cast<int>(i); j >= 0; j = tree.M_parent[index(j)])
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
  kept_dv_.clear();
  kept_impulses_.clear();
  for (const std::size_t i : dofs_) kept_dv_.push_back(context.iterate.dv[i]);
  visit_impulses(context, laws_.patches, [&](const Vec& impulse) { kept_impulses_.push_back(impulse); });
}

void NewtonSystem::take_back(const NewtonContext& context) const {
  auto dv = kept_dv_.begin();
  auto kept = kept_impulses_.begin();
  for (const std::size_t i : dofs_) context.iterate.dv[i] = *dv++;
  visit_impulses(context, laws_.patches, [&](Vec& impulse) { impulse = *kept++; });
}

void NewtonSystem::iterate(const NewtonContext& context, int count) const {
  Iterate<double>& iterate = context.iterate;
  const ContactProblem<double>& problem = context.problem;
  for (const std::size_t k : laws_.patches)
    iterate.patches[k].start = patch_motion(*problem.tree, problem.patches[k], problem.rows, iterate.dv.data());
  double largest = 0;
  for (int n = 0; n < count; ++n)
    for (const std::size_t k : laws_.patches) relax_patch(problem, context.factors, k, true, iterate, largest);
  apply_change(context);
}

/// dv += B y, and y = 0, over the island.
void NewtonSystem::apply_change(const NewtonContext& context) const {
  add_change(context.problem, context.factors, std::span<const int>(free_dofs_), context.iterate);
  for (const int k : free_dofs_) context.iterate.y[index(k)] = 0;
}

/// M with the penalties of held tendons.
const double* NewtonSystem::inertia(const NewtonContext& context) {
  const Tree<double>& tree = context.tree();
  const double* const M = context.problem.M();
  if (tree.lengths.empty()) return M;
  M_.assign(M, M + tree.M_size);
  for (std::size_t k = 0; k < tree.lengths.size(); ++k)
    add_length_square(tree, *context.problem.dynamics, k, context.factors.penalty[index(tree.nv) + k], M_.data(),
                      [](std::size_t) { return 1.0; });
  return M_.data();
}

/// H += J^T slope J.
void NewtonSystem::add_products(const Pair& pair, const Vec* v, const Vec* w, const PatchSlope& slope) {
  const std::span<double> H = H_.values();
  const std::size_t* to = &slots_[pair.first_slot];
  visit_products(v, w, slope, pair.count, [&](double value) { H[*to++] += value; });
}

void NewtonSystem::assemble(const NewtonContext& context) {
  const Tree<double>& tree = context.tree();
  const ContactProblem<double>& problem = context.problem;
  const std::span<double> H = H_.values();
  std::fill(H.begin(), H.end(), 0.0);
  auto slot = slots_.begin();
  const double* const M = inertia(context);
  for (const std::size_t i : dofs_) {
    const double* row = M + tree.M_row[i];
    H[*slot++] = row[i] + context.factors.penalty[i];
    for (int j = tree.M_parent[i]; j >= 0; j = tree.M_parent[index(j)]) H[*slot++] = row[j];
  }
  for (std::size_t k = 0; k < laws_.patches.size(); ++k) {
    if (!laws_.presses(k)) continue;
    const ContactPatch<double>& patch = problem.patches[laws_.patches[k]];
    add_products(pairs_[patch_pair_[k]], &problem.rows.J[patch.linear.J],
                 patch.turns ? &problem.rows.J[patch.angular.J] : nullptr, laws_.patch_slope(context, k));
  }
  for (std::size_t k = 0; k < laws_.equalities.size(); ++k) {
    const Vec* J = &problem.rows.J[problem.equalities[laws_.equalities[k]].rows.J];
    add_products(pairs_[equality_pair_[k]], J, nullptr, laws_.equality_slope(k));
  }
}

/// step_ := the step of Newton's method from the present defect; false where there is none.
bool NewtonSystem::solve(const NewtonContext& context) {
  assemble(context);
  if (!H_.factor()) return false;
  solution_.resize(dofs_.size());
  for (std::size_t i = 0; i < dofs_.size(); ++i) solution_[i] = defect_[dofs_[i]];
  H_.solve(solution_);
  laws_.find_following(context, following_);
  if (!following_.empty() && following_.size() <= contact_settings::kMaxFollowing) follow_normals(context);
  if (!std::ranges::all_of(solution_, [](double x) { return std::isfinite(x); })) return false;
  for (std::size_t i = 0; i < dofs_.size(); ++i) step_[dofs_[i]] = solution_[i];
  return true;
}

/// Adds to H what makes it unsymmetric, A B^T with a column for each contact that slides, and to the solution what that
/// changes (Sherman, Morrison and Woodbury): x - Z (1 + B^T Z)^-1 B^T x, Z = H^-1 A. Without it where that has none.
void NewtonSystem::follow_normals(const NewtonContext& context) {
  constexpr std::size_t kSeveral = SparseLdl::kSeveral;
  const std::size_t m = following_.size(), n = dofs_.size(), block = n * kSeveral;
  answers_.assign((m + kSeveral - 1) / kSeveral * block, 0);
  const auto visit_dofs = [&](const Following& one, auto&& body) {
    const ContactPatch<double>& patch = context.problem.patches[laws_.patches[one.patch]];
    const Pair& pair = pairs_[patch_pair_[one.patch]];
    const Vec* v = &context.problem.rows.J[patch.linear.J];
    const Vec* w = patch.turns ? &context.problem.rows.J[patch.angular.J] : nullptr;
    for (std::size_t i = 0; i < pair.count; ++i)
      body(index(pair_columns_[pair.first_column + i]), v[i], w != nullptr ? w[i] : Vec::zero());
  };
  for (std::size_t k = 0; k < m; ++k) {
    double* const A = &answers_[k / kSeveral * block + k % kSeveral];
    const Force<double>& force = following_[k].force;
    visit_dofs(following_[k], [&](std::size_t i, const Vec& v, const Vec& w) {
      A[i * kSeveral] += dot(force.f, v) + dot(force.n, w);
    });
  }
  for (std::size_t begin = 0; begin < answers_.size(); begin += block)
    H_.solve_several(std::span(answers_).subspan(begin, block));
  if (!find_correction(visit_dofs)) return;
  for (std::size_t k = 0; k < m; ++k) {
    const double* const Z = &answers_[k / kSeveral * block + k % kSeveral];
    for (std::size_t i = 0; i < n; ++i) solution_[i] -= correction_[k] * Z[i * kSeveral];
  }
}

/// correction_ := (1 + B^T Z)^-1 B^T x; false where there is none.
template <class VisitDofs>
bool NewtonSystem::find_correction(const VisitDofs& visit_dofs) {
  constexpr std::size_t kSeveral = SparseLdl::kSeveral;
  static_assert(DenseLu::kBlock % kSeveral == 0);
  const std::size_t m = following_.size(), block = dofs_.size() * kSeveral;
  correction_.assign(m, 0);
  small_.reset(static_cast<int>(m));
  for (std::size_t k = 0; k < m; ++k) {
    const Motion<double>& normal = following_[k].normal;
    const std::span<double> row = small_.row(static_cast<int>(k));
    row[k] = 1;
    visit_dofs(following_[k], [&](std::size_t i, const Vec& v, const Vec& w) {
      const double b = dot(normal.v, v) + dot(normal.w, w);
      correction_[k] += b * solution_[i];
      for (std::size_t j = 0; j < m; j += kSeveral) {
        const double* const Z = &answers_[j / kSeveral * block + i * kSeveral];
        for (std::size_t l = 0; l < kSeveral; ++l) row[j + l] += b * Z[l];
      }
    });
  }
  return small_.solve(correction_);
}

/// (M + penalty) x, for x (nv) that is 0 elsewhere.
void NewtonSystem::multiply_M(const NewtonContext& context, const std::vector<double>& x, std::vector<double>& y) {
  const Tree<double>& tree = context.tree();
  for (const std::size_t i : dofs_) y[i] = context.factors.penalty[i] * x[i];
  for (const std::size_t i : dofs_) {
    const double* const row = context.problem.M() + tree.M_row[i];
    y[i] += row[i] * x[i];
    for (int j = tree.M_parent[i]; j >= 0; j = tree.M_parent[index(j)]) {
      y[i] += row[j] * x[index(j)];
      y[index(j)] += row[j] * x[i];
    }
  }
  for (std::size_t k = 0; k < tree.lengths.size(); ++k) {
    const Workspace<double>& ws = *context.problem.dynamics;
    const double pull = context.factors.penalty[x.size() + k] * along_length(tree, ws, k, x.data());
    add_along_length(tree, ws, k, pull, y.data());
  }
}

/// J^T (impulses - present ones) - (M + penalty) (x + t step); its norm.
double NewtonSystem::find_defect(const NewtonContext& context, double t) {
  laws_.evaluate(context, velocities_, t, step_velocities_);
  for (const std::size_t i : dofs_) defect_[i] = -(momentum_[i] + t * step_momentum_[i]);
  laws_.add_changes(context, defect_.data());
  double square = 0;
  for (const std::size_t i : dofs_) square += defect_[i] * defect_[i];
  return std::sqrt(square);
}

/// The first of the lengths that makes the defect clearly smaller, or the one that makes it least; the defect there.
double NewtonSystem::search_line(const NewtonContext& context, double before, double& length) {
  multiply_M(context, step_, step_momentum_);
  laws_.multiply_J(context, step_.data(), step_velocities_);
  double best = std::numeric_limits<double>::infinity(), at = 0;
  for (const double t : {1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125}) {
    at = t;
    if (const double norm = find_defect(context, t); norm < best) {
      best = norm;
      length = t;
    }
    if (best < (1 - 0.1 * length) * before) break;
  }
  if (at != length) find_defect(context, length);
  return best;
}

int NewtonSystem::outer_step(const NewtonContext& context, double softness, int most_factorisations) {
  laws_.begin(context, softness, velocities_);
  laws_.multiply_J(context, context.iterate.dv.data(), step_velocities_);
  for (Vec& u : step_velocities_.equalities) u = Vec::zero();  // they hold, but for what the step changes
  add_velocities(1);
  for (const std::size_t i : dofs_) step_[i] = momentum_[i] = step_momentum_[i] = 0;
  double defect = find_defect(context, 0);
  const double enough = contact_settings::kInnerGain * defect;
  int factorisations = 0;
  while (factorisations < most_factorisations && defect > enough) {
    ++factorisations;
    if (!solve(context)) break;
    double length = 0;
    defect = search_line(context, defect, length);
    add_velocities(length);
    for (const std::size_t i : dofs_) momentum_[i] += length * step_momentum_[i];
  }
  is_solved_ = defect <= contact_settings::kSolved * enough;
  laws_.apply(context);
  apply_change(context);
  return factorisations;
}

/// The velocities after a part of the step.
void NewtonSystem::add_velocities(double t) {
  const auto add = [t](std::vector<Vec>& to, const std::vector<Vec>& change) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = fma(t, change[i], to[i]);
  };
  add(velocities_.points, step_velocities_.points);
  add(velocities_.torsions, step_velocities_.torsions);
  add(velocities_.equalities, step_velocities_.equalities);
}

}  // namespace manyhands::internal
