// Models as bytes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "manyhands/model/model.h"

namespace manyhands {

/// All of a model, for another process of the same build.
[[nodiscard]] std::vector<std::uint8_t> archived(const Model& model);
/// The same model to the last bit. Throws std::invalid_argument on damaged bytes and on those of another build.
[[nodiscard]] Model unarchived(std::span<const std::uint8_t> bytes);

}  // namespace manyhands
