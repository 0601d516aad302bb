// What an environment asks of its options.
#pragma once

#include <stdexcept>
#include <string>

namespace manyhands {

/// Throws std::invalid_argument with the message unless the condition holds.
inline void require(bool condition, const std::string& message) {
  if (!condition) throw std::invalid_argument(message);
}

}  // namespace manyhands
