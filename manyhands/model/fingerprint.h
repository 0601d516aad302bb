// A number that tells models apart.
#pragma once

#include <cstdint>

#include "manyhands/model/model.h"

namespace manyhands {

/// FNV-1a, 64 bits, of all that the motion of a model depends on, and of the names of its parts. Colours, textures,
/// visual geoms, where fixed links without colliding geoms stand, keyframes and the model's own name do not count.
[[nodiscard]] std::uint64_t fingerprint(const Model& model);

}  // namespace manyhands
