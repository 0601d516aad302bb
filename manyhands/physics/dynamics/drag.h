// The drag of a medium on links, as on the boxes of their inertia (MuJoCo's inertia-box model). Along and about each
// axis of the box
//     f = -(3 pi d mu + rho A |v| / 2) v,    n = -(pi d^3 mu + rho l (l_2^4 + l_3^4) |w| / 64) w,
// where d is the mean of its lengths l, A the face that the axis pierces, mu the viscosity, and rho the density.
#pragma once

#include "manyhands/physics/dynamics/kinematics.h"
#include "manyhands/physics/dynamics/ltdl.h"

namespace manyhands {

/// What the medium does to one link: F = -C (V - wind), C diagonal along the axes of a box.
template <Number T>
struct Drag {
  Mat3<T> R_WB;    ///< the box's axes
  Vec3<T> p_OB;    ///< its centre from its tree's origin [m]
  Motion<T> C;     ///< the diagonal [N m s/rad, N s/m]
  Force<T> force;  ///< about the tree's origin [N m, N]

  /// C times a motion about the tree's origin.
  [[nodiscard]] MANYHANDS_INLINE Force<T> resist(const Motion<T>& motion) const {
    const Vec3<T> w = transpose_times(R_WB, motion.w);
    const Vec3<T> v = transpose_times(R_WB, motion.v + cross(motion.w, p_OB));
    const Vec3<T> f = R_WB * Vec3<T>{C.v.x * v.x, C.v.y * v.y, C.v.z * v.z};
    return {R_WB * Vec3<T>{C.w.x * w.x, C.w.y * w.y, C.w.z * w.z} + cross(p_OB, f), f};
  }
};

namespace internal {

template <Number T>
MANYHANDS_INLINE Drag<T> drag_on(const Tree<real_t<T>>& tree, const TreeDrag<real_t<T>>& link, const Workspace<T>& ws) {
  const auto along = [](const Vec3<real_t<T>>& rate, T linear, const Vec3<T>& u) {
    return Vec3<T>{fma(T(rate.x), abs(u.x), linear), fma(T(rate.y), abs(u.y), linear),
                   fma(T(rate.z), abs(u.z), linear)};
  };
  Drag<T> drag;
  drag.R_WB = ws.R_WB[link.body] * broadcast<T>(link.X_BK.R);
  drag.p_OB = ws.R_WB[link.body] * broadcast<T>(link.X_BK.p) + ws.p_OB[link.body];
  Motion<T> V = ws.V[link.body];
  V.v = V.v - broadcast<T>(tree.wind);
  const Vec3<T> v = V.v + cross(V.w, drag.p_OB);
  drag.C.v = along(link.per_speed, T(link.linear), transpose_times(drag.R_WB, v));
  drag.C.w = along(link.per_rate, T(link.angular), transpose_times(drag.R_WB, V.w));
  const Force<T> resistance = drag.resist(V);
  drag.force = {-resistance.n, -resistance.f};
  return drag;
}

}  // namespace internal

/// Calls visit(dof, force) with what the medium adds to every dof that moves a link. Where bodies are placed and moved.
template <Number T, class Visit>
MANYHANDS_INLINE void visit_drag(const Tree<real_t<T>>& tree, const Workspace<T>& ws, Visit&& visit) {
  for (const TreeDrag<real_t<T>>& link : tree.drags) {
    const Force<T> force = internal::drag_on(tree, link, ws).force;
    for (const int i : tree.path_of(link.body)) visit(index(i), dot(ws.S[index(i)], force));
  }
}

/// Drag in a step of length h, linearly implicit, so that no body is turned back by it: impulse (nv) += h J^T F and
/// M += h J^T C J. Where bodies are placed and moved.
template <Number T>
MANYHANDS_INLINE void add_drag(const Tree<real_t<T>>& tree, real_t<T> h, T* impulse, Workspace<T>& ws) {
  const T step(h);
  for (const TreeDrag<real_t<T>>& link : tree.drags) {
    const Drag<T> drag = internal::drag_on(tree, link, ws);
    for (const int i : tree.path_of(link.body)) {
      impulse[i] = fma(step, dot(ws.S[index(i)], drag.force), impulse[i]);
      const Force<T> resistance = step * drag.resist(ws.S[index(i)]);
      T* const row = tree_row(tree, ws.M.data(), index(i));
      for (int j = i; j >= 0; j = tree.dof_parent[index(j)]) row[j] += dot(ws.S[index(j)], resistance);
    }
  }
}

}  // namespace manyhands
