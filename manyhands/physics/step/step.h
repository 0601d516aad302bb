// One step of one world, or of one block of worlds.
#pragma once

#include <concepts>
#include <limits>

#include "manyhands/base/assert.h"
#include "manyhands/math/instantiate.h"
#include "manyhands/physics/collision/broad/pair_finder.h"
#include "manyhands/physics/contact/assemble.h"
#include "manyhands/physics/contact/far_points.h"
#include "manyhands/physics/contact/warm_start.h"
#include "manyhands/physics/dynamics/aba.h"
#include "manyhands/physics/dynamics/crba.h"
#include "manyhands/physics/step/tumbling.h"

namespace manyhands {

/// What steps share: the model as kernels read it, and how hard the solver works. Uniform.
template <Real R>
struct System {
  explicit System(const Model& model, PairSearch search = PairSearch::kListed)
      : tree(model), colliders(model, search) {}
  /// One in which nothing collides.
  explicit System(Tree<R> alone) : tree(std::move(alone)) {}

  /// The numbers that a state needs for the contact cache.
  [[nodiscard]] std::size_t contact_numbers() const { return colliders.num_manifolds * kManifoldNumbers<R>; }

  Tree<R> tree;
  Colliders<R> colliders;
  SolverSettings solver = SolverTraits<R>::kDefaults;
};

/// All that a step derives: allocated once, never saved.
template <Number T>
struct StepWorkspace {
  explicit StepWorkspace(const System<real_t<T>>& system)
      : dynamics(system.tree),
        collision(system.colliders),
        contact(system.tree, system.colliders),
        resting(static_cast<std::size_t>(system.tree.nb)) {
    if constexpr (Real<T>) {
      if (system.colliders.search == PairSearch::kSwept) finder.emplace(system.colliders);
    }
  }

  Workspace<T> dynamics;
  CollisionWorkspace<T> collision;
  std::optional<PairFinder<real_t<T>>> finder;  ///< of a large world
  std::vector<real_t<T>> old_cache;             ///< scratch of a large world
  FarPoints<real_t<T>> far_points;              ///< where steps leave some out
  ContactSolver<T> contact;
  std::vector<T> resting;  ///< (nb) 1 where something holds the body up
};

/// x += time v. In single precision `rest` keeps what x has no room for (Knuth's two-sum): without it what moves by
/// less than half a unit of x in a step stands still, and a held thing creeps out of a hand that does not. No more than
/// a unit, for x may have been set since.
template <Number T>
MANYHANDS_INLINE void accumulate(T time, T v, T& x, T& rest) {
  if constexpr (std::same_as<real_t<T>, double>) {
    x = fma(time, v, x);
  } else {
    const T unit = constant<T>(std::numeric_limits<float>::epsilon()) * abs(x);
    const T change = fma(time, v, clamp(rest, -unit, unit)), before = x;
    x = before + change;
    const T added = x - before;
    rest = (before - (x - added)) + (change - added);
  }
}

/// q := q moved by the velocity v (nv) for `time` [s]. `rest` (nq): see `accumulate`.
template <Number T>
MANYHANDS_INLINE void integrate_configuration(const Tree<real_t<T>>& tree, const T* v, T time, T* q, T* rest) {
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    const T* vj = v + body.iv;
    T* qj = q + body.iq;
    switch (body.type) {
      case JointType::kSpherical:
      case JointType::kFloating: {
        if (body.type == JointType::kFloating) {
          for (int k = 0; k < 3; ++k) accumulate(time, vj[3 + k], qj[k], rest[body.iq + k]);
          qj += 3;
        }
        const Quat<T> r = integrate(Quat<T>{qj[0], qj[1], qj[2], qj[3]}, Vec3<T>{vj[0], vj[1], vj[2]}, time);
        qj[0] = r.x;
        qj[1] = r.y;
        qj[2] = r.z;
        qj[3] = r.w;
        break;
      }
      default:
        for (int k = 0; k < body.nv; ++k) accumulate(time, vj[k], qj[k], rest[body.iq + k]);
        break;
    }
  }
}

/// v := v + dv.
template <Number T>
MANYHANDS_INLINE void add_velocity_change(State<T>& state, std::size_t nv) {
  for (std::size_t i = 0; i < nv; ++i) state.v()[i] += state.dv()[i];
}

/// The bodies that contacts or equality constraints hold up: 1, else 0.
template <Number T>
MANYHANDS_INLINE void find_resting(const ContactSolver<T>& contact, std::vector<T>& resting) {
  const T zero = constant<T>(0), one = constant<T>(1);
  for (T& body : resting) body = zero;
  for (std::size_t i = 0; i < contact.problem.points.size(); ++i) {
    const ContactPoint<T>& point = contact.problem.points[i];
    const ContactPatch<T>& patch = contact.problem.patches[point.patch];
    const auto holds = (contact.iterate.points[i].impulse.x > zero) & (point.bounces == zero);
    for (const std::size_t body : {patch.body_a(), patch.body_b()}) resting[body] = select(holds, one, resting[body]);
  }
  for (const EqualityRows<T>& block : contact.problem.equalities)
    resting[block.rows.body_a] = resting[block.rows.body_b] = one;
  for (const TreeEquality<real_t<T>>& equality : contact.problem.tree->equalities)
    if (equality.compliance) resting[equality.body_a] = resting[equality.body_b] = one;
}

/// Free bodies fall on parabolas: takes back the h^2 / 2 a by which the last velocity of a step overshoots, except for
/// bodies that rest on something or hang on springs.
template <Number T, Number P>
MANYHANDS_INLINE void correct_free_fall(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h,
                                        const ContactSolver<T>& contact, std::vector<T>& resting, State<T>& state) {
  using R = real_t<T>;
  const T zero = constant<T>(0), one = constant<T>(1), overshoot(R(-0.5) * h * h);
  find_resting(contact, resting);
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    const TreeBody<R>& body = tree.bodies[b];
    const bool free = body.type == JointType::kFloating && body.parent == 0 &&
                      tree.end_dof[static_cast<std::size_t>(body.iv)] == body.iv + body.nv;
    if (!free) continue;
    Vec3<T> gravity = transpose_times(broadcast<T>(body.X_PF.R), broadcast<T>(params.gravity[0]));
    const T* force = state.tau() + body.iv + 3;
    const T inverse_mass = one / broadcast<T>(params.inertia[b].m);
    if (body.lift >= 0)
      gravity = fma(-inverse_mass * broadcast<T>(params.lifted_mass[index(body.lift)]), gravity, gravity);
    const auto hangs = broadcast<T>(params.stiffness[index(body.iv + 3)]) > zero;
    const T share = select(hangs, zero, overshoot * (one - resting[b]));
    const Vec3<T> acceleration = fma(inverse_mass, Vec3<T>{force[0], force[1], force[2]}, gravity);
    T *p = state.q() + body.iq, *rest = state.q_rest() + body.iq;
    accumulate(share, acceleration.x, p[0], rest[0]);
    accumulate(share, acceleration.y, p[1], rest[1]);
    accumulate(share, acceleration.z, p[2], rest[2]);
  }
}

/// Finds the manifolds of bodies at the poses in `placed`, into ws.collision.touches. Returns the pairs that it tested,
/// to which the touches refer: all that are listed, or in a large world those that the broad phase finds.
template <Number T, Number P>
MANYHANDS_INLINE std::span<const ColliderPair> look_for_touches(const Colliders<real_t<T>>& colliders,
                                                                const Params<P>& params, real_t<T> h,
                                                                const Workspace<T>& placed, StepWorkspace<T>& ws) {
  std::span<const ColliderPair> pairs(colliders.pairs);  // NOLINT(misc-const-correctness): other pairs if T is real
  place_colliders(colliders, params, h, placed, ws.collision);
  if constexpr (Real<T>) {
    if (ws.finder) {
      orient_colliders(colliders, h, placed, ws.collision);
      pairs = ws.finder->find(colliders, params, ws.collision);
    }
  }
  collide(colliders, pairs, params, h, placed, ws.collision);
  return pairs;
}

/// As `look_for_touches`, at the poses of this step; in a large world the state's contact cache is sorted anew, as what
/// touches.
template <Number T, Number P>
MANYHANDS_INLINE std::span<const ColliderPair> find_touches(const Colliders<real_t<T>>& colliders,
                                                            const Params<P>& params, real_t<T> h, State<T>& state,
                                                            StepWorkspace<T>& ws) {
  ws.collision.touches.clear();
  if (colliders.pairs.empty() && !ws.finder) return {};
  const std::span<const ColliderPair> pairs = look_for_touches(colliders, params, h, ws.dynamics, ws);
  if constexpr (Real<T>) {
    if (ws.finder) carry_contact_cache(ws.collision.touches, state, ws.old_cache);
  }
  return pairs;
}

/// Solves contacts, equality constraints and joints together, from where the last step ended: dv and all impulses.
/// Begins anew where that reaches points that were left out.
template <Number T, Number P>
MANYHANDS_INLINE void solve_constraints(const System<real_t<T>>& system, std::span<const ColliderPair> pairs,
                                        const Params<P>& params, real_t<T> h, const State<T>& state,
                                        StepWorkspace<T>& ws) {
  ContactSolver<T>& contact = ws.contact;
  std::vector<Touch<T>>& touches = ws.collision.touches;
  if constexpr (SolverTraits<real_t<T>>::kLeavesOut)
    leave_out_far_points(system.tree, system.colliders, pairs, ws.dynamics, h, state.dv(), touches, ws.far_points);
  for (;;) {
    assemble_constraints(system.colliders, pairs, params, h, state, ws.collision, ws.dynamics, contact);
    warm_start(contact.problem, std::span<const Touch<T>>(touches), state, contact.iterate);
    solve(system.solver, contact);
    if constexpr (SolverTraits<real_t<T>>::kLeavesOut) {
      if (take_in_reached_points(system.tree, system.colliders, pairs, ws.dynamics, h, contact.iterate.dv.data(),
                                 touches, ws.far_points))
        continue;
    }
    return;
  }
}

/// Advances the state by h [s]: semi-implicit Euler at the velocity level; contacts, motors, limits and damping are
/// implicit.
template <Number T, Number P>
void step(const System<real_t<T>>& system, const Params<P>& params, real_t<T> h, State<T>& state,
          StepWorkspace<T>& ws) {
  const Tree<real_t<T>>& tree = system.tree;
  MANYHANDS_ASSERT(h > 0 && is_finite(h));
  // In single precision a world that runs away is found after the step, or after several, and put back.
  if constexpr (std::same_as<T, double>) {
    MANYHANDS_ASSERT(internal::all_finite(state.q(), tree.nq) && internal::all_finite(state.v(), tree.nv));
    MANYHANDS_ASSERT(internal::are_quaternions_unit(tree, state.q()));
  }
  const Colliders<real_t<T>>& colliders = system.colliders;
  place_mocap(tree, state.mocap(), ws.dynamics);
  bias_and_mass_matrix(tree, params, state.q(), state.v(), ws.dynamics);  // 1 dynamics
  bound_tumbling(tree, T(h), ws.dynamics);
  const std::span<const ColliderPair> pairs = find_touches(colliders, params, h, state, ws);  // 2 collision
  ContactSolver<T>& contact = ws.contact;
  assemble_joints(tree, params, h, state, ws.dynamics, contact);              // 3 the laws of joints
  solve_constraints(system, pairs, params, h, state, ws);                     // 4 their solution, with all constraints
  store_warm_start(contact.problem, contact.iterate, state);                  // 5 where the next step begins
  add_velocity_change(state, static_cast<std::size_t>(tree.nv));              // 6 velocities
  integrate_configuration(tree, state.v(), T(h), state.q(), state.q_rest());  // 7 positions
  advance_activations(tree, h, state);                                        // 8 what becomes of commands
  correct_free_fall(tree, params, h, contact, ws.resting, state);
}

// Compiled once for each number type, with parameters of its own for every world or the same for all.
#define MANYHANDS_STEP(prefix, T, P) \
  prefix template void step<T, P>(const System<real_t<T>>&, const Params<P>&, real_t<T>, State<T>&, StepWorkspace<T>&);
MANYHANDS_STEP(extern, double, double)
MANYHANDS_STEP(extern, float, float)
MANYHANDS_FOR_ALL_LANES(MANYHANDS_STEP, extern)

}  // namespace manyhands
