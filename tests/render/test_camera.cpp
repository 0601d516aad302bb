#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "manyhands/render/camera.h"

namespace manyhands {
namespace {

using Point = Vec3<double>;

constexpr double kDegree = std::numbers::pi / 180;

void expect_near(const Point& a, const Point& b, double tolerance) { EXPECT_LT(norm(a - b), tolerance); }

// Numbers of PyBullet's manual for panda-gym's camera: the eye at (0.857, -0.857, 0.7).
TEST(Camera, OrbitIsPyBullets) {
  const Transform<double> X = orbit({0, 0, 0}, 1.4, 45 * kDegree, -30 * kDegree);
  const double across = 1.4 * std::cos(30 * kDegree) * std::sqrt(0.5);
  expect_near(X.p, {across, -across, 0.7}, 1e-12);
  expect_near(X.R.z, (-1 / 1.4) * X.p, 1e-12);
  EXPECT_NEAR(X.R.x.z, 0, 1e-12);  // level
  EXPECT_LT(X.R.y.z, 0);           // y points down
  expect_near(look_at(X.p, {0, 0, 0}).R.x, X.R.x, 1e-12);
}

TEST(Camera, FieldOfViewAndIntrinsicsAgree) {
  const Camera camera = perspective_camera(640, 480, 60 * kDegree);
  EXPECT_NEAR(camera.fy, 240 / std::tan(30 * kDegree), 1e-9);
  const Camera same = intrinsic_camera(640, 480, camera.fx, camera.fy, 320, 240);
  EXPECT_EQ(same.cx, camera.cx);
  EXPECT_EQ(same.cy, camera.cy);
}

// OpenGL's own formulas: clip = P V x, pixel = half the picture times (1 + x/w, 1 - y/w).
TEST(Camera, MatricesShowPointsWhereOpenGLDoes) {
  const double left = -0.08, right = 0.12, bottom = -0.05, top = 0.07, near = 0.1, far = 10;
  std::array<double, 16> P{};
  P[0] = 2 * near / (right - left);
  P[5] = 2 * near / (top - bottom);
  P[8] = (right + left) / (right - left);
  P[9] = (top + bottom) / (top - bottom);
  P[10] = -(far + near) / (far - near);
  P[11] = -1;
  P[14] = -2 * far * near / (far - near);
  const Transform<double> X_WC = orbit({0.1, 0.2, 0.3}, 1.5, 0.6, -0.4, 0.3);
  const Transform<double> X_CW = inverse(X_WC);
  std::array<double, 16> V{};
  const auto column = [&](std::size_t i, const Point& a) {  // OpenGL's camera has y up and looks along -z
    V[4 * i] = a.x;
    V[4 * i + 1] = -a.y;
    V[4 * i + 2] = -a.z;
  };
  column(0, X_CW.R.x);
  column(1, X_CW.R.y);
  column(2, X_CW.R.z);
  column(3, X_CW.p);
  V[15] = 1;
  const Camera camera = camera_from_matrices(200, 120, V, P);
  expect_near(camera.X_FC.p, X_WC.p, 1e-12);
  expect_near(camera.X_FC.R.z, X_WC.R.z, 1e-12);
  EXPECT_NEAR(camera.near, near, 1e-12);
  EXPECT_NEAR(camera.far, far, 1e-9);
  for (const Point& x : {Point{0.1, 0.2, 0.3}, Point{0.3, -0.1, 0.2}, Point{-0.2, 0.4, 0.5}}) {
    const auto times = [](const std::array<double, 16>& m, const std::array<double, 4>& a) {
      std::array<double, 4> r{};
      for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) r[i] += m[4 * j + i] * a[j];
      }
      return r;
    };
    const auto clip = times(P, times(V, {x.x, x.y, x.z, 1}));
    const Point p_C = inverse(camera.X_FC) * x;
    EXPECT_NEAR(camera.fx * p_C.x / p_C.z + camera.cx, 100 * (1 + clip[0] / clip[3]), 1e-9);
    EXPECT_NEAR(camera.fy * p_C.y / p_C.z + camera.cy, 60 * (1 - clip[1] / clip[3]), 1e-9);
  }
}

TEST(Camera, PointCloudUndoesTheProjection) {
  Camera camera = perspective_camera(4, 2, 1);
  camera.far = 5;
  const Transform<double> X_AC = orbit({0, 0, 0}, 2, 0.3, -0.2);
  const std::vector<float> depth{1, 2, 3, 4, 5, 1.5f, 5, 0.5f};
  const auto points = point_cloud(camera, X_AC, depth);
  ASSERT_EQ(points.size(), 6U);
  std::size_t k = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (depth[i] == 5) continue;
    const Point p_C = inverse(X_AC) * broadcast<double>(points[k++]);
    EXPECT_NEAR(p_C.z, static_cast<double>(depth[i]), 1e-6);
    const std::size_t column = i % 4, row = i / 4;
    EXPECT_NEAR(camera.fx * p_C.x / p_C.z + camera.cx, static_cast<double>(column) + 0.5, 1e-5);
    EXPECT_NEAR(camera.fy * p_C.y / p_C.z + camera.cy, static_cast<double>(row) + 0.5, 1e-5);
  }
}

TEST(Camera, RefusesNonsense) {
  EXPECT_THROW((void)perspective_camera(0, 480, 1), std::invalid_argument);
  EXPECT_THROW((void)perspective_camera(640, 480, 3.2), std::invalid_argument);
  EXPECT_THROW((void)intrinsic_camera(640, 480, -1, 1, 0, 0), std::invalid_argument);
  EXPECT_THROW((void)orthographic_camera(640, 480, 0), std::invalid_argument);
  EXPECT_THROW((void)look_at({1, 0, 0}, {1, 0, 0}), std::invalid_argument);
  EXPECT_THROW((void)look_at({0, 0, 1}, {0, 0, 0}), std::invalid_argument);
  const std::vector<double> zeros(16, 0.0);
  EXPECT_THROW((void)camera_from_matrices(8, 8, zeros, zeros), std::invalid_argument);
  EXPECT_THROW((void)camera_from_matrices(8, 8, {}, zeros), std::invalid_argument);
  EXPECT_THROW((void)point_cloud(perspective_camera(2, 2, 1), Transform<double>::identity(), {}),
               std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
