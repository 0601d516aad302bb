// Snapshots as tests take them apart: see the format in snapshot.h.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace manyhands::testing {

using Bytes = std::vector<std::uint8_t>;

/// Where the numbers of a snapshot begin.
inline std::size_t payload_of(const Bytes& snapshot) {
  std::uint32_t text = 0;
  std::memcpy(&text, &snapshot[12], sizeof(text));
  return 32 + text;
}

/// The numbers of one of n worlds.
inline Bytes world_of(const Bytes& snapshot, int n, int world) {
  const std::size_t first = payload_of(snapshot), size = (snapshot.size() - first) / static_cast<std::size_t>(n);
  const auto begin = snapshot.begin() + static_cast<std::ptrdiff_t>(first + size * static_cast<std::size_t>(world));
  return {begin, begin + static_cast<std::ptrdiff_t>(size)};
}

/// Writes the check sum that the bytes have now.
inline void repair(Bytes& snapshot) {
  std::uint64_t sum = 0xcbf29ce484222325ULL ^ snapshot.size();
  const auto add = [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; i += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, &snapshot[i], std::min<std::size_t>(8, end - i));
      sum = (sum ^ word) * 0x100000001b3ULL;
      sum ^= sum >> 32;
    }
  };
  add(0, 24);
  add(32, snapshot.size());
  std::memcpy(&snapshot[24], &sum, sizeof(sum));
}

/// Writes a number over bytes of the snapshot.
template <class Number>
void put(Bytes& snapshot, std::size_t offset, Number number) {
  std::memcpy(&snapshot[offset], &number, sizeof(number));
}

/// The snapshot with one to four changes: bits, bytes, words of `R` that are special, pieces that go or come.
template <class R>
Bytes mutated(Bytes bytes, std::mt19937& random) {
  constexpr R kBig = std::numeric_limits<R>::max(), kInf = std::numeric_limits<R>::infinity();
  const std::array<R, 12> special{kInf, -kInf,   std::numeric_limits<R>::quiet_NaN(),
                                  kBig, -kBig,   std::numeric_limits<R>::denorm_min(),
                                  R(0), R(-0.0), R(-1),
                                  R(2), R(1e18), R(1e-30)};
  const auto at = [&](std::size_t size) { return random() % (bytes.size() - size + 1); };
  for (std::uint32_t change = random() % 4 + 1; change-- > 0 && bytes.size() > 64;) {
    const std::size_t payload = std::min(payload_of(bytes), bytes.size() - 16);
    switch (random() % 8) {
      case 0:
        bytes[at(1)] ^= static_cast<std::uint8_t>(1u << (random() % 8));
        break;
      case 1:
        bytes[at(1)] = static_cast<std::uint8_t>(random());
        break;
      case 2:
        bytes.resize(bytes.size() - random() % 16);
        break;
      case 3:
        bytes.insert(bytes.end(), random() % 16, static_cast<std::uint8_t>(random()));
        break;
      default: {
        const std::size_t words = (bytes.size() - payload) / sizeof(R);
        put(bytes, payload + sizeof(R) * (random() % words), special[random() % special.size()]);
      }
    }
  }
  return bytes;
}

/// Whether `restore` takes the snapshot; it may refuse it in one line, as std::invalid_argument.
template <class Worlds>
bool takes(Worlds& worlds, const Bytes& snapshot, std::string* why = nullptr) {
  try {
    worlds.restore(snapshot);
    return true;
  } catch (const std::invalid_argument& error) {
    const std::string what = error.what();
    if (what.find("snapshot") == std::string::npos || what.find('\n') != std::string::npos) {
      throw std::logic_error("not one line about a snapshot: " + what);
    }
    if (why != nullptr) *why = what;
    return false;
  }
}

}  // namespace manyhands::testing
