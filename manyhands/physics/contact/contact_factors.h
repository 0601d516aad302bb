// The responses of contacts: Y of every patch, and the diagonal Delassus block of every point.
#pragma once

#include "manyhands/physics/contact/delassus.h"
#include "manyhands/physics/contact/equality_factors.h"

namespace manyhands::internal {

/// Y of one block of rows, as equality constraints leave it; G = Y Y^T. `scale`: the diagonal before them.
template <Number T>
MANYHANDS_INLINE Mat3<T> respond_to(const ContactProblem<T>& problem, const RowBlock& rows, Vec3<T>*& Z,
                                    Factors<T>& factors, Vec3<T>& scale) {
  compute_Y(problem, rows, factors);
  if (problem.num_equality_rows == 0) {
    const Mat3<T> G = store_Y(rows, factors);
    scale = {G.x.x, G.y.y, G.z.z};
    return G;
  }
  scale = mobility(rows, factors);
  eliminate_equalities(problem, rows, Z, factors);
  Z += problem.num_equality_rows;
  return store_Y(rows, factors);
}

/// Whether the point's target is one that might contradict others. Restitution takes no more than there was.
template <Number T>
MANYHANDS_INLINE mask_t<T> shall_open(const ContactPoint<T>& point) {
  const T zero = constant<T>(0);
  return (point.target > zero) & (point.softness == zero) & (point.bounces == zero);
}

/// Y of patch k, and the Delassus blocks of its points.
template <Number T>
MANYHANDS_INLINE void factor_patch(const ContactProblem<T>& problem, std::size_t k, Vec3<T>*& Z, Factors<T>& factors) {
  const ContactPatch<T>& patch = problem.patches[k];
  PatchResponse<T>& response = factors.patches[k];
  Vec3<T> linear, angular = Vec3<T>::zero();  // mobilities before equality constraints
  response.G_vf = respond_to(problem, patch.linear, Z, factors, linear);
  if (patch.turns) {
    response.G_wn = respond_to(problem, patch.angular, Z, factors, angular);
    const std::array<Vec3<T>, 3> G_vn =
        multiply_YYT(patch.linear, factors.Y.data(), patch.angular, factors.Y_by_dof.data());
    response.G_wf = {G_vn[0], G_vn[1], G_vn[2]};
  }
  const T cancelled(SolverTraits<real_t<T>>::kCancellation);
  const T immovable = immovable_at(problem, factors, patch.linear, patch.origin);
  const T floor = constant<T>(contact_settings::kLeastMobility) * factors.mobility[k];
  const T opening = constant<T>(contact_settings::kOpeningSoftness) * factors.mobility[k];
  for (std::size_t i = patch.first; i < patch.first + patch.count; ++i) {
    const ContactPoint<T>& point = problem.points[i];
    const Vec3<T>& r = point.lever;
    const T terms = fma(r.z * r.z, angular.y, fma(r.y * r.y, angular.z, linear.x));
    factors.points[i] =
        diagonalise(point_response(patch, response, r), point.softness, fma(cancelled, terms, immovable), floor,
                    select(shall_open(point), opening, constant<T>(0)));
  }
}

/// Y and Delassus blocks of all contacts, for the active set that was factored last. Of a world whose active set is
/// still the same they come out the same. After `find_mobility`.
template <Number T>
MANYHANDS_INLINE void factor_contacts(const ContactProblem<T>& problem, Factors<T>& factors) {
  const T zero = constant<T>(0), one = constant<T>(1);
  const T tiny = constant<T>(SolverTraits<real_t<T>>::kSmallest);
  factors.patches.resize(problem.patches.size());
  factors.points.resize(problem.points.size());
  factors.torsions.resize(problem.torsions.size());
  factors.spin_inverse.resize(problem.torsions.size());
  factors.Z.resize(2 * problem.num_equality_rows * problem.patches.size());
  Vec3<T>* Z = factors.Z.data();
  for (std::size_t k = 0; k < problem.patches.size(); ++k) factor_patch(problem, k, Z, factors);
  for (std::size_t i = 0; i < problem.torsions.size(); ++i) {
    const Mat3<T>& G = factors.patches[problem.torsions[i].patch].G_wn;
    // Spinning and rolling are solved apart: turn the rolling rows by their own block of G alone.
    const Mat3<T> rolling{{one, zero, zero}, {zero, G.y.y, G.y.z}, {zero, G.z.y, G.z.z}};
    factors.torsions[i] = diagonalise(rolling, zero, zero, zero, zero);
    factors.spin_inverse[i] = one / max(G.x.x, tiny);
  }
}

}  // namespace manyhands::internal
