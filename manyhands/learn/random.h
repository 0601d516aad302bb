// The trainer's random numbers: a stream is a pure function of (seed, purpose, counter), so nothing but counters has
// to be saved to resume exactly, and pieces of work may draw in any order.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace manyhands::learn {

/// SplitMix64 finaliser (Steele, Lea, Flood, OOPSLA 2014): a bijection of 64 bits that scrambles well.
[[nodiscard]] constexpr std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// A 64-bit key from three words.
[[nodiscard]] constexpr std::uint64_t mix(std::uint64_t seed, std::uint64_t purpose, std::uint64_t counter) {
  constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15u;
  return scramble(scramble(scramble(seed + kGolden) ^ (purpose + 2 * kGolden)) ^ (counter + 3 * kGolden));
}

/// SplitMix64 started at a key.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t purpose, std::uint64_t counter) : state_(mix(seed, purpose, counter)) {}

  [[nodiscard]] std::uint64_t bits() { return scramble(state_ += 0x9e3779b97f4a7c15u); }

  /// Uniform in [0, 1), 24 bits.
  [[nodiscard]] float uniform() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }
  [[nodiscard]] float uniform(float low, float high) { return low + (high - low) * uniform(); }

  /// Uniform in {0, ..., n - 1}, n > 0 (bias below n / 2^32).
  [[nodiscard]] std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>(((bits() >> 32) * std::uint64_t{n}) >> 32);
  }

  /// Standard normal (Box and Muller, 1958).
  [[nodiscard]] float normal() {
    const float radius = std::sqrt(-2.0f * std::log(1.0f - uniform()));
    return radius * std::cos(2.0f * std::numbers::pi_v<float> * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace manyhands::learn
