// Which kernels run: chosen by lane width, among those that the program is linked with.
#pragma once

#include <array>
#include <stdexcept>
#include <string>

#include "manyhands/math/instantiate.h"

namespace manyhands {

/// The function that get.operator()<T>() points to for the number type of `width`: float for 1, `Lanes<float, width>`
/// for more. The pointer is null where the kernels of a lane type are not linked in.
/// Throws std::invalid_argument on such a width and on any other; the message names `name` and the widths there are.
template <class Get>
[[nodiscard]] auto for_width(const char* name, int width, Get get) {
  constexpr std::array kWidths{1, 4, 8, 16};
  const std::array functions{get.template operator()<float>(), get.template operator()<Lanes4>(),
                             get.template operator()<Lanes8>(), get.template operator()<Lanes16>()};
  std::string message = name + (" is " + std::to_string(width)) + "; this build has 0 (automatic)";
  for (std::size_t i = 0; i < kWidths.size(); ++i) {
    if (functions[i] == nullptr) continue;
    if (kWidths[i] == width) return functions[i];
    message += ", " + std::to_string(kWidths[i]);
  }
  throw std::invalid_argument(message);
}

}  // namespace manyhands
