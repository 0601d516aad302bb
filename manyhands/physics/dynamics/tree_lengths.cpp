#include "manyhands/physics/dynamics/tree_lengths.h"

#include <algorithm>

#include "manyhands/base/index.h"
#include "manyhands/physics/dynamics/start_mobility.h"

namespace manyhands {

namespace {

void sort_once(std::vector<int>& dofs) {
  std::ranges::sort(dofs);
  dofs.erase(std::ranges::unique(dofs).begin(), dofs.end());
}

/// The place of a dof among others; -1 if it is none of them.
int place_in(const std::vector<int>& dofs, int dof) {
  const auto found = std::ranges::lower_bound(dofs, dof);
  return found != dofs.end() && *found == dof ? static_cast<int>(found - dofs.begin()) : -1;
}

template <Real R>
TreeLength<R> joint_length(const Model& model, const Tendon& tendon) {
  TreeLength<R> length{.type = LengthType::kJoints};
  for (const TendonJoint& part : tendon.joints) length.dofs.push_back(model.joint(part.joint).iv);
  sort_once(length.dofs);
  length.q.resize(length.dofs.size());
  length.weights.resize(length.dofs.size());
  for (const TendonJoint& part : tendon.joints) {
    const Joint& joint = model.joint(part.joint);
    const std::size_t k = index(place_in(length.dofs, joint.iv));
    length.q[k] = joint.iq;
    length.weights[k] += static_cast<R>(part.coefficient);
  }
  return length;
}

/// What moves the second of two bodies against the first; what moves both alike does nothing.
template <Real R>
std::vector<TreeLever<R>> levers_between(const Tree<R>& tree, std::size_t body_a, std::size_t body_b) {
  const std::span<const int> a = tree.path_of(body_a), b = tree.path_of(body_b);
  std::vector<TreeLever<R>> levers;
  const auto add = [&](std::span<const int> own, std::span<const int> others, R sign) {
    for (const int i : own) {
      if (std::ranges::find(others, i) == others.end()) levers.push_back({.dof = index(i), .sign = sign});
    }
  };
  add(a, b, R(-1));
  add(b, a, R(1));
  return levers;
}

/// Adds the dofs of levers to those of their length.
template <Real R>
void add_dofs(const std::vector<TreeLever<R>>& levers, TreeLength<R>& length) {
  for (const TreeLever<R>& lever : levers) length.dofs.push_back(static_cast<int>(lever.dof));
}

/// Once the length's dofs are sorted.
template <Real R>
void find_entries(const TreeLength<R>& length, std::vector<TreeLever<R>>& levers) {
  for (TreeLever<R>& lever : levers) lever.entry = index(place_in(length.dofs, static_cast<int>(lever.dof)));
}

template <Real R>
TreeLength<R> path_length(const Model& model, const Tree<R>& tree, const Tendon& tendon) {
  TreeLength<R> length{.type = LengthType::kPath};
  for (const TendonBranch& branch : tendon.branches) {
    for (std::size_t k = 1; k < branch.points.size(); ++k) {
      const TendonPoint &from = branch.points[k - 1], &to = branch.points[k];
      const Link &a = model.link(from.link), &b = model.link(to.link);
      TreeSegment<R> segment{.body_a = a.body.index(),
                             .body_b = b.body.index(),
                             .p_A = broadcast<R>(a.X_BL * from.p_L),
                             .p_B = broadcast<R>(b.X_BL * to.p_L),
                             .share = static_cast<R>(1 / branch.divisor)};
      segment.levers = levers_between(tree, segment.body_a, segment.body_b);
      add_dofs(segment.levers, length);
      length.segments.push_back(std::move(segment));
    }
  }
  sort_once(length.dofs);
  for (TreeSegment<R>& segment : length.segments) find_entries(length, segment.levers);
  return length;
}

template <Real R>
TreeLength<R> site_length(const Model& model, const Tree<R>& tree, const ActuatorSite& from) {
  const Link& link = model.link(from.link);
  TreeLength<R> length{.type = LengthType::kSite, .stops = false};
  TreeSite<R>& site = length.site;
  site = {.body_a = link.body.index(),
          .X_AS = broadcast<R>(link.X_BL * from.X_LS),
          .has_reference = from.reference.is_valid(),
          .force = broadcast<R>(from.force),
          .torque = broadcast<R>(from.torque)};
  if (site.has_reference) {
    const Link& reference = model.link(from.reference);
    site.body_b = reference.body.index();
    site.X_BR = broadcast<R>(reference.X_BL * from.X_LR);
  }
  site.levers = levers_between(tree, site.body_b, site.body_a);
  add_dofs(site.levers, length);
  sort_once(length.dofs);
  find_entries(length, site.levers);
  return length;
}

template <Real R>
TreeLength<R> coupled_length(const Tree<R>& tree, const EqualityConstraint& equality) {
  TreeLength<R> length{.type = LengthType::kCoupling,
                       .a = equality.tendon_a.value(),
                       .b = equality.tendon_b.value(),
                       .reference_a = static_cast<R>(equality.reference_a),
                       .reference_b = static_cast<R>(equality.reference_b),
                       .max_force = static_cast<R>(equality.max_force)};
  std::ranges::transform(equality.polynomial, length.polynomial.begin(), [](double c) { return static_cast<R>(c); });
  const std::vector<int> none, &of_b = tree.lengths[index(length.b)].dofs,
                               &of_a = length.a < 0 ? none : tree.lengths[index(length.a)].dofs;
  length.dofs = of_b;
  length.dofs.insert(length.dofs.end(), of_a.begin(), of_a.end());
  sort_once(length.dofs);
  for (const int dof : length.dofs) {
    length.in_a.push_back(place_in(of_a, dof));
    length.in_b.push_back(place_in(of_b, dof));
  }
  return length;
}

template <Real R>
void add_length(TreeLength<R> length, Tree<R>& tree) {
  length.J = tree.length_entries;
  tree.length_entries += length.dofs.size();
  tree.lengths.push_back(std::move(length));
}

/// Lets a length, which is that of a coupling or limit, give way.
template <Real R>
void give_way(const Compliance& compliance, double mobility, TreeLength<R>& length) {
  length.compliance = tree_compliance<R>(compliance);
  length.mobility = static_cast<R>(mobility);
}

/// Limits that give way act along lengths of their own: beside them a dof or tendon has its other laws.
template <Real R>
void add_limits(const Model& model, const StartMobility& start, Tree<R>& tree) {
  const auto is_limited = [](double lower, double upper) { return is_finite(lower) || is_finite(upper); };
  for (std::size_t k = 0; k < model.tendons().size(); ++k) {
    const Tendon& tendon = model.tendons()[k];
    if (!tendon.compliance || !is_limited(tendon.lower, tendon.upper)) continue;
    TreeLength<R> length = coupled_length(tree, {.tendon_b = TendonId(k), .polynomial = {}});
    length.limited = tree.nv + static_cast<int>(k);
    give_way(*tendon.compliance, start.of_tendon(TendonId(k)), length);
    tree.lengths[k].stops = false;
    add_length(std::move(length), tree);
  }
  for (std::size_t i = 0; i < index(tree.nv); ++i) {
    const JointLimits& limits = model.dof_limits()[i];
    if (!limits.compliance || !is_limited(limits.lower, limits.upper)) continue;
    TreeLength<R> length{.type = LengthType::kJoints, .dofs = {static_cast<int>(i)}, .q = {tree.dof_q[i]}};
    length.weights = {R(1)};
    length.limited = static_cast<int>(i);
    give_way(*limits.compliance, start.of_dof(i), length);
    tree.dof_stops[i] = false;
    add_length(std::move(length), tree);
  }
}

}  // namespace

template <Real R>
void add_lengths(const Model& model, const StartMobility* start, Tree<R>& tree) {
  for (const Tendon& tendon : model.tendons())
    add_length(tendon.branches.empty() ? joint_length<R>(model, tendon) : path_length(model, tree, tendon), tree);
  for (const EqualityConstraint& equality : model.equalities()) {
    if (equality.type != EqualityType::kTendon) continue;
    TreeLength<R> length = coupled_length(tree, equality);
    if (equality.compliance && start != nullptr) {
      const double other = equality.tendon_a.is_valid() ? start->of_tendon(equality.tendon_a) : 0;
      give_way(*equality.compliance, start->of_tendon(equality.tendon_b) + other, length);
    }
    add_length(std::move(length), tree);
  }
  if (start != nullptr) add_limits(model, *start, tree);
  for (const Actuator& actuator : model.actuators())
    if (actuator.site) add_length(site_length(model, tree, *actuator.site), tree);
}

template void add_lengths(const Model&, const StartMobility*, Tree<double>&);
template void add_lengths(const Model&, const StartMobility*, Tree<float>&);

}  // namespace manyhands
