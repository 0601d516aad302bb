// Equality constraints are eliminated exactly: what contacts see is the tree's response to an impulse with the equality
// constraints' response to it taken off (a Schur complement).
#pragma once

#include <algorithm>

#include "manyhands/physics/contact/mobility.h"

namespace manyhands::internal {

/// K = L D L^T of n rows, in place. A row that no joint moves, or that depends on rows before it, gets no impulse: its
/// 1 / D is 0.
template <Number T>
MANYHANDS_INLINE void factor_K(std::size_t n, const T* immovable, T* K, T* pivot_inverse) {
  using R = real_t<T>;
  const T zero = constant<T>(0), one = constant<T>(1), tiny = constant<T>(SolverTraits<R>::kSmallest);
  for (std::size_t i = 0; i < n; ++i) {
    T* row = K + i * n;
    const T whole = row[i];
    T pivot = whole;
    for (std::size_t j = 0; j < i; ++j) {
      const T* other = K + j * n;
      T sum = row[j];
      for (std::size_t k = 0; k < j; ++k) sum = fma(-row[k], other[k], sum);
      row[j] = sum;  // L_ij D_j for now
    }
    for (std::size_t j = 0; j < i; ++j) {
      const T scaled = row[j] * pivot_inverse[j];
      pivot = fma(-scaled, row[j], pivot);
      row[j] = scaled;
    }
    const auto counts = pivot > max(T(SolverTraits<R>::kRedundancy) * whole, max(immovable[i], tiny));
    pivot_inverse[i] = select(counts, one / select(counts, pivot, one), zero);
  }
}

/// x (n) := K^-1 x. X is T, or Vec3<T> for three right-hand sides at once.
template <Number T, class X>
MANYHANDS_INLINE void solve_K(const T* K, const T* pivot_inverse, std::size_t n, X* x) {
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) x[i] = fma(-K[i * n + j], x[j], x[i]);
  for (std::size_t i = 0; i < n; ++i) x[i] = x[i] * pivot_inverse[i];
  for (std::size_t i = n; i-- > 0;)
    for (std::size_t j = i + 1; j < n; ++j) x[i] = fma(-K[j * n + i], x[j], x[i]);
}

/// Calls body(row, closing velocity) for every row.
template <Number T, class Body>
MANYHANDS_INLINE void visit_closing(const ContactProblem<T>& problem, Body&& body) {
  for (const EqualityRows<T>& block : problem.equalities) {
    const std::array<T, 3> closing{block.closing.x, block.closing.y, block.closing.z};
    for (std::size_t r = 0; r < block.count(); ++r) body(block.first + r, closing[r]);
  }
}

/// What joints cannot do of the closing velocities c in `velocities`: (R (K + R)^-1)^passes c, with R a part of the
/// mobility in any direction (iterated Tikhonov regularisation: Engl, Hanke and Neubauer 1996, section 5.1); all of
/// it where something stands far open, which may be out of reach. To hold a velocity never costs energy, however
/// singular the joints are; to close an error may ask for any. Before K is factored.
template <Number T>
MANYHANDS_INLINE void damp_closing(const ContactProblem<T>& problem, std::vector<T>& velocities, Factors<T>& factors) {
  const std::size_t n = problem.num_equality_rows;
  mask_t<T> far(false);
  for (const EqualityRows<T>& block : problem.equalities) far = far | block.far;
  const T yields =
      select(far, constant<T>(contact_settings::kFarClosingYields), constant<T>(contact_settings::kClosingYields));
  for (const EqualityRows<T>& block : problem.equalities)
    std::fill_n(&factors.damping[block.first], block.count(), yields * mobility_of(problem, block));
  std::copy_n(factors.K.begin(), n * n, factors.K_damped.begin());
  for (std::size_t i = 0; i < n; ++i) factors.K_damped[i * n + i] += factors.damping[i];
  factor_K(n, factors.K_immovable.data(), factors.K_damped.data(), factors.K_damped_pivot_inverse.data());
  for (int pass = 0; pass < contact_settings::kClosingPasses; ++pass) {
    solve_K(factors.K_damped.data(), factors.K_damped_pivot_inverse.data(), n, velocities.data());
    for (std::size_t i = 0; i < n; ++i) velocities[i] = factors.damping[i] * velocities[i];
  }
}

/// Before a search for the joints' states: nothing is known of what they can do.
template <Number T>
MANYHANDS_INLINE void begin_closing(Factors<T>& factors) {
  for (T& closing : factors.closing) closing = constant<T>(std::numeric_limits<double>::infinity());
}

/// How fast the equality constraints shall close, in the worlds whose active set is new: as fast as they want where
/// that is slow, else as joints can, and never faster than under the active set before. What a joint that is let go
/// would add pushes it back beyond its limit, and the search would not end.
template <Number T>
MANYHANDS_INLINE void find_closing(const ContactProblem<T>& problem, mask_t<T> is_new, std::vector<T>& scratch,
                                   Factors<T>& factors) {
  const T zero = constant<T>(0), one = constant<T>(1);
  T fastest = zero, before = zero, now = zero;
  scratch.resize(problem.num_equality_rows);
  visit_closing(problem, [&](std::size_t i, T closing) {
    before = fma(factors.closing[i], factors.closing[i], before);
    fastest = max(fastest, abs(closing));
    scratch[i] = closing;
  });
  const auto asked = fastest > constant<T>(contact_settings::kSlowCorrection);
  when(asked, [&] { damp_closing(problem, scratch, factors); });
  visit_closing(problem, [&](std::size_t i, T closing) {
    const T able = closing - select(asked, scratch[i], zero);
    now = fma(able, able, now);
    factors.closing[i] = select(is_new, able, factors.closing[i]);
  });
  const auto grows = is_new & (now > before);
  when(grows, [&] {
    const T slower = select(grows, sqrt(before / select(grows, now, one)), one);
    visit_closing(problem, [&](std::size_t i, T) { factors.closing[i] = slower * factors.closing[i]; });
  });
}

/// Y of every equality constraint, and the factors of K = Y Y^T over all their rows. `is_new`: see `find_closing`.
template <Number T>
MANYHANDS_INLINE void factor_equalities(const ContactProblem<T>& problem, mask_t<T> is_new, std::vector<T>& scratch,
                                        Factors<T>& factors) {
  const std::size_t n = problem.num_equality_rows;
  for (std::size_t j = 0; j < problem.equalities.size(); ++j) {
    const EqualityRows<T>& block = problem.equalities[j];
    compute_Y(problem, block.rows, factors);
    store_Y(block.rows, factors);
    std::fill_n(&factors.K_immovable[block.first], block.count(), immovable_equality(problem, factors, block));
    for (std::size_t i = 0; i <= j; ++i) {
      const EqualityRows<T>& other = problem.equalities[i];
      const std::array<Vec3<T>, 3> K = multiply_YYT(other.rows, factors.Y.data(), block.rows, factors.Y_by_dof.data());
      for (std::size_t r = 0; r < other.count(); ++r) {
        const std::array<T, 3> column{K[r].x, K[r].y, K[r].z};
        for (std::size_t k = i < j ? 0 : r; k < block.count(); ++k)
          factors.K[(block.first + k) * n + other.first + r] = column[k];
      }
    }
  }
  find_closing(problem, is_new, scratch, factors);
  factor_K(n, factors.K_immovable.data(), factors.K.data(), factors.K_pivot_inverse.data());
}

/// Satisfies the equality constraints at the present dv, in the worlds of the mask: their impulses change, and dv with
/// them.
template <Number T>
MANYHANDS_INLINE void close_equalities(const ContactProblem<T>& problem, const Factors<T>& factors, mask_t<T> active,
                                       std::vector<T>& scratch, Iterate<T>& iterate) {
  if (problem.equalities.empty()) return;
  const T zero = constant<T>(0);
  scratch.resize(problem.num_equality_rows);
  for (const EqualityRows<T>& block : problem.equalities) {
    const Vec3<T> u = block.offset + multiply_J(*problem.tree, block.rows, problem.rows, iterate.dv.data());
    const std::array<T, 3> rate{u.x, u.y, u.z};
    for (std::size_t r = 0; r < block.count(); ++r)
      scratch[block.first + r] = -(rate[r] + factors.closing[block.first + r]);
  }
  solve_K(factors.K.data(), factors.K_pivot_inverse.data(), problem.num_equality_rows, scratch.data());
  for (std::size_t k = 0; k < problem.equalities.size(); ++k) {
    const EqualityRows<T>& block = problem.equalities[k];
    const T *x = &scratch[block.first], most = block.max_impulse;
    const bool single = block.rows.single;
    const Vec3<T> total = iterate.equalities[k] + Vec3<T>{x[0], single ? zero : x[1], single ? zero : x[2]};
    const Vec3<T> limited{clamp(total.x, -most, most), clamp(total.y, -most, most), clamp(total.z, -most, most)};
    const Vec3<T> next = select(active, limited, iterate.equalities[k]);
    add_YT(block.rows, factors.Y.data(), next - iterate.equalities[k], iterate.y.data());
    iterate.equalities[k] = next;
  }
  apply_change(problem, factors, iterate);
}

/// Takes the equality constraints' response to rows off their Y in Y_by_dof; Z (rows) keeps it. After `compute_Y` for
/// those rows.
template <Number T>
MANYHANDS_INLINE void eliminate_equalities(const ContactProblem<T>& problem, const RowBlock& rows, Vec3<T>* Z,
                                           Factors<T>& factors) {
  const Vec3<T>* Y = factors.Y.data();
  for (const EqualityRows<T>& block : problem.equalities) {
    const std::array<Vec3<T>, 3> H = multiply_YYT(block.rows, Y, rows, factors.Y_by_dof.data());
    std::copy_n(H.begin(), block.count(), Z + block.first);
  }
  solve_K(factors.K.data(), factors.K_pivot_inverse.data(), problem.num_equality_rows, Z);
  for (const EqualityRows<T>& block : problem.equalities) {
    const Vec3<T>* own = Z + block.first;
    visit_Y(block.rows, [&](std::size_t entry, std::size_t dof) {
      Vec3<T>& x = factors.Y_by_dof[dof];
      x = fma(-Y[entry].x, own[0], x);
      if (!block.rows.single) x = fma(-Y[entry].y, own[1], fma(-Y[entry].z, own[2], x));
    });
  }
}

/// What the impulses of equality constraints become by the contacts' changes since they were last closed.
template <Number T>
MANYHANDS_INLINE void follow_contacts(const ContactProblem<T>& problem, const Factors<T>& factors,
                                      Iterate<T>& iterate) {
  if (problem.num_equality_rows == 0) return;
  const Vec3<T>* Z = factors.Z.data();
  const auto follow = [&](const Vec3<T>& change) {
    for (std::size_t k = 0; k < problem.equalities.size(); ++k) {
      const EqualityRows<T>& block = problem.equalities[k];
      const Vec3<T>* own = Z + block.first;
      Vec3<T>& impulse = iterate.equalities[k];
      impulse.x -= dot(own[0], change);
      if (block.rows.single) continue;
      impulse.y -= dot(own[1], change);
      impulse.z -= dot(own[2], change);
    }
    Z += problem.num_equality_rows;
  };
  for (std::size_t k = 0; k < problem.patches.size(); ++k) {
    const ContactPatch<T>& patch = problem.patches[k];
    const Force<T> force = patch_force(problem, iterate, patch), change = force - iterate.patches[k].at_closing;
    follow(change.f);
    if (patch.turns) follow(change.n);
    iterate.patches[k].at_closing = force;
  }
}

}  // namespace manyhands::internal
