// Control flow over varying conditions.
#pragma once

#include "manyhands/math/lanes.h"

namespace manyhands {

/// Runs `body()` if any lane wants it. The body must leave the other lanes' values untouched (use `select`), so that
/// skipping it and running it are the same to them.
template <class Mask, class Body>
MANYHANDS_INLINE void when(Mask m, Body&& body) {
  if (any(m)) body();
}

/// Runs `active = body(active)` at most n times, and stops when no lane is active. The body must change only active
/// lanes; a lane that has finished stays frozen, exactly as the scalar loop would have stopped.
template <class Mask, class Body>
MANYHANDS_INLINE void iterate(Mask active, int n, Body&& body) {
  for (int i = 0; i < n && any(active); ++i) active = active & body(active);
}

/// Calls `body(k)` for every lane k in which the mask holds: for work too divergent for lanes. The body runs the same
/// template at the scalar type.
template <Number T, class Body>
MANYHANDS_INLINE void for_lanes(mask_t<T> m, Body&& body) {
  for (int k = 0; k < width_v<T>; ++k) {
    if (lane(m, k)) body(k);
  }
}

}  // namespace manyhands
