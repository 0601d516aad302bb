// numpy's default generator, bit for bit, so that a seed means here what it means in Python.
//
// `NumpyRandom(seed)` draws what `numpy.random.Generator(numpy.random.PCG64(numpy.random.SeedSequence(seed)))` draws
// (the same as `numpy.random.default_rng(seed)`, and gymnasium's `np_random` after `reset(seed=seed)`).
#pragma once

#include <array>
#include <cstdint>

namespace manyhands {

class NumpyRandom {
 public:
  /// The 128-bit state and increment of PCG64, each as {low, high}: all that a run needs to continue.
  struct State {
    std::array<std::uint64_t, 2> state;
    std::array<std::uint64_t, 2> increment;
    bool operator==(const State&) const = default;
  };

  explicit NumpyRandom(std::uint64_t seed);
  explicit NumpyRandom(const State& state) : state_(state) {}

  [[nodiscard]] const State& state() const { return state_; }

  /// The next 64 random bits: PCG XSL-RR 128/64 (O'Neill, Harvey Mudd College HMC-CS-2014-0905).
  [[nodiscard]] std::uint64_t bits();

  /// `Generator.random()`: uniform in [0, 1), 53 bits.
  [[nodiscard]] double random();

  /// `Generator.uniform(low, high)`.
  [[nodiscard]] double uniform(double low, double high);

  /// `Generator.standard_normal()`: ziggurat of 256 layers (Marsaglia and Tsang, J. Stat. Software 5(8), 2000).
  [[nodiscard]] double standard_normal();

 private:
  State state_;
};

}  // namespace manyhands
