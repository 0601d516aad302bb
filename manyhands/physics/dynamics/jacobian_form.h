// The three ways to write the velocity of a frame.
#pragma once

namespace manyhands {

/// About which point, and in which axes, J v is the frame's spatial velocity.
enum class JacobianForm {
  kMixed,  ///< the frame's origin, world axes: (omega, velocity of the origin)
  kSpace,  ///< the world's origin, world axes: the space Jacobian of Lynch and Park
  kBody,   ///< the frame's origin, the frame's axes: their body Jacobian
};

}  // namespace manyhands
