#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "manyhands/learn/relations.h"
#include "manyhands/math/quaternion.h"

namespace manyhands::learn {
namespace {

std::vector<float> shown(const Quat<float>& now, const Quat<float>& wanted) {
  const std::array<float, 5> observation = {9, now.x, now.y, now.z, now.w};
  const std::array<float, 4> goal = {wanted.x, wanted.y, wanted.z, wanted.w};
  std::vector<float> x(24);
  Relations{.cube_rotation = 1}.write(observation.data(), goal.data(), x.data());
  return x;
}

Quat<float> about(float x, float y, float z, float angle) {
  const float s = std::sin(angle / 2);
  return {s * x, s * y, s * z, std::cos(angle / 2)};
}

TEST(Relations, ShowTheRotationThatLeadsToTheGoal) {
  const Quat<float> now = about(0.6f, 0, 0.8f, 1.1f), turn = about(0, 0, 1, 0.3f);
  const std::vector<float> x = shown(now, turn * now);
  const std::array<float, 9> expected = {
      std::cos(0.3f), std::sin(0.3f), 0, -std::sin(0.3f), std::cos(0.3f), 0, 0, 0, 1};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(x[i], expected[i], 1e-6f) << i;
}

TEST(Relations, ShowEveryWayInWhichACubeLooksTheSameAlike) {
  constexpr float kQuarter = 1.57079633f;
  const Quat<float> pose = about(0.36f, 0.48f, 0.8f, 0.7f), goal = Quat<float>::identity();
  const std::vector<float> first = shown(pose, goal);
  Quat<float> other = pose;
  for (int i = 0; i < 24; ++i) {
    other = other * (i % 2 == 0 ? about(1, 0, 0, kQuarter) : about(0, 1, 0, kQuarter));
    const std::vector<float> x = shown(other, goal),
                             signed_other = shown({-other.x, -other.y, -other.z, -other.w}, goal);
    for (std::size_t k = 9; k < 24; ++k) EXPECT_NEAR(x[k], first[k], 1e-5f) << i << ' ' << k;
    for (std::size_t k = 0; k < 24; ++k)
      EXPECT_NEAR(x[k], signed_other[k], 1e-6f) << "a quaternion's sign means nothing";
  }
}

TEST(Relations, TellCubesApartThatLieInOtherWays) {
  const Quat<float> goal = Quat<float>::identity();
  const std::vector<float> flat = shown(goal, goal), turned = shown(about(0, 0, 1, 0.4f), goal);
  const float sum_x4 = std::pow(std::cos(0.4f), 4.0f) + std::pow(std::sin(0.4f), 4.0f);
  EXPECT_FLOAT_EQ(flat[9 + 14], 1);  // of x^4
  EXPECT_NEAR(turned[9 + 14], sum_x4, 1e-6f);
  EXPECT_NEAR(turned[9], 1, 1e-6f);  // of z^4
}

TEST(Relations, MustBeOfTheObservationAndTheGoal) {
  EXPECT_NO_THROW((Relations{.differences = {4, 0}, .cube_rotation = 3}.require_fit(7, 4)));
  EXPECT_THROW((Relations{.differences = {5, 0}}.require_fit(7, 4)), std::invalid_argument);
  EXPECT_THROW((Relations{.cube_rotation = 4}.require_fit(7, 4)), std::invalid_argument);
  EXPECT_THROW((Relations{.cube_rotation = 3}.require_fit(7, 3)), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands::learn
