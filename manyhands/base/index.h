// Sizes and indices: the model counts in int, memory in std::size_t.
#pragma once

#include <cstddef>

namespace manyhands {

/// An int that is known to be 0 or more, as an index.
[[nodiscard]] constexpr std::size_t index(int i) noexcept { return static_cast<std::size_t>(i); }

}  // namespace manyhands
