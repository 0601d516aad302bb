// Counter-based random numbers: every draw is a pure function of (seed, world, episode, position), so worlds may be
// stepped in any order, on any thread, in any lane, and still draw the same bits.
//
// Philox4x32-10: Salmon, Moraes, Dror, Shaw, Parallel random numbers: as easy as 1, 2, 3 (SC 2011).
#pragma once

#include <array>
#include <cstdint>
#include <numbers>

#include "manyhands/math/functions.h"

namespace manyhands {

/// The 128 random bits of a counter under a key.
[[nodiscard]] constexpr std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                                                std::array<std::uint32_t, 2> key) {
  constexpr int kRounds = 10;
  for (int round = 0; round < kRounds; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53u} * counter[0];
    const std::uint64_t b = std::uint64_t{0xCD9E8D57u} * counter[2];
    counter = {static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
               static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9E3779B9u;
    key[1] += 0xBB67AE85u;
  }
  return counter;
}

/// Maps u in [0, 1) to [low, high); low where the interval is empty.
template <Number T>
MANYHANDS_INLINE T uniform_from_unit(T u, T low, T high) {
  const T value = fma(high - low, u, low);
  return select(value < high, value, low);  // rounding may have reached high
}

/// A standard normal from two independent u in [0, 1) (Box and Muller, 1958).
template <Number T>
MANYHANDS_INLINE T normal_from_units(T u1, T u2) {
  using R = real_t<T>;
  const T radius = sqrt(T(R(-2)) * log(T(R(1)) - u1));
  return radius * sincos(T(R(2 * std::numbers::pi)) * u2).cos;
}

/// The random numbers of one episode of one world: at most 2^34 words of 32 bits. Plain memory.
class RandomStream {
 public:
  RandomStream() = default;
  constexpr RandomStream(std::uint64_t seed, std::uint32_t world, std::uint64_t episode)
      : seed_(seed), episode_(episode), world_(world) {}

  /// The next 32 random bits.
  [[nodiscard]] constexpr std::uint32_t bits() {
    const std::uint32_t word = position_ % 4;
    if (word == 0) {
      block_ = philox4x32({static_cast<std::uint32_t>(position_ / 4), world_, static_cast<std::uint32_t>(episode_),
                           static_cast<std::uint32_t>(episode_ >> 32)},
                          {static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32)});
    }
    ++position_;
    return block_[word];
  }

  /// Uniform in [0, 1): 24 bits in float, 53 (from two words) in double.
  template <Real R>
  [[nodiscard]] constexpr R unit() {
    if constexpr (std::same_as<R, float>) {
      return static_cast<float>(bits() >> 8) * 0x1p-24f;
    } else {
      const std::uint64_t low = bits(), high = bits();
      return static_cast<double>((high << 32 | low) >> 11) * 0x1p-53;
    }
  }

  /// Uniform in [low, high).
  template <Real R>
  [[nodiscard]] R uniform(R low, R high) {
    return uniform_from_unit(unit<R>(), low, high);
  }

  /// Normal with mean 0 and deviation 1.
  template <Real R>
  [[nodiscard]] R normal() {
    const R u1 = unit<R>(), u2 = unit<R>();
    return normal_from_units(u1, u2);
  }

 private:
  std::uint64_t seed_ = 0;
  std::uint64_t episode_ = 0;
  std::uint64_t position_ = 0;  // words drawn
  std::uint32_t world_ = 0;
  std::array<std::uint32_t, 4> block_{};  // the words of the block that contains the last one drawn
};

/// The streams of the worlds in the lanes of T; lane k draws what `RandomStream` of world `first_world + k` draws.
template <Number T>
class RandomStreams {
 public:
  RandomStreams(std::uint64_t seed, std::uint32_t first_world, std::uint64_t episode) {
    for (int k = 0; k < width_v<T>; ++k) {
      (*this)[k] = RandomStream(seed, first_world + static_cast<std::uint32_t>(k), episode);
    }
  }

  /// The stream of lane k; assign to it when that world starts an episode of its own.
  [[nodiscard]] RandomStream& operator[](int k) { return streams_[static_cast<std::size_t>(k)]; }

  [[nodiscard]] T uniform(T low, T high) { return uniform_from_unit(unit(), low, high); }

  [[nodiscard]] T normal() {
    const T u1 = unit(), u2 = unit();
    return normal_from_units(u1, u2);
  }

 private:
  T unit() {
    std::array<real_t<T>, width_v<T>> u;
    for (int k = 0; k < width_v<T>; ++k) u[static_cast<std::size_t>(k)] = (*this)[k].template unit<real_t<T>>();
    return load<T>(u.data());
  }

  std::array<RandomStream, width_v<T>> streams_;
};

}  // namespace manyhands
