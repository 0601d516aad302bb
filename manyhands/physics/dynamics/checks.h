// What kernels are promised of trees and states, for their asserts.
#pragma once

#include <cstddef>

#include "manyhands/physics/dynamics/workspace.h"

namespace manyhands::internal {

/// Whether bodies and dofs are numbered as kernels walk them: parents first, within their arrays.
template <Real R>
[[nodiscard]] bool is_topology_sound(const Tree<R>& tree) {
  const auto nv = static_cast<std::size_t>(tree.nv);
  bool sound = !tree.bodies.empty() && tree.dof_parent.size() == nv && tree.dof_q.size() == nv;
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    const TreeBody<R>& body = tree.bodies[b];
    sound = sound && body.parent >= 0 && static_cast<std::size_t>(body.parent) < b;
    sound = sound && body.iv >= 0 && body.nv >= 0 && body.iv + body.nv <= tree.nv;
    sound = sound && body.iq >= 0 && body.iq <= tree.nq;
  }
  for (std::size_t i = 0; i < nv && sound; ++i) {
    sound = tree.dof_parent[i] >= -1 && tree.dof_parent[i] < static_cast<int>(i);
    sound = sound && tree.dof_q[i] >= -1 && tree.dof_q[i] < tree.nq;
  }
  return sound;
}

/// Whether the parameters and the workspace are those of the tree's bodies and dofs.
template <Number T>
[[nodiscard]] bool fit(const Tree<real_t<T>>& tree, const auto& params, const Workspace<T>& ws) {
  const std::size_t nb = tree.bodies.size(), nv = tree.dof_parent.size();
  return params.inertia.size() == nb && params.armature.size() == nv && ws.V.size() == nb && ws.S.size() == nv;
}

template <Number T>
[[nodiscard]] bool all_finite(const T* values, int n) {
  auto finite = is_finite(T(real_t<T>(0)));
  for (int i = 0; i < n; ++i) finite = finite & is_finite(values[i]);
  return all(finite);
}

/// Whether all quaternions of q have unit length, to what single precision loses in a step.
template <Number T>
[[nodiscard]] bool are_quaternions_unit(const Tree<real_t<T>>& tree, const T* q) {
  using R = real_t<T>;
  for (const TreeBody<R>& body : tree.bodies) {
    if (body.type != JointType::kSpherical && body.type != JointType::kFloating) continue;
    const T* const xyzw = q + body.iq + (body.type == JointType::kFloating ? 3 : 0);
    T squared(R(0));
    for (int i = 0; i < 4; ++i) squared = squared + xyzw[i] * xyzw[i];
    if (!all(abs(squared - T(R(1))) < T(R(1e-3)))) return false;
  }
  return true;
}

}  // namespace manyhands::internal
