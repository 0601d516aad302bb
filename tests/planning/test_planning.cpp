// Trajectories in C++: what Python's tests do not see. Their numbers are checked there, beside scipy's.
#include <gtest/gtest.h>

#include <cmath>

#include "manyhands/planning/cartesian.h"
#include "manyhands/planning/spline.h"
#include "manyhands/planning/time_optimal.h"

namespace manyhands {
namespace {

TEST(Planning, ADoubleIntegratorGoesBangBang) {
  const std::vector<double> times{0, 1}, points{0, 2}, limit{3};
  MotionLimits limits;
  limits.acceleration = limit;
  const Trajectory motion = time_optimal(spline(times, {points, 1}, 1, {}), limits);
  EXPECT_NEAR(motion.duration(), 2 * std::sqrt(2.0 / 3.0), 1e-9);
  EXPECT_EQ(motion.order(), 3U);
}

TEST(Planning, PiecesAreFoundByTheirTimes) {
  const std::vector<double> times{0, 1, 3}, points{0, 2, 1}, rest(3, 0.0);
  const Trajectory motion = cubic(times, {points, 1}, rest);
  EXPECT_EQ(motion.pieces(), 2U);
  EXPECT_EQ(motion.piece_at(-1), 0U);
  EXPECT_EQ(motion.piece_at(0.999), 0U);
  EXPECT_EQ(motion.piece_at(1), 1U);
  EXPECT_EQ(motion.piece_at(5), 1U);
}

TEST(Planning, AScrewOfAQuarterTurnIsAHelix) {
  const double turn = std::acos(0.0);
  const Transform<double> start = Transform<double>::identity();
  const Transform<double> end{to_matrix(quat_from_rotation_vector(Vec3<double>{0, 0, turn})), {1, 1, 1}};
  const std::vector<double> times{0, 1}, points{0, 1}, even{1, 1};
  const CartesianTrajectory motion({start, end}, cubic(times, {points, 1}, even), CartesianPath::kScrew);
  const CartesianSample half = motion.sample(0.5);  // about the axis through (0, 1)
  EXPECT_NEAR(half.X.p.x, std::sin(turn / 2), 1e-14);
  EXPECT_NEAR(half.X.p.y, 1 - std::cos(turn / 2), 1e-14);
  EXPECT_NEAR(half.X.p.z, 0.5, 1e-14);
  EXPECT_NEAR(norm(half.A.v), turn * turn, 1e-12);  // centripetal: the radius is 1
}

TEST(Planning, NonsenseIsRefused) {
  const std::vector<double> times{0, 1}, falling{0, -1}, points{0, 2}, one{1}, rest{0, 0};
  EXPECT_THROW((void)cubic(falling, {points, 1}, rest), std::invalid_argument);
  EXPECT_THROW((void)cubic(times, {points, 1}, one), std::invalid_argument);
  EXPECT_THROW((void)time_optimal(cubic(times, {points, 1}, rest), {}), std::invalid_argument);
  EXPECT_THROW(CartesianTrajectory({Transform<double>::identity()}, cubic(times, {points, 1}, rest), {}),
               std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
