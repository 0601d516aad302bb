#include "manyhands/math/numpy_random.h"

#include <bit>
#include <cmath>

namespace manyhands {
namespace {

__extension__ using Uint128 = unsigned __int128;

Uint128 join(const std::array<std::uint64_t, 2>& words) { return Uint128{words[1]} << 64 | words[0]; }
std::array<std::uint64_t, 2> split(Uint128 x) {
  return {static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(x >> 64)};
}

Uint128 pcg64_next(Uint128 state, Uint128 increment) {
  constexpr Uint128 kMultiplier = Uint128{0x2360ED051FC65DA4u} << 64 | 0x4385DF649FCCF645u;
  return state * kMultiplier + increment;
}

// ---- SeedSequence: M. O'Neill's seed_seq alternative (pcg-random.org, "Developing a seed_seq alternative", 2015) ----

class SeedHash {
 public:
  SeedHash(std::uint32_t constant, std::uint32_t multiplier) : constant_(constant), multiplier_(multiplier) {}

  std::uint32_t operator()(std::uint32_t value) {
    value ^= constant_;
    constant_ *= multiplier_;
    value *= constant_;
    return value ^ value >> 16;
  }

 private:
  std::uint32_t constant_, multiplier_;
};

std::array<std::uint32_t, 4> entropy_pool(std::uint64_t seed) {
  SeedHash hash(0x43b0d7e5u, 0x931e8875u);
  // numpy splits the seed into as many words as it needs; absent words hash like zeros.
  std::array<std::uint32_t, 4> pool{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), 0, 0};
  for (std::uint32_t& word : pool) word = hash(word);
  for (std::size_t from = 0; from < pool.size(); ++from) {
    for (std::size_t to = 0; to < pool.size(); ++to) {
      if (from == to) continue;
      const std::uint32_t mixed = 0xca01f9ddu * pool[to] - 0x4973f715u * hash(pool[from]);
      pool[to] = mixed ^ mixed >> 16;
    }
  }
  return pool;
}

/// `SeedSequence(seed).generate_state(4, numpy.uint64)`.
std::array<std::uint64_t, 4> seed_words(std::uint64_t seed) {
  const std::array<std::uint32_t, 4> pool = entropy_pool(seed);
  SeedHash hash(0x8b51f9ddu, 0x58f38dedu);
  std::array<std::uint64_t, 4> words{};
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::uint64_t low = hash(pool[2 * i % 4]), high = hash(pool[(2 * i + 1) % 4]);
    words[i] = high << 32 | low;
  }
  return words;
}

// ---- The normal distribution's ziggurat -----------------------------------------------------------------------------

constexpr double kTail = 3.6541528853610087963519472518;  // where the outermost layer ends
constexpr double kArea = 0.0049286732339746519;           // of every layer
constexpr double kScale = 0x1p52;

struct Ziggurat {
  std::array<std::uint64_t, 256> inside;  // mantissas below are under the curve
  std::array<double, 256> width;          // of a layer, by 2^52
  std::array<double, 256> density;        // exp(-x^2 / 2) at its edge
};

/// numpy's tables, from the recursion that made them. Their author's exp rounded the density of layer 38 up where the
/// correct rounding is down, and everything nearer the centre follows from it.
Ziggurat make_ziggurat() {
  Ziggurat z{};
  std::array<double, 256> x{};
  const auto density = [](double at) { return std::exp(-0.5 * at * at); };
  x[255] = kTail;
  z.density[255] = density(kTail);
  for (std::size_t i = 254; i > 0; --i) {
    x[i] = std::sqrt(-2.0 * std::log(z.density[i + 1] + kArea / x[i + 1]));
    z.density[i] = density(x[i]);
    if (i == 38) z.density[i] = std::nextafter(z.density[i], 1.0);
  }
  z.density[0] = 1.0;
  z.inside[0] = static_cast<std::uint64_t>(std::rint(kTail * z.density[255] / kArea * kScale));
  z.width[0] = kArea / z.density[255] / kScale;
  for (std::size_t i = 1; i < 256; ++i) {
    z.inside[i] = static_cast<std::uint64_t>(std::rint(x[i - 1] / x[i] * kScale));
    z.width[i] = x[i] / kScale;
  }
  return z;
}

/// A normal beyond kTail (Marsaglia, 1964).
double tail_normal(NumpyRandom& random) {
  constexpr double kInverseTail = 0.27366123732975827203338247596;
  while (true) {
    const double x = -kInverseTail * std::log1p(-random.random());
    const double y = -std::log1p(-random.random());
    if (y + y > x * x) return kTail + x;
  }
}

}  // namespace

NumpyRandom::NumpyRandom(std::uint64_t seed) : state_{} {
  const std::array<std::uint64_t, 4> words = seed_words(seed);
  const Uint128 start = join({words[1], words[0]});
  const Uint128 increment = join({words[3], words[2]}) << 1 | 1;
  state_ = {split(pcg64_next(pcg64_next(0, increment) + start, increment)), split(increment)};
}

std::uint64_t NumpyRandom::bits() {
  state_.state = split(pcg64_next(join(state_.state), join(state_.increment)));
  const auto [low, high] = state_.state;
  return std::rotr(high ^ low, static_cast<int>(high >> 58));
}

double NumpyRandom::random() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

double NumpyRandom::uniform(double low, double high) { return low + (high - low) * random(); }

double NumpyRandom::standard_normal() {
  static const Ziggurat kZiggurat = make_ziggurat();
  while (true) {
    const std::uint64_t r = bits();
    const std::size_t layer = r & 0xff;
    const bool negative = (r >> 8 & 1) != 0;
    const std::uint64_t magnitude = r >> 9 & 0xfffffffffffff;
    const double x = static_cast<double>(magnitude) * kZiggurat.width[layer];
    if (magnitude < kZiggurat.inside[layer]) return negative ? -x : x;
    if (layer == 0) {
      const double tail = tail_normal(*this);
      return (magnitude >> 8 & 1) != 0 ? -tail : tail;
    }
    const double outer = kZiggurat.density[layer], inner = kZiggurat.density[layer - 1];
    if ((inner - outer) * random() + outer < std::exp(-0.5 * x * x)) return negative ? -x : x;
  }
}

}  // namespace manyhands
