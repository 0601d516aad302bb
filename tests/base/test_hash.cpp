#include <gtest/gtest.h>

#include "manyhands/base/hash.h"

namespace manyhands {
namespace {

std::uint64_t hash_of(const char* text) {
  Hash hash;
  for (; *text != '\0'; ++text) hash.add(*text);
  return hash.value();
}

/// Test vectors of FNV-1a's authors (isthe.com/chongo/tech/comp/fnv).
TEST(Hash, IsFnv1a) {
  EXPECT_EQ(hash_of(""), 0xcbf29ce484222325u);
  EXPECT_EQ(hash_of("a"), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(hash_of("foobar"), 0x85944171f73967e8u);
}

TEST(Hash, TellsBitsApartThatCompareEqual) {
  Hash plus, minus, other_type;
  plus.add(0.0);
  minus.add(-0.0);
  other_type.add(0.0f);
  EXPECT_NE(plus.value(), minus.value());
  EXPECT_NE(plus.value(), other_type.value());
}

TEST(Hash, DependsOnTheOrder) {
  Hash ab, ba;
  ab.add(1);
  ab.add(2);
  ba.add(2);
  ba.add(1);
  EXPECT_NE(ab.value(), ba.value());
}

}  // namespace
}  // namespace manyhands
