// The responses of contacts: Y of every patch, and the diagonal Delassus block of every point.
#pragma once

#include "manyhands/physics/contact/delassus.h"
#include "manyhands/physics/contact/equality_factors.h"

namespace manyhands::internal {

template <Number T>
MANYHANDS_INLINE void factor_patch(const ContactProblem<T>& problem, const ContactPatch<T>& patch, Vec3<T>*& Z,
                                   Factors<T>& factors, PatchResponse<T>& response) {
  const std::size_t num_equality_rows = problem.num_equality_rows;
  const auto respond_to = [&](const RowBlock& rows) {
    compute_Y(problem, rows, factors);
    if (num_equality_rows > 0) eliminate_equalities(problem, rows, Z, factors);
    Z += num_equality_rows;
    return store_Y(rows, factors);
  };
  response.G_vf = respond_to(patch.linear);
  if (!patch.turns) return;
  response.G_wn = respond_to(patch.angular);
  const std::array<Vec3<T>, 3> G_vn =
      multiply_YYT(patch.linear, factors.Y.data(), patch.angular, factors.Y_by_dof.data());
  response.G_wf = {G_vn[0], G_vn[1], G_vn[2]};
}

/// Y and Delassus blocks of all contacts, for the active set that was factored last. Of a world whose active set is
/// still the same they come out the same.
template <Number T>
MANYHANDS_INLINE void factor_contacts(const ContactProblem<T>& problem, Factors<T>& factors) {
  const T zero = constant<T>(0), one = constant<T>(1);
  const T tiny = constant<T>(1e6 * std::numeric_limits<real_t<T>>::min());
  factors.patches.resize(problem.patches.size());
  factors.points.resize(problem.points.size());
  factors.torsions.resize(problem.torsions.size());
  factors.spin_inverse.resize(problem.torsions.size());
  factors.Z.resize(2 * problem.num_equality_rows * problem.patches.size());
  Vec3<T>* Z = factors.Z.data();
  for (std::size_t k = 0; k < problem.patches.size(); ++k)
    factor_patch(problem, problem.patches[k], Z, factors, factors.patches[k]);
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    const ContactPoint<T>& point = problem.points[i];
    const Mat3<T> G = point_response(problem.patches[point.patch], factors.patches[point.patch], point.lever);
    factors.points[i] = diagonalise(G, point.softness);
  }
  for (std::size_t i = 0; i < problem.torsions.size(); ++i) {
    const Mat3<T>& G = factors.patches[problem.torsions[i].patch].G_wn;
    // Spinning and rolling are solved apart: turn the rolling rows by their own block of G alone.
    const Mat3<T> rolling{{one, zero, zero}, {zero, G.y.y, G.y.z}, {zero, G.z.y, G.z.z}};
    factors.torsions[i] = diagonalise(rolling, zero);
    factors.spin_inverse[i] = one / max(G.x.x, tiny);
  }
}

}  // namespace manyhands::internal
