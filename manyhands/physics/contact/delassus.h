// The diagonal block of the Delassus operator that belongs to one contact point, in the form that its solution needs.
#pragma once

#include "manyhands/math/vec3.h"
#include "manyhands/physics/contact/settings.h"

namespace manyhands {

/// G = J A J^T of one contact point's rows (normal, e_1, e_2), with the tangents turned until what resists sliding is
/// diagonal. A change of the impulse (n, y) changes the point's velocity by
///     du_n = G_nn (dn + slope . dy),    du_t = sigma dy + slope du_n.
template <Number T>
struct DelassusBlock {
  T normal;                ///< G_nn [1/kg]
  T normal_inverse;        ///< 1 / G_nn, the effective mass; 0 where no joint can move the point along the normal
  T slope_1, slope_2;      ///< g / G_nn, where g couples the normal with the tangents
  T sigma_1, sigma_2;      ///< G_tt - g g^T / G_nn, diagonal [1/kg]
  T inverse_1, inverse_2;  ///< 1 / sigma
  T c, s;                  ///< of the angle by which the tangents are turned for that
  T softness;              ///< what the contact yields to its normal impulse by itself, in G_nn too [1/kg]
  T opening_softness;      ///< the same of its opening

  /// From the contact's tangents to those in which the above is given, and back.
  MANYHANDS_INLINE Vec3<T> turned(const Vec3<T>& a) const {
    return {a.x, fma(c, a.y, s * a.z), fma(c, a.z, -(s * a.y))};
  }
  MANYHANDS_INLINE Vec3<T> turned_back(const Vec3<T>& a) const {
    return {a.x, fma(c, a.y, -(s * a.z)), fma(c, a.z, s * a.y)};
  }
  /// The velocity by which it yields to the normal impulse n; of what it shall open, no more than all.
  MANYHANDS_INLINE T yields(T n, T opening) const {
    return fma(softness, n, max(min(opening_softness * n, opening), constant<T>(0)));
  }
};

/// The block of G, where a soft surface adds `softness` to G_nn. Where G_nn is not above `immovable`, no joint can part
/// the surfaces, and the contact does nothing; where it is below `floor`, it yields as if it were as much.
template <Number T>
MANYHANDS_INLINE DelassusBlock<T> diagonalise(const Mat3<T>& G, T softness, T immovable, T floor, T opening_softness) {
  const T zero = constant<T>(0), one = constant<T>(1), half = constant<T>(0.5),
          tiny = constant<T>(SolverTraits<real_t<T>>::kSmallest);
  DelassusBlock<T> block;
  const auto moves = G.x.x + softness > max(immovable, tiny);
  block.softness = softness + max(floor - G.x.x, zero);
  block.opening_softness = opening_softness;
  block.normal = G.x.x + (block.softness + opening_softness);
  block.normal_inverse = select(moves, one / max(block.normal, tiny), zero);
  const T g_1 = G.x.y, g_2 = G.x.z;
  const T slope_1 = g_1 * block.normal_inverse, slope_2 = g_2 * block.normal_inverse;
  const T s_11 = fma(-g_1, slope_1, G.y.y), s_22 = fma(-g_2, slope_2, G.z.z), s_12 = fma(-g_1, slope_2, G.y.z);
  // The Jacobi rotation of at most 45 degrees.
  const T d = half * (s_11 - s_22), r = sqrt(fma(d, d, s_12 * s_12));
  const auto turned = r > tiny;
  const T ratio = abs(d) / select(turned, r, one);
  block.c = select(turned, sqrt(half * (one + ratio)), one);
  block.s = select(turned, copysign(one, d) * s_12 / (max(r, tiny) * (block.c + block.c)), zero);
  const T mean = half * (s_11 + s_22), spread = copysign(r, d);
  // Where the surfaces cannot slide at all, as on a link that has two joints before it, rounding leaves less than this.
  const T least = constant<T>(8 * static_cast<double>(std::numeric_limits<real_t<T>>::epsilon())) * (G.y.y + G.z.z);
  block.sigma_1 = max(mean + spread, least);
  block.sigma_2 = max(mean - spread, least);
  block.inverse_1 = one / max(block.sigma_1, tiny);
  block.inverse_2 = one / max(block.sigma_2, tiny);
  block.slope_1 = fma(block.c, slope_1, block.s * slope_2);
  block.slope_2 = fma(block.c, slope_2, -(block.s * slope_1));
  return block;
}

}  // namespace manyhands
