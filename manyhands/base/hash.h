// A hash of numbers by their bits, to tell whether two runs are the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace manyhands {

/// FNV-1a, 64 bits, over the bytes of what is added (Fowler, Noll and Vo). Not for security.
class Hash {
 public:
  template <class Number>
    requires std::is_arithmetic_v<Number>
  void add(Number number) {
    unsigned char bytes[sizeof(Number)];
    std::memcpy(bytes, &number, sizeof(Number));
    for (const unsigned char byte : bytes) value_ = (value_ ^ byte) * 0x100000001b3ULL;
  }

  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

}  // namespace manyhands
