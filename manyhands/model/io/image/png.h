// Grey values of PNG pictures.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace manyhands::io {

/// Thrown when a picture cannot be read; the message says what is wrong.
class ImageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct GreyImage {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> values{};  ///< (height, width), from the top left
};

/// Reads a PNG (W3C, third edition) of any kind as grey values of 8 bits: of 16 bits the upper ones, of colours the
/// red, as MuJoCo does. Throws ImageError, whatever the bytes are; also for more than `most_pixels`.
[[nodiscard]] GreyImage read_png(std::string_view bytes, std::size_t most_pixels);

}  // namespace manyhands::io
