// What zlib has compressed.
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

/// The bytes of a zlib stream (RFC 1950, 1951), which must be `size` in number. Throws ImageError, whatever the stream
/// is.
[[nodiscard]] std::vector<std::uint8_t> inflated(std::string_view stream, std::size_t size);

}  // namespace manyhands::io
