// Messages of Protocol Buffers, field by field: what it takes to read an ONNX file.
//
// https://protobuf.dev/programming-guides/encoding
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

namespace manyhands::learn {

/// Reads one message. What does not follow the format throws std::invalid_argument.
class ProtobufReader {
 public:
  explicit ProtobufReader(std::span<const std::byte> message) : left_(message) {}

  struct Field {
    int number{};
    std::uint64_t value{};               ///< of a field that holds a number
    std::span<const std::byte> bytes{};  ///< of one that holds a text, an array or a message

    [[nodiscard]] std::string text() const { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }
  };

  /// Whether there was another field, which `field` then holds.
  [[nodiscard]] bool next(Field& field) {
    if (left_.empty()) return false;
    const std::uint64_t key = varint();
    field = {.number = static_cast<int>(key >> 3 & 0x1fffffff)};
    switch (key & 7) {
      case 0:
        field.value = varint();
        break;
      case 1:
        static_cast<void>(take(8));
        break;
      case 2:
        field.bytes = take(varint());
        break;
      case 5:
        static_cast<void>(take(4));
        break;
      default:
        throw std::invalid_argument("a field is of no known kind");
    }
    return true;
  }

  /// A whole number in 7 bits a byte.
  [[nodiscard]] std::uint64_t varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const auto byte = static_cast<std::uint64_t>(take(1)[0]);
      value |= (byte & 127) << shift;
      if (byte < 128) return value;
    }
    throw std::invalid_argument("a number is too long");
  }

  [[nodiscard]] bool done() const { return left_.empty(); }

 private:
  std::span<const std::byte> take(std::uint64_t count) {
    if (count > left_.size()) throw std::invalid_argument("it ends in the middle");
    const auto taken = left_.first(static_cast<std::size_t>(count));
    left_ = left_.subspan(static_cast<std::size_t>(count));
    return taken;
  }

  std::span<const std::byte> left_;
};

}  // namespace manyhands::learn
