// How well the joints move a frame, in every direction.
#pragma once

#include <span>

#include "manyhands/math/singular_values.h"

namespace manyhands {

/// Which rows of a Jacobian (6, nv) are judged. Those of all six depend on the unit of length.
enum class VelocityPart { kAngular, kLinear, kAll };

/// Of the Jacobian.
[[nodiscard]] constexpr std::size_t rows_of(VelocityPart part) { return part == VelocityPart::kAll ? 6 : 3; }

template <Number T>
struct Manipulability {
  T measure;    ///< sqrt(det(J J^T)), the product of the singular values (Yoshikawa, Int. J. Robotics Res. 4(2), 1985)
  T condition;  ///< the longest over the shortest; infinite at a singular posture
  T isotropy;   ///< its inverse: 1 where all directions are alike, 0 at a singular posture
};

/// Of J (6, nv), which is overwritten. Joint velocities of unit length move the frame within an ellipsoid: its
/// semi-axes have the `lengths` (m), falling, and the columns of `axes` (m, m; by rows) as directions; m is
/// rows_of(part).
template <Number T>
MANYHANDS_INLINE Manipulability<T> manipulability(VelocityPart part, std::size_t nv, T* J, T* lengths, T* axes) {
  const std::size_t m = rows_of(part);
  singular_values(part == VelocityPart::kLinear ? J + 3 * nv : J, m, nv, lengths, axes);
  Manipulability<T> found{lengths[0], lengths[0] / lengths[m - 1], lengths[m - 1] / lengths[0]};
  for (std::size_t i = 1; i < m; ++i) found.measure = found.measure * lengths[i];
  const T zero = constant<T>(0);
  const mask_t<T> still = lengths[0] == zero;  // no joint moves the frame
  found.condition = select(still, T(std::numeric_limits<real_t<T>>::infinity()), found.condition);
  found.isotropy = select(still, zero, found.isotropy);
  return found;
}

/// What the rows of `manipulability_of_rows` are written to.
template <Real R>
struct ManipulabilityRows {
  std::span<R> measure, condition, isotropy;  ///< (n)
  std::span<R> lengths;                       ///< (n, m)
  std::span<R> axes;                          ///< (n, m, m)
};

/// The same of n Jacobians (n, 6, nv): float in lanes, double one after the other.
template <Real R>
void manipulability_of_rows(VelocityPart part, std::size_t n, std::size_t nv, std::span<const R> J,
                            const ManipulabilityRows<R>& found);

}  // namespace manyhands
