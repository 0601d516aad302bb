// The springs of joints: force = stiffness (reference - q); of ball joints and rotations of free ones, along the
// rotation vector from q to the reference, as in MuJoCo.
#pragma once

#include "manyhands/math/control_flow.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/physics/dynamics/params.h"
#include "manyhands/physics/dynamics/tree.h"

namespace manyhands {

namespace internal {

/// How far a joint is from where its spring rests, dof by dof [rad or m]. q and reference: the joint's coordinates.
template <Number T, Number P>
MANYHANDS_INLINE std::array<T, 6> spring_stretch(const TreeBody<real_t<T>>& body, const T* q, const P* reference) {
  const auto rotation = [](const T* a, const P* b) {
    const Quat<T> back{-broadcast<T>(b[0]), -broadcast<T>(b[1]), -broadcast<T>(b[2]), broadcast<T>(b[3])};
    return rotation_vector(Quat<T>{a[0], a[1], a[2], a[3]} * back);
  };
  const auto shift = [&](int k) { return q[k] - broadcast<T>(reference[k]); };
  std::array<T, 6> stretch{};
  switch (body.type) {
    case JointType::kFloating:
      for (std::size_t k = 0; k < 3; ++k) stretch[3 + k] = shift(static_cast<int>(k));
      q += 3;
      reference += 3;
      [[fallthrough]];
    case JointType::kSpherical: {
      const Vec3<T> r = rotation(q, reference);
      stretch[0] = r.x;
      stretch[1] = r.y;
      stretch[2] = r.z;
      break;
    }
    default:
      for (int k = 0; k < body.nv; ++k) stretch[static_cast<std::size_t>(k)] = shift(k);
      break;
  }
  return stretch;
}

}  // namespace internal

/// Calls visit(dof, stiffness, stretch) for every dof that has a spring in any world; where it has none, stiffness is
/// 0.
template <Number T, Number P, class Visit>
MANYHANDS_INLINE void visit_springs(const Tree<real_t<T>>& tree, const Params<P>& params, const T* q, Visit&& visit) {
  P stiffest = constant<P>(0);
  for (const P& stiffness : params.stiffness) stiffest = max(stiffest, stiffness);
  if (!any(stiffest > constant<P>(0))) return;
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    const auto first = static_cast<std::size_t>(body.iv), end = first + static_cast<std::size_t>(body.nv);
    bool sprung = false;
    for (std::size_t i = first; i < end; ++i) sprung = sprung || any(params.stiffness[i] > constant<P>(0));
    if (!sprung) continue;
    const std::array<T, 6> stretch =
        internal::spring_stretch(body, q + body.iq, params.spring_reference.data() + body.iq);
    for (std::size_t i = first; i < end; ++i) visit(i, broadcast<T>(params.stiffness[i]), stretch[i - first]);
  }
}

}  // namespace manyhands
