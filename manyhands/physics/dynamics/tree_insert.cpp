// Tree: taking in the tree of another model.
#include "manyhands/base/index.h"
#include "manyhands/physics/dynamics/tree.h"

namespace manyhands {

namespace {

/// The paths of bodies, which follow each other without gaps.
template <Real R>
void insert_paths(const Tree<R>& part, const Insertion& at, Tree<R>& tree) {
  const auto begin = [](const Tree<R>& of, int body) { return static_cast<int>(of.path_begin[index(body)]); };
  const ListInsertion entries{begin(tree, at.bodies.old_first), static_cast<int>(tree.path.size()),
                              begin(part, at.bodies.new_first + 1), static_cast<int>(part.path.size())};
  std::vector<int> path = part.path;
  for (int& i : path) i = at.v.of_new(i);
  for (int i = entries.old_first; entries.shifts() && i < entries.old_size; ++i) {
    tree.path[index(i)] = at.v.of_old(tree.path[index(i)]);
  }
  entries.apply(tree.path, path);

  tree.path_begin.pop_back();
  for (int b = at.bodies.old_first; entries.shifts() && b < tree.nb; ++b) {
    tree.path_begin[index(b)] += index(entries.new_first);
  }
  std::vector<std::size_t> begins;
  for (int b = 1; b < part.nb; ++b) {  // not by its entries' section: a mocap body has none
    const bool in_first = b <= at.bodies.new_first;
    begins.push_back(index(begin(part, b) + (in_first ? entries.old_first : entries.old_size)));
  }
  at.bodies.apply(tree.path_begin, begins);
  tree.path_begin.push_back(tree.path.size());
}

/// Where M's rows lie. Each tree's triangle moves as a whole.
template <Real R>
void insert_rows(const Tree<R>& part, const Insertion& at, Tree<R>& tree) {
  const auto split = [](const Tree<R>& of, int dof) {
    return dof < of.nv ? of.M_row[index(dof)] + of.root_dof[index(dof)] : static_cast<std::ptrdiff_t>(of.M_size);
  };
  const ListInsertion numbers{static_cast<int>(split(tree, at.v.old_first)), static_cast<int>(tree.M_size),
                              static_cast<int>(split(part, at.v.new_first)), static_cast<int>(part.M_size)};
  for (int i = at.v.old_first; at.v.shifts() && i < tree.nv; ++i) {
    tree.M_row[index(i)] += numbers.new_first - at.v.new_first;
  }
  std::vector<std::ptrdiff_t> rows;
  for (int i = 0; i < part.nv; ++i) {
    const int root = part.root_dof[index(i)];
    rows.push_back(numbers.of_new(static_cast<int>(part.M_row[index(i)]) + root) - at.v.of_new(root));
  }
  at.v.apply(tree.M_row, rows);
  tree.M_size += part.M_size;
}

/// Dofs that come to lie between two that an equality constraint joins belong to their cluster.
template <Real R>
void insert_clusters(const Tree<R>& part, const Insertion& at, Tree<R>& tree) {
  const ListInsertion& v = at.v;
  const bool within = v.shifts() && v.old_first > 0 && tree.cluster_begin[index(v.old_first)] < v.old_first;
  const int begin = within ? tree.cluster_begin[index(v.old_first)] : v.old_first;
  const int end = within ? tree.cluster_end[index(v.old_first)] + v.new_first : v.old_first + v.new_first;
  for (int i = begin; v.shifts() && i < v.old_size; ++i) {
    tree.cluster_begin[index(i)] = v.of_old(tree.cluster_begin[index(i)]);
    tree.cluster_end[index(i)] = v.of_old(tree.cluster_end[index(i)] - 1) + 1;
  }
  std::vector<int> begins, ends;
  for (int i = 0; i < part.nv; ++i) {
    const bool joins = within && i < v.new_first;
    begins.push_back(joins ? begin : v.of_new(part.cluster_begin[index(i)]));
    ends.push_back(joins ? end : v.of_new(part.cluster_end[index(i)] - 1) + 1);
  }
  v.apply(tree.cluster_begin, begins);
  v.apply(tree.cluster_end, ends);
}

/// Whether equality constraints of the part join trees that will stand apart.
template <Real R>
bool joins_sections(const Tree<R>& part, int split) {
  return split < part.nv && part.cluster_begin[index(split)] < split;
}

/// Bodies, dofs and coordinates by their places in the whole.
template <Real R, class Body, class Dof, class Q>
void renumber(TreeEquality<R>& equality, const Body& body, const Dof& dof, const Q& q) {
  equality.body_a = index(body(static_cast<int>(equality.body_a)));
  equality.body_b = index(body(static_cast<int>(equality.body_b)));
  if (equality.joins_bodies()) return;
  equality.dof_a = index(dof(static_cast<int>(equality.dof_a)));
  equality.dof_b = index(dof(static_cast<int>(equality.dof_b)));
  equality.q_a = index(q(static_cast<int>(equality.q_a)));
  equality.q_b = index(q(static_cast<int>(equality.q_b)));
}

template <Real R>
void insert_equalities(const Tree<R>& part, const Insertion& at, Tree<R>& tree) {
  if (at.bodies.shifts()) {
    for (TreeEquality<R>& equality : tree.equalities) {
      const auto body = [&](int b) { return at.bodies.of_old(b); };
      renumber(equality, body, [&](int i) { return at.v.of_old(i); }, [&](int i) { return at.q.of_old(i); });
    }
  }
  if (part.equalities.empty()) return;
  std::vector<TreeEquality<R>> equalities = part.equalities;
  for (TreeEquality<R>& equality : equalities) {
    const auto body = [&](int b) { return at.new_body(b); };
    renumber(equality, body, [&](int i) { return at.v.of_new(i); }, [&](int i) { return at.q.of_new(i); });
  }
  at.equalities.apply(tree.equalities, equalities);
  tree.equality_rows = 0;
  for (TreeEquality<R>& equality : tree.equalities) {
    equality.row = tree.equality_rows;
    tree.equality_rows += equality.turns ? 6 : 3;
  }
}

/// The position or velocity drives of dofs.
template <Real R>
void insert_actuators(const Tree<R>& part, const Insertion& at, Tree<R>& tree) {
  for (TreeActuator<R>& actuator : tree.actuators) {
    if (!at.v.shifts()) break;
    actuator.law = index(at.v.of_old(static_cast<int>(actuator.law)));
    actuator.q = index(at.q.of_old(static_cast<int>(actuator.q)));
  }
  for (TreeActuator<R> actuator : part.actuators) {
    actuator.law = index(at.v.of_new(static_cast<int>(actuator.law)));
    actuator.q = index(at.q.of_new(static_cast<int>(actuator.q)));
    if (actuator.act >= 0) actuator.act += at.activations;
    tree.actuators.push_back(actuator);
  }
  std::vector<int> drives = part.dof_drive;
  for (int& drive : drives) drive += drive < 0 ? 0 : at.actuators;
  at.v.apply(tree.dof_drive, drives);
}

/// Bodies that are carried, and those that a user moves.
template <Real R>
void insert_special_bodies(const Tree<R>& part, const Insertion& at, Tree<R>& tree) {
  const auto insert = [&](const std::vector<std::size_t>& bodies, std::vector<std::size_t>& into) {
    for (std::size_t& body : into) body = index(at.bodies.of_old(static_cast<int>(body)));
    for (const std::size_t body : bodies) into.push_back(index(at.new_body(static_cast<int>(body))));
  };
  insert(part.mocap_bodies, tree.mocap_bodies);
  insert(part.lifted_bodies, tree.lifted_bodies);
  for (std::size_t i = 0; i < tree.lifted_bodies.size(); ++i) {
    tree.bodies[tree.lifted_bodies[i]].lift = static_cast<int>(i);
  }
}

/// A list over dofs whose items are dofs.
void insert_dofs(const std::vector<int>& part, const ListInsertion& list, const ListInsertion& v,
                 std::vector<int>& into) {
  for (std::size_t i = index(list.old_first); v.shifts() && i < into.size(); ++i) into[i] = v.of_old(into[i]);
  std::vector<int> items = part;
  for (int& i : items) i = v.of_new(i);
  list.apply(into, items);
}

}  // namespace

template <Real R>
void Tree<R>::insert(const Tree& part, const Insertion& at) {
  insert_paths(part, at, *this);
  insert_rows(part, at, *this);
  insert_clusters(part, at, *this);
  insert_equalities(part, at, *this);
  insert_actuators(part, at, *this);

  std::vector<TreeBody<R>> added(part.bodies.begin() + 1, part.bodies.end());
  for (TreeBody<R>& body : added) {
    body.parent = at.new_body(body.parent);
    body.iq = at.q.of_new(body.iq);
    body.iv = at.v.of_new(body.iv);
  }
  for (std::size_t b = index(at.bodies.old_first); at.bodies.shifts() && b < bodies.size(); ++b) {
    bodies[b].parent = at.bodies.of_old(bodies[b].parent);
    bodies[b].iq = at.q.of_old(bodies[b].iq);
    bodies[b].iv = at.v.of_old(bodies[b].iv);
  }
  at.bodies.apply(bodies, added);
  insert_special_bodies(part, at, *this);
  insert_dofs({part.last_dof.begin() + 1, part.last_dof.end()}, at.bodies, at.v, last_dof);

  insert_dofs(part.dof_parent, at.v, at.v, dof_parent);
  M_parent = dof_parent;
  insert_dofs(part.root_dof, at.v, at.v, root_dof);
  std::vector<int> ends = part.end_dof;
  for (int& i : ends) i = at.v.of_new(i - 1) + 1;
  for (std::size_t i = index(at.v.old_first); at.v.shifts() && i < end_dof.size(); ++i) end_dof[i] += at.v.new_first;
  at.v.apply(end_dof, ends);
  std::vector<int> coordinates = part.dof_q;
  for (int& i : coordinates) i = at.q.of_new(i);
  for (std::size_t i = index(at.v.old_first); at.v.shifts() && i < dof_q.size(); ++i) dof_q[i] = at.q.of_old(dof_q[i]);
  at.v.apply(dof_q, coordinates);
  at.v.apply(dof_limited, part.dof_limited);
  at.v.apply(dof_stops, part.dof_stops);

  std::vector<int> last;
  for (int i = nv + part.nv; i-- > nv;) last.push_back(i);
  dofs_from_leaves.insert(dofs_from_leaves.begin(), last.begin(), last.end());
  nb += part.nb - 1;
  nq += part.nq;
  nv += part.nv;
  if (joins_sections(part, at.v.new_first) && at.v.shifts()) join_clusters();
}

template void Tree<double>::insert(const Tree&, const Insertion&);
template void Tree<float>::insert(const Tree&, const Insertion&);

}  // namespace manyhands
