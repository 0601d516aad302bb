// A million values of each function, by their bits: the same with every compiler, instruction set and processor.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "manyhands/base/hash.h"
#include "manyhands/math/functions.h"

namespace manyhands {
namespace {

/// Numbers in [-size, size): Marsaglia's xorshift, 2003.
class Draw {
 public:
  template <class R>
  R operator()(R size) {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return static_cast<R>(static_cast<double>(state_ >> 11) * 0x1p-53 * 2 - 1) * size;
  }

 private:
  std::uint64_t state_ = 88172645463325252ULL;
};

/// Of f(hash, x, y): |x| below `size`, |y| below 2.
template <class R, class Function>
std::uint64_t hash_of(R size, const Function& f) {
  Draw draw;
  Hash hash;
  for (int i = 0; i < 1'000'000; ++i) {
    const R x = draw(size), y = draw(R(2));
    f(hash, x, y);
  }
  return hash.value();
}

template <class R>
void expect(std::uint64_t of_sincos, std::uint64_t of_atan2, std::uint64_t of_exp, std::uint64_t of_log) {
  const auto add_sincos = [](Hash& hash, R x, R) {
    const SinCos<R> value = sincos(x);
    hash.add(value.cos);
    hash.add(value.sin);
  };
  EXPECT_EQ(hash_of(R(1000), add_sincos), of_sincos);
  EXPECT_EQ(hash_of(R(2), [](Hash& hash, R x, R y) { hash.add(atan2(y, x)); }), of_atan2);
  EXPECT_EQ(hash_of(R(80), [](Hash& hash, R x, R) { hash.add(exp(x)); }), of_exp);
  EXPECT_EQ(hash_of(R(2), [](Hash& hash, R x, R) { hash.add(log(std::abs(x))); }), of_log);
}

TEST(SameBits, OfDouble) {
  expect<double>(0x2b25a2cbb57ce519, 0x20088f5b77d0b50b, 0xe8db8b811ae9d67e, 0x7f1a3ac02b0590cc);
}

TEST(SameBits, OfFloat) {
  expect<float>(0x38fbc07bb518a059, 0x363b4583db70b6fa, 0x3dbb45940571ed6e, 0x2a83e83367b27fd7);
}

}  // namespace
}  // namespace manyhands
