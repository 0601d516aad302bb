// What tendons ask for: springs, dampers and armature join M and the smooth impulse; limits, dry friction, drives and
// equations between tendons are laws like those of joints, at J v. So are drives at sites.
#pragma once

#include "manyhands/physics/contact/joint_law_table.h"
#include "manyhands/physics/dynamics/lengths.h"
#include "manyhands/physics/dynamics/ltdl.h"
#include "manyhands/physics/dynamics/params.h"

namespace manyhands::internal {

/// Springs, dampers and armature, implicit as those of joints: M += J^T (armature + h damping + h^2 stiffness / 4) J,
/// and more where a spring is too stiff for the step. After `place_lengths`.
template <Number T, Number P>
MANYHANDS_INLINE void assemble_tendon_forces(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h,
                                             Workspace<T>& ws, JointLaws<T>& laws) {
  const T step(h), quarter(real_t<T>(0.25) * h * h), half(real_t<T>(0.5) * h * h);
  const T zero = constant<T>(0), one = constant<T>(1);
  const auto add = [&](std::size_t k, T mass, T force) {
    if (none(mass > zero)) return;
    add_along_length(tree, ws, k, step * force, laws.smooth.data());
    add_length_square(tree, ws, k, mass, ws.M.data(), [&](std::size_t) { return one; });
  };
  for (std::size_t k = 0; k < params.tendon_damping.size(); ++k) {
    const T damping = broadcast<T>(params.tendon_damping[k]), armature = broadcast<T>(params.tendon_armature[k]);
    add(k, fma(step, damping, armature), -fma(damping, ws.length_rate[k], armature * ws.length_bend[k]));
  }
  visit_tendon_springs(params, ws, [&](std::size_t k, T stiffness, T stretch) {
    const T meets = length_inertia(tree, ws, k, zero, [&](std::size_t) { return one; });
    ws.spring_inertia[k] = max(quarter * stiffness, fma(half, stiffness, -meets));
    add(k, ws.spring_inertia[k], -stiffness * stretch);
  });
}

/// The inertia that each length meets while every other dof stands still, once M is whole.
template <Number T>
MANYHANDS_INLINE void find_length_inertia(const Tree<real_t<T>>& tree, Workspace<T>& ws) {
  const T zero = constant<T>(0), one = constant<T>(1);
  for (std::size_t k = 0; k < tree.lengths.size(); ++k)
    ws.length_inertia[k] = length_inertia(tree, ws, k, zero, [&](std::size_t) { return one; });
}

/// Where the search for a length's state begins: held where it shall be, or at a limit that it passes.
template <Number T>
MANYHANDS_INLINE T first_length_state(const JointLaws<T>& laws, std::size_t i) {
  using S = JointConstraintState;
  const T zero = constant<T>(0);
  const auto below = laws.lower[i] > zero, above = laws.upper[i] < zero;
  const T free = select(laws.max_impulse[i] > zero, constant<T>(S::kAtTarget), constant<T>(S::kSaturatedUp));
  return select(below, constant<T>(S::kAtLower), select(above, constant<T>(S::kAtUpper), free));
}

/// Dry friction of length k, times the step; only tendons have any.
template <Number T, Number P>
MANYHANDS_INLINE T length_friction(const Params<P>& params, T step, std::size_t k) {
  return k < params.tendon_friction.size() ? step * broadcast<T>(params.tendon_friction[k]) : constant<T>(0);
}

/// Before the actuators.
template <Number T, Number P>
MANYHANDS_INLINE void begin_length_drives(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h,
                                          JointLaws<T>& laws) {
  for (std::size_t k = 0; k < tree.lengths.size(); ++k) {
    const std::size_t i = index(tree.nv) + k;
    if (tree.dof_drive[i] >= 0) begin_drive(length_friction(params, T(h), k), i, laws);
  }
}

/// A coupling or limits that give way: their law has a slope through the velocity at which they give no impulse. As
/// MuJoCo's, limits act once they are passed.
template <Number T, Number P>
[[gnu::noinline]] void aim_yielding_length(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h,
                                           const Workspace<T>& ws, std::size_t k, JointLaws<T>& laws) {
  const TreeLength<real_t<T>>& length = tree.lengths[k];
  const std::size_t nv = index(tree.nv), i = nv + k;
  const T zero = constant<T>(0), infinity = constant<T>(std::numeric_limits<double>::infinity());
  const T value = ws.length[k];
  T error = value;
  const bool is_limit = length.limited >= 0;
  if (is_limit) {
    const auto of = index(length.limited);
    const T lower = broadcast<T>(of < nv ? params.lower[of] : params.tendon_lower[of - nv]);
    const T upper = broadcast<T>(of < nv ? params.upper[of] : params.tendon_upper[of - nv]);
    error = select(value < lower, value - lower, select(value > upper, value - upper, zero));
  }
  const T least = constant<T>(1 / SolverTraits<real_t<T>>::kStiffest) /
                  max(ws.length_inertia[k], constant<T>(SolverTraits<real_t<T>>::kSmallest));
  const TreeCompliance<real_t<T>>& c = *length.compliance;
  const T mobility(length.mobility), rate = ws.length_rate[k];
  const YieldingRow<T> row = is_limit ? pushing_row(c, h, mobility, least, error, rate)
                                      : yielding_row(c, h, impedance_at(c, error), mobility, least, error, rate);
  const T free = row.pull / row.slope;
  laws.slope[i] = row.slope;
  if (!is_limit) {
    laws.max_impulse[i] = constant<T>(contact_settings::kMaxImpulse);
    aim_at(free, i, laws);
    return;
  }
  laws.lower[i] = select(error < zero, free, -infinity);
  laws.upper[i] = select(error > zero, free, infinity);
  laws.max_impulse[i] = zero;
  aim_at(infinity, i, laws);
}

/// The laws of all lengths, behind those of the dofs. After the actuators.
template <Number T, Number P>
MANYHANDS_INLINE void assemble_length_laws(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h,
                                           const Workspace<T>& ws, JointLaws<T>& laws) {
  const T step(h), inverse_h(real_t<T>(1) / h), half_h(real_t<T>(0.5) * h), zero = constant<T>(0);
  const T infinity = constant<T>(std::numeric_limits<double>::infinity());
  const T most = constant<T>(contact_settings::kMaxImpulse), fastest = constant<T>(contact_settings::kMaxClosing);
  for (std::size_t k = 0; k < tree.lengths.size(); ++k) {
    const std::size_t i = static_cast<std::size_t>(tree.nv) + k;
    const T rate = ws.length_rate[k], drift = rate + bounded_arc(half_h * ws.length_bend[k]);
    laws.lower[i] = -infinity;
    laws.upper[i] = infinity;
    if (tree.lengths[k].compliance) {
      aim_yielding_length(tree, params, h, ws, k, laws);
    } else if (tree.lengths[k].type == LengthType::kCoupling) {
      laws.max_impulse[i] = min(step * T(tree.lengths[k].max_force), most);
      aim_at(-drift - clamp(inverse_h * ws.length[k], -fastest, fastest), i, laws);
    } else {
      if (tree.lengths[k].stops) {
        const T lower = broadcast<T>(params.tendon_lower[k]), upper = broadcast<T>(params.tendon_upper[k]);
        laws.lower[i] = limit_velocity(lower - ws.length[k], inverse_h) - drift;
        laws.upper[i] = -limit_velocity(ws.length[k] - upper, inverse_h) - drift;
      }
      if (tree.dof_drive[i] >= 0) {
        aim_drive(rate, i, laws);
      } else {
        const T friction = length_friction(params, step, k);
        laws.max_impulse[i] = friction;
        aim_at(select(friction > zero, -rate, infinity), i, laws);
      }
    }
    laws.constrained[i] = constant<T>(1);
    laws.last_impulse[i] = laws.smooth[i] = zero;
    for (std::size_t j = 0; j < tree.lengths[k].dofs.size(); ++j) {
      const auto dof = static_cast<std::size_t>(tree.lengths[k].dofs[j]);
      laws.smooth[i] = fma(abs(ws.length_J[tree.lengths[k].J + j]), abs(laws.smooth[dof]), laws.smooth[i]);
    }
    const T first = first_length_state(laws, i);
    laws.first_state[i] = tree.dof_drive[i] >= 0 ? first_drive_state(first, zero, i, laws) : first;
  }
}

}  // namespace manyhands::internal
