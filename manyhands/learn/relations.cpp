#include "manyhands/learn/relations.h"

#include <stdexcept>
#include <string>

#include "manyhands/math/quaternion.h"

namespace manyhands::learn {

namespace {

void require_within(const char* name, int first, int count, int observation_dim) {
  if (first >= 0 && first + count <= observation_dim) return;
  throw std::invalid_argument(std::string(name) + ": " + std::to_string(count) + " numbers from " +
                              std::to_string(first) + " on are not within an observation of " +
                              std::to_string(observation_dim));
}

Quat<float> quaternion(const float* xyzw) { return {xyzw[0], xyzw[1], xyzw[2], xyzw[3]}; }

float power(float x, int n) {
  float product = 1;
  for (int i = 0; i < n; ++i) product *= x;
  return product;
}

float* write_cube_rotation(const Quat<float>& now, const Quat<float>& wanted, float* x) {
  const Mat3<float> way = to_matrix(wanted * Quat<float>{-now.x, -now.y, -now.z, now.w}), axes = to_matrix(now);
  for (const Vec3<float>& column : {way.x, way.y, way.z}) {
    for (const float entry : {column.x, column.y, column.z}) *x++ = entry;
  }
  constexpr int kOrder = 4;
  for (int a = 0; a <= kOrder; ++a) {
    for (int b = 0; a + b <= kOrder; ++b) {
      *x = 0;
      for (const Vec3<float>& axis : {axes.x, axes.y, axes.z}) {
        *x += power(axis.x, a) * power(axis.y, b) * power(axis.z, kOrder - a - b);
      }
      ++x;
    }
  }
  return x;
}

}  // namespace

void Relations::require_fit(int observation_dim, int goal_dim) const {
  for (const int i : differences) require_within("differences", i, 3, observation_dim);
  if (cube_rotation < 0) return;
  require_within("cube_rotation", cube_rotation, 4, observation_dim);
  if (goal_dim != 4) {
    throw std::invalid_argument("cube_rotation: the goal has " + std::to_string(goal_dim) +
                                " numbers, expected the 4 of a quaternion; set it to -1");
  }
}

void Relations::write(const float* observation, const float* goal, float* x) const {
  if (cube_rotation >= 0) x = write_cube_rotation(quaternion(observation + cube_rotation), quaternion(goal), x);
  for (std::size_t pair = 0; pair + 1 < differences.size(); pair += 2) {
    for (int i = 0; i < 3; ++i) *x++ = observation[differences[pair] + i] - observation[differences[pair + 1] + i];
  }
}

}  // namespace manyhands::learn
