// The trainer's random numbers: a stream is a pure function of (seed, purpose, counter), so nothing but counters has
// to be saved to resume exactly, and pieces of work may draw in any order.
#pragma once

#include <cstdint>

#include "manyhands/math/philox.h"

namespace manyhands::learn {

/// What a stream is for: no two uses share one.
enum class Purpose : std::uint32_t {
  kInitialisation,
  kActorSeed,
  kCriticSeed,
  kExploration,
  kSampling,
  kTargetNoise,
  kEvaluationSeed,
  kWorldSeed,
  kEpisodeSeed,
  kPolicyNoise,
  kShuffle,
  kActing,
  kPrediction,
  kShareSeed,
  kEncoderSeed,
};

/// A seed from a seed: 64 bits that differ with each argument.
[[nodiscard]] constexpr std::uint64_t derive_seed(std::uint64_t seed, Purpose purpose, std::uint64_t counter) {
  RandomStream stream(seed, static_cast<std::uint32_t>(purpose), counter);
  const std::uint64_t low = stream.bits(), high = stream.bits();
  return high << 32 | low;
}

/// The draws that training needs.
class Random {
 public:
  Random(std::uint64_t seed, Purpose purpose, std::uint64_t counter)
      : stream_(seed, static_cast<std::uint32_t>(purpose), counter) {}

  /// Uniform in [0, 1), 24 bits.
  [[nodiscard]] float uniform() { return stream_.unit<float>(); }
  [[nodiscard]] float uniform(float low, float high) { return stream_.uniform(low, high); }
  [[nodiscard]] float normal() { return stream_.normal<float>(); }

  /// Uniform in {0, ..., n - 1}, n > 0 (bias below n / 2^32).
  [[nodiscard]] std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>((std::uint64_t{stream_.bits()} * n) >> 32);
  }

 private:
  RandomStream stream_;
};

}  // namespace manyhands::learn
