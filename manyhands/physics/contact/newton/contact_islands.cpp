#include "manyhands/physics/contact/newton/contact_islands.h"

#include <algorithm>

#include "manyhands/physics/contact/newton/law_residual.h"

namespace manyhands::internal {

namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// The first dof of the clusters that rows act on, or -1.
int first_of(const RowBlock& rows) {
  if (rows.begin_a < rows.end_a) return rows.begin_a;
  return rows.begin_b < rows.end_b ? rows.begin_b : -1;
}

}  // namespace

double ContactIsland::residual(const NewtonContext& context) const {
  double worst = 0;
  for (const std::size_t k : patches) worst = std::max(worst, patch_residual(context, context.problem.patches[k]));
  return worst;
}

double ContactIsland::opening(const NewtonContext& context) const {
  double fastest = 0;
  for (const std::size_t k : patches) {
    const ContactPatch<double>& patch = context.problem.patches[k];
    for (std::size_t i = patch.first; i < patch.first + patch.count; ++i)
      fastest = std::max(fastest, asked_opening(context.problem, context.factors, i));
  }
  return fastest;
}

int ContactIslands::root_of(int dof) {
  while (next_[index(dof)] != dof) dof = next_[index(dof)];
  return dof;
}

std::size_t ContactIslands::island_of(const RowBlock& rows) {
  const int first = first_of(rows);
  const int number = first < 0 ? -1 : number_[index(root_of(first))];
  return number < 0 ? kNone : index(number);
}

void ContactIslands::find(const NewtonContext& context) {
  const ContactProblem<double>& problem = context.problem;
  const auto nv = index(context.tree().nv);
  next_.resize(nv);
  for (std::size_t i = 0; i < nv; ++i) next_[i] = static_cast<int>(i);
  for (const ContactPatch<double>& patch : problem.patches) {
    const RowBlock& rows = patch.linear;
    if (rows.begin_a == rows.end_a || rows.begin_b == rows.end_b) continue;
    const int a = root_of(rows.begin_a), b = root_of(rows.begin_b);
    next_[index(std::max(a, b))] = std::min(a, b);
  }
  number_.assign(nv, -1);
  size_ = 0;
  for (std::size_t k = 0; k < problem.patches.size(); ++k) {
    const int first = first_of(problem.patches[k].linear);
    if (first < 0) continue;
    int& number = number_[index(root_of(first))];
    if (number < 0) {
      number = static_cast<int>(size_++);
      if (islands_.size() < size_) islands_.emplace_back();
      islands_[size_ - 1].patches.clear();
      islands_[size_ - 1].equalities.clear();
    }
    islands_[index(number)].patches.push_back(k);
  }
  for (std::size_t k = 0; k < problem.equalities.size(); ++k) {
    const std::size_t island = island_of(problem.equalities[k].rows);
    if (island != kNone) islands_[island].equalities.push_back(k);
  }
}

}  // namespace manyhands::internal
