// One contact point, solved exactly: Signorini's law, Coulomb's cone and maximum dissipation, given all other impulses.
//
// In the basis of README.md, where tangent rows are scaled by friction and turned as in delassus.h, the impulse (n, y)
// and the velocity u must satisfy
//     u_n >= 0, n >= 0, u_n n = 0, |y| <= n, and u_t = -kappa y with kappa >= 0 where |y| = n, u_t = 0 where |y| < n.
#pragma once

#include "manyhands/math/control_flow.h"
#include "manyhands/physics/contact/delassus.h"
#include "manyhands/physics/contact/settings.h"

namespace manyhands {

/// A tangential impulse y on the rim of its cone: (sigma_i + kappa) y_i = h_i, |y| = rest - slope . y. Newton's method
/// on 1 / |y|, which is nearly linear in kappa (Moré and Sorensen 1983), one number whatever the anisotropy. Written in
/// x = 1 / (kappa + least sigma) and w_i = (sigma_i + kappa) x >= 1, so that a step divides but twice. It begins at the
/// x of the last visit, or, where that is 0, where an isotropic contact ends. Lanes outside `slides` keep their x and
/// y.
template <Number T>
MANYHANDS_INLINE void slide(const DelassusBlock<T>& G, T h_1, T h_2, T rest, mask_t<T> slides, T& x, T& y_1, T& y_2,
                            T& radius) {
  using R = real_t<T>;
  const T zero = constant<T>(0), one = constant<T>(1), tiny = constant<T>(16 * std::numeric_limits<R>::min());
  const T wedge = constant<T>(contact_settings::kMinWedge), tolerance = constant<T>(contact_settings::kSlideTolerance);
  const auto squeeze = [&](T d_1, T d_2) { return max(fma(G.slope_1, d_1, fma(G.slope_2, d_2, one)), wedge); };
  const T least = min(G.sigma_1, G.sigma_2), more_1 = G.sigma_1 - least, more_2 = G.sigma_2 - least;
  x = select(slides, min(x, max(G.inverse_1, G.inverse_2)), x);
  const auto begins = slides & !(x > zero);
  when(begins, [&] {
    const T pull = max(sqrt(fma(h_1, h_1, h_2 * h_2)), tiny), inverse_pull = one / pull;
    const T d_1 = h_1 * inverse_pull, d_2 = h_2 * inverse_pull;
    const T more = fma(d_1 * d_1, more_1, (d_2 * d_2) * more_2);
    x = select(begins, rest / max(max(fma(pull, squeeze(d_1, d_2), -(more * rest)), least * rest), tiny), x);
  });
  T d_1 = zero, d_2 = zero, squeezed = one;
  iterate(slides, SolverTraits<R>::kSlideSteps, [&](mask_t<T> active) {
    const T w_1 = fma(more_1, x, one), w_2 = fma(more_2, x, one);
    const T a_1 = h_1 * w_2, a_2 = h_2 * w_1;  // along y
    const T length = max(sqrt(fma(a_1, a_1, a_2 * a_2)), tiny), inverse_length = one / length;
    d_1 = select(active, a_1 * inverse_length, d_1);
    d_2 = select(active, a_2 * inverse_length, d_2);
    squeezed = select(active, squeeze(d_1, d_2), squeezed);
    const T rim = (w_1 * w_2) * rest, excess = fma(length * x, squeezed, -rim);  // of |y|, both times w_1 w_2
    const T fall = fma(d_1 * d_1, w_2, (d_2 * d_2) * w_1) * rest;
    x = select(active, (x * fall) / max(fall + excess, fall * (x * least)), x);  // kappa stays at 0 or above
    return abs(excess) > tolerance * rim;
  });
  const T rim = rest / squeezed;
  radius = select(slides, rim, radius);
  y_1 = select(slides, rim * d_1, y_1);
  y_2 = select(slides, rim * d_2, y_2);
}

/// The contact's impulse (n, y_1, y_2) that obeys its law, where the present one gives the velocity u; along the turned
/// tangents. x is what `slide` goes on from.
template <Number T>
MANYHANDS_INLINE Vec3<T> solve_coulomb(const DelassusBlock<T>& G, const Vec3<T>& u, const Vec3<T>& impulse, T& x) {
  const T zero = constant<T>(0);
  // n if y were 0; at or below it the surfaces part.
  const T rest = impulse.x - fma(u.x, G.normal_inverse, -fma(G.slope_1, impulse.y, G.slope_2 * impulse.z));
  // sigma y of the y at which sliding would stop.
  const T h_1 = fma(G.sigma_1, impulse.y, -fma(-G.slope_1, u.x, u.y));
  const T h_2 = fma(G.sigma_2, impulse.z, -fma(-G.slope_2, u.x, u.z));
  T y_1 = h_1 * G.inverse_1, y_2 = h_2 * G.inverse_2;
  T n = rest - fma(G.slope_1, y_1, G.slope_2 * y_2);
  const auto closed = (rest > zero) & (G.normal_inverse > zero);
  const auto outside = !(fma(y_1, y_1, y_2 * y_2) <= n * abs(n));
  when(closed & outside, [&] { slide(G, h_1, h_2, rest, closed & outside, x, y_1, y_2, n); });
  return {select(closed, n, zero), select(closed, y_1, zero), select(closed, y_2, zero)};
}

/// y, along the turned tangents, within a disc of the given radius that stops a rotation if it can: torsional or
/// rolling friction. x is what `slide` goes on from.
template <Number T>
MANYHANDS_INLINE void solve_disc(const DelassusBlock<T>& G, T u_1, T u_2, T radius, T& x, T& y_1, T& y_2) {
  const T zero = constant<T>(0), h_1 = fma(G.sigma_1, y_1, -u_1), h_2 = fma(G.sigma_2, y_2, -u_2);
  const auto resists = radius > zero;
  y_1 = select(resists, h_1 * G.inverse_1, zero);
  y_2 = select(resists, h_2 * G.inverse_2, zero);
  // Of impulses below 1e-19 the squares vanish in float.
  const auto outside = resists & (fma(y_1, y_1, y_2 * y_2) > radius * radius);
  T rim = radius;
  when(outside, [&] { slide(G, h_1, h_2, radius, outside, x, y_1, y_2, rim); });
}

}  // namespace manyhands
