#include "manyhands/physics/dynamics/tree.h"

#include <algorithm>
#include <numbers>
#include <optional>
#include <utility>

#include "manyhands/base/assert.h"
#include "manyhands/math/instantiate.h"
#include "manyhands/model/equivalent_box.h"
#include "manyhands/physics/dynamics/checks.h"
#include "manyhands/physics/dynamics/start_mobility.h"
#include "manyhands/physics/dynamics/tree_actuators.h"
#include "manyhands/physics/dynamics/tree_lengths.h"

namespace manyhands {

namespace {

/// 1, 2, 3 if a is the x, y, z axis to rounding, minus that if it is its reverse, else 0.
std::int8_t axis_of(const Vec3<double>& a) {
  constexpr double kRounding = 1e-15;
  const double x = abs(a.x), y = abs(a.y), z = abs(a.z);
  if (y + z <= kRounding) return a.x > 0 ? 1 : -1;
  if (x + z <= kRounding) return a.y > 0 ? 2 : -2;
  if (x + y <= kRounding) return a.z > 0 ? 3 : -3;
  return 0;
}

template <Real R>
void set_turn(const Mat3<double>& m, TreeBody<R>& body) {
  body.axes = {axis_of(m.x), axis_of(m.y), axis_of(m.z)};
  const bool quarters = body.axes[0] != 0 && body.axes[1] != 0 && body.axes[2] != 0;
  body.turn = !quarters                                          ? Turn::kGeneral
              : body.axes == std::array<std::int8_t, 3>{1, 2, 3} ? Turn::kNone
                                                                 : Turn::kQuarters;
}

/// Whether the equality also holds rotations.
bool turns(EqualityType type) {
  return type == EqualityType::kHinge || type == EqualityType::kFixed || type == EqualityType::kPrismatic ||
         type == EqualityType::kSlider;
}

template <Real R>
TreeEquality<R> tree_equality(const Model& model, const EqualityConstraint& equality) {
  TreeEquality<R> result{.type = equality.type,
                         .ratio = static_cast<R>(equality.ratio),
                         .offset = static_cast<R>(equality.offset),
                         .max_force = static_cast<R>(equality.max_force),
                         .turns = turns(equality.type)};
  if (equality.type == EqualityType::kJoint || equality.type == EqualityType::kGear) {
    const Joint &a = model.joint(equality.joint_a), &b = model.joint(equality.joint_b);
    result.body_a = model.link(a.child).body.index();
    result.body_b = model.link(b.child).body.index();
    result.dof_a = static_cast<std::size_t>(a.iv);
    result.dof_b = static_cast<std::size_t>(b.iv);
    result.q_a = static_cast<std::size_t>(a.iq);
    result.q_b = static_cast<std::size_t>(b.iq);
  } else if (equality.type != EqualityType::kTendon) {
    const Link &a = model.link(equality.link_a), &b = model.link(equality.link_b);
    result.body_a = a.body.index();
    result.body_b = b.body.index();
    result.X_BA = broadcast<R>(a.X_BL * equality.X_LA);
    result.X_BB = broadcast<R>(b.X_BL * equality.X_LB);
  }
  return result;
}

/// Lets it give way. Of tendons it is a length that does.
template <Real R>
void give_way(const EqualityConstraint& equality, const StartMobility& start, TreeEquality<R>& result) {
  if (equality.type == EqualityType::kTendon) return;
  result.compliance = tree_compliance<R>(*equality.compliance);
  if (!result.joins_bodies()) {
    result.linear = static_cast<R>(start.of_dof(result.dof_a) + start.of_dof(result.dof_b));
    return;
  }
  // MuJoCo measures a rotation by torque_scale sin(angle / 2).
  const double arm = equality.torque_scale / 2;
  const StartMobility::OfLink a = start.of_link(equality.link_a), b = start.of_link(equality.link_b);
  result.linear = static_cast<R>(a.linear + b.linear);
  result.angular = static_cast<R>((a.angular + b.angular) / (arm * arm));
  result.arm = static_cast<R>(arm);
}

/// The square of the radius of gyration about the centre of mass [m^2].
double gyration(const RigidInertia<double>& body) {
  if (!(body.m > 0)) return 0;
  const double about_origin = (body.I.xx + body.I.yy + body.I.zz) / 2;
  return std::max(0.0, about_origin - squared_norm(body.h) / body.m) / body.m;
}

/// The row of a coupling runs over the dofs between two bodies. Where one joint is the other's ancestor, that is from
/// the body which it moves against, so that both joints are between.
template <Real R>
void include_both_joints(const Tree<R>& tree, TreeEquality<R>& equality) {
  const auto moves = [&](std::size_t dof, std::size_t body) {
    return std::ranges::find(tree.path_of(body), static_cast<int>(dof)) != tree.path_of(body).end();
  };
  const auto parent = [&](std::size_t body) { return static_cast<std::size_t>(tree.bodies[body].parent); };
  if (moves(equality.dof_a, equality.body_b)) {
    equality.body_a = parent(equality.body_a);
  } else if (moves(equality.dof_b, equality.body_a)) {
    equality.body_b = parent(equality.body_b);
  }
}

template <Real R>
TreeDrag<R> drag_of(const Medium& medium, const Link& link) {
  const EquivalentBox box = equivalent_box(link.inertial);
  const auto& [x, y, z] = box.size;
  const double diameter = (x + y + z) / 3, round = std::numbers::pi * diameter * medium.viscosity;
  const auto fourth = [](double l) { return l * l * l * l; };
  const double pushed = medium.density / 2, turned = medium.density / 64;
  return {.body = link.body.index(),
          .X_BK = broadcast<R>(link.X_BL * box.X_LB),
          .linear = static_cast<R>(3 * round),
          .angular = static_cast<R>(round * diameter * diameter),
          .per_speed = broadcast<R>(pushed * Vec3<double>{y * z, z * x, x * y}),
          .per_rate = broadcast<R>(turned * Vec3<double>{x * (fourth(y) + fourth(z)), y * (fourth(z) + fourth(x)),
                                                         z * (fourth(x) + fourth(y))})};
}

/// Rows of an equality constraint; those of tendons are lengths.
std::size_t rows_of(EqualityType type) { return type == EqualityType::kTendon ? 0 : turns(type) ? 6 : 3; }

/// Widens the ranges [begin, end) of dofs until no pair of dofs, -1 for none, leaves its own and no two overlap in
/// part.
void join_ranges(const std::vector<std::pair<int, int>>& pairs, std::vector<int>& begins, std::vector<int>& ends) {
  const auto join = [&](int i, int j) {
    if (i < 0 || j < 0) return false;
    const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
    const int begin = std::min(begins[a], begins[b]), end = std::max(ends[a], ends[b]);
    bool grew = false;
    for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k) {
      grew = grew || begins[k] != begin || ends[k] != end;
      begins[k] = begin;
      ends[k] = end;
    }
    return grew;
  };
  for (bool grew = true; grew;) {
    grew = false;
    for (const auto& [a, b] : pairs) {
      grew = join(a, b) || grew;
      for (const int i : {a, b}) {
        if (i >= 0) grew = join(begins[static_cast<std::size_t>(i)], ends[static_cast<std::size_t>(i)] - 1) || grew;
      }
    }
  }
}

/// Lets one way towards the root pass both dofs and all that lie on either's: ways fall, so that they merge like lists.
void join_ways(int i, int j, std::vector<int>& parent) {
  while (i >= 0 && j >= 0 && i != j) {
    if (i < j) std::swap(i, j);
    int& next = parent[static_cast<std::size_t>(i)];
    const int after = next;
    next = std::max(after, j);
    i = next;
    j = std::min(after, j);
  }
}

/// The dofs on which the rows of an equality constraint act.
template <Real R>
std::vector<int> dofs_of(const Tree<R>& tree, const TreeEquality<R>& equality) {
  if (!equality.joins_bodies()) return {static_cast<int>(equality.dof_a), static_cast<int>(equality.dof_b)};
  std::vector<int> dofs;
  int a = tree.last_dof[equality.body_a], b = tree.last_dof[equality.body_b];
  while (a != b) {  // the later of the two goes on towards the root
    int& later = a > b ? a : b;
    dofs.push_back(later);
    later = tree.dof_parent[static_cast<std::size_t>(later)];
  }
  return dofs;
}

/// What M needs room for: the dofs of a tree that lie on one way, and what tendons and equality constraints that give
/// way join.
template <Real R>
void find_pattern(Tree<R>& tree) {
  tree.M_parent = tree.dof_parent;
  std::vector<std::pair<int, int>> joined;
  const auto join = [&](const std::vector<int>& dofs) {
    for (std::size_t k = 1; k < dofs.size(); ++k) {
      joined.emplace_back(dofs[k - 1], dofs[k]);
      join_ways(dofs[k - 1], dofs[k], tree.M_parent);
    }
  };
  for (const TreeLength<R>& length : tree.lengths) join(length.dofs);
  for (const TreeEquality<R>& equality : tree.equalities)
    if (equality.compliance) join(dofs_of(tree, equality));
  join_ranges(joined, tree.root_dof, tree.end_dof);
  for (int k = 0; k < tree.nv; ++k) {
    const auto i = static_cast<std::size_t>(k);
    tree.M_row.push_back(static_cast<std::ptrdiff_t>(tree.M_size) - tree.root_dof[i]);
    tree.M_size += static_cast<std::size_t>(k - tree.root_dof[i] + 1);
    int own = tree.dof_parent[i];
    for (int j = tree.M_parent[i]; j >= 0; j = tree.M_parent[static_cast<std::size_t>(j)]) {
      if (j != own) {
        tree.M_joined.push_back(static_cast<std::size_t>(tree.M_row[i] + j));
      } else {
        own = tree.dof_parent[static_cast<std::size_t>(own)];
      }
    }
  }
}

}  // namespace

std::size_t equality_rows(const Model& model) {
  std::size_t rows = 0;
  for (const EqualityConstraint& equality : model.equalities()) rows += rows_of(equality.type);
  return rows;
}

namespace {

template <class Parts>
bool any_gives_way(const Parts& parts) {
  return std::ranges::any_of(parts, [](const auto& part) { return part.compliance.has_value(); });
}

bool gives_way(const Model& model) {
  return any_gives_way(model.equalities()) || any_gives_way(model.tendons()) || any_gives_way(model.dof_limits());
}

}  // namespace

template <Real R>
Tree<R>::Tree(const Model& model)
    : Tree(gives_way(model) ? [&] {
        const StartMobility start(model);
        return Tree(model, &start);
      }()
                            : rigid(model)) {}

template <Real R>
Tree<R>::Tree(const Model& model, const StartMobility* start)
    : nb(model.num_bodies()),
      nq(model.nq()),
      nv(model.nv()),
      dof_parent(model.dof_parent().begin(), model.dof_parent().end()),
      dof_q(model.dof_q().begin(), model.dof_q().end()) {
  for (const Body& body : model.bodies()) {
    bodies.push_back({.parent = body.parent.value(),
                      .type = body.type,
                      .iq = body.iq,
                      .iv = body.iv,
                      .nv = body.nv,
                      .shifted = norm(body.X_PF.p) > 0,
                      .X_PF = broadcast<R>(body.X_PF),
                      .gyration = static_cast<R>(gyration(body.inertia))});
    set_turn(body.X_PF.R, bodies.back());
  }
  for (const BodyId body : model.mocap_bodies()) mocap_bodies.push_back(body.index());
  for (const Lift& lift : model.lifts()) {
    bodies[lift.body.index()].lift = static_cast<int>(lifted_bodies.size());
    lifted_bodies.push_back(lift.body.index());
  }
  for (int k = nv - 1; k >= 0; --k) dofs_from_leaves.push_back(k);
  for (int k = 0; k < nv; ++k) {
    const auto i = static_cast<std::size_t>(k);
    root_dof.push_back(dof_parent[i] < 0 ? k : root_dof[static_cast<std::size_t>(dof_parent[i])]);
  }
  end_dof.assign(root_dof.size(), nv);
  for (std::size_t i = end_dof.size(); i-- > 1;) {
    end_dof[i - 1] = root_dof[i] == root_dof[i - 1] ? end_dof[i] : static_cast<int>(i);
  }
  for (const TreeBody<R>& body : bodies) {
    last_dof.push_back(last_dof.empty() ? -1
                       : body.nv > 0    ? body.iv + body.nv - 1
                                        : last_dof[static_cast<std::size_t>(body.parent)]);
    path_begin.push_back(path.size());
    for (int i = last_dof.back(); i >= 0; i = dof_parent[static_cast<std::size_t>(i)]) path.push_back(i);
  }
  path_begin.push_back(path.size());
  for (const JointLimits& limits : model.dof_limits()) {
    dof_limited.push_back(is_finite(limits.lower) || is_finite(limits.upper));
    dof_stops.push_back(dof_limited.back());
  }
  add_lengths(model, start, *this);
  add_equalities(model, start);
  find_pattern(*this);
  join_clusters();
  set_medium(model);
  add_actuators(model, *this);
  MANYHANDS_ASSERT(internal::is_topology_sound(*this));
}

template <Real R>
void Tree<R>::join_clusters() {
  cluster_begin = root_dof;
  cluster_end = end_dof;
  std::vector<std::pair<int, int>> joined;
  for (const TreeEquality<R>& equality : equalities)
    joined.emplace_back(last_dof[equality.body_a], last_dof[equality.body_b]);
  join_ranges(joined, cluster_begin, cluster_end);
}

template <Real R>
bool Tree<R>::is_plain() const {
  return lengths.empty() && std::ranges::none_of(equalities, [](const auto& e) { return e.compliance.has_value(); });
}

template <Real R>
void Tree<R>::add_equalities(const Model& model, const StartMobility* start) {
  for (const EqualityConstraint& equality : model.equalities()) {
    TreeEquality<R>& added = equalities.emplace_back(tree_equality<R>(model, equality));
    if (!added.joins_bodies()) include_both_joints(*this, added);
    if (equality.compliance && start != nullptr) give_way(equality, *start, added);
    added.row = equality_rows;
    equality_rows += rows_of(equality.type);
  }
}

template <Real R>
void Tree<R>::set_equalities(const Model& model) {
  equalities.clear();
  equality_rows = 0;
  std::optional<StartMobility> start;
  if (any_gives_way(model.equalities())) start.emplace(model);
  add_equalities(model, start ? &*start : nullptr);
  join_clusters();
}

template <Real R>
void Tree<R>::set_medium(const Model& model) {
  const Medium& medium = model.medium();
  drags.clear();
  wind = broadcast<R>(medium.wind);
  if (!medium.drags()) return;
  for (const Link& link : model.links()) {
    const std::size_t body = link.body.index();
    if (last_dof[body] >= 0 && link.inertial.mass > 0) drags.push_back(drag_of<R>(medium, link));
  }
}

template struct Tree<double>;
template struct Tree<float>;

}  // namespace manyhands
