// Polynomials of any degree: their bounds, their parts, and how long they are free.
#include <gtest/gtest.h>

#include <cmath>

#include "manyhands/base/assets.h"
#include "manyhands/math/philox.h"
#include "manyhands/physics/world/world.h"
#include "manyhands/planning/polynomials.h"
#include "manyhands/planning/trajectory_check.h"

namespace manyhands {
namespace {

TEST(MotionPiece, BoundsHoldAndAreNearWhatIsReached) {
  RandomStream random(1, 0, 0);
  for (int round = 0; round < 200; ++round) {
    std::vector<float> c;  // degree 5, one coordinate
    for (int j = 0; j < 6; ++j) c.push_back(random.uniform(-1.0f, 1.0f));
    const std::span<const float> all = c;
    const MotionPiece motion{all.first(1), all.subspan(1, 1), all.subspan(2, 1), all.subspan(3)};
    double fastest = 0, bend = 0;
    for (int i = 0; i <= 200; ++i) {
      const double t = i / 200.0;
      double q = 0, v = 0, a = 0;
      for (std::size_t j = 6; j-- > 0;) {
        const auto x = static_cast<double>(c[j]);
        q += x * std::pow(t, j);
        if (j > 0) v += static_cast<double>(j) * x * std::pow(t, j - 1);
        if (j > 1) a += static_cast<double>(j * (j - 1)) * x * std::pow(t, j - 2);
      }
      EXPECT_NEAR(coordinate_at(motion, 0, t), q, 1e-6);
      fastest = std::max(fastest, std::abs(v));
      bend = std::max(bend, std::abs(a));
    }
    EXPECT_GE(static_cast<double>(greatest_speed(motion, 0)), fastest - 1e-5);
    EXPECT_LE(static_cast<double>(greatest_speed(motion, 0)), 4 * fastest);
    EXPECT_GE(static_cast<double>(greatest_bend(motion, 0)), bend - 1e-4);
  }
}

TEST(Trajectory, PartsAndTheirSumAreTheMotion) {
  const std::vector<double> times{0, 1, 3}, points{0, 2, 1, -1, 0.5, 1}, rest(6, 0.0);
  const Trajectory motion = cubic(times, {points, 2}, rest);
  const Trajectory parts[] = {motion.part(-0.5, 0.7), motion.part(0.7, 1.4), motion.part(1.4, 3.5)};
  const Trajectory whole = joined(parts);
  EXPECT_NEAR(whole.duration(), 4.0, 1e-12);
  for (double t = 0.01; t < 4; t += 0.1) {
    std::vector<double> q(2), v(2), a(2), q2(2), v2(2), a2(2);
    const std::vector<double> at{t}, before{t - 0.5};
    whole.sample(at, q, v, a);
    motion.sample(before, q2, v2, a2);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_NEAR(q[k], q2[k], 1e-12);
      EXPECT_NEAR(v[k], v2[k], 1e-12);
      EXPECT_NEAR(a[k], a2[k], 1e-12);
    }
  }
  EXPECT_THROW((void)motion.part(1, 1), std::invalid_argument);
  EXPECT_THROW((void)joined({}), std::invalid_argument);
}

TEST(FreeUntil, IsWhenThePandaMeetsABallThatWasAdded) {
  const World world = World::from_file(asset_path("panda/panda.urdf"));
  const Model& model = world.model();
  const PlanningScene scene(model, model.initial_configuration(),
                            {.joints = joints_that_move(model, model.frame_id("panda_hand"))});
  const PlanningScene changed = scene.with_cloud({.points = {{0.6, 0, 0.3}}, .radius = 0.05});
  const std::vector<double> times{0, 1}, rest(14, 0.0);
  const std::vector<double> ends{-0.6, 0.2, 0, -2.0, 0, 2.2, 0.785, 0.6, 0.2, 0, -2.0, 0, 2.2, 0.785};
  const Trajectory motion = quintic(times, {ends, 7}, rest, rest);
  ConfigurationCheck before(scene), after(changed);
  EXPECT_EQ(free_until(scene, before, motion), motion.duration());
  const double met = free_until(changed, after, motion);
  EXPECT_LT(met, 0.6);
  const auto distance = [&](double t) {
    std::vector<double> at{t}, q(7), v(7), a(7);
    motion.sample(at, q, v, a);
    return after.nearest(q).distance;
  };
  for (double t = 0; t < met; t += 0.01) EXPECT_GT(distance(t), 0);
  EXPECT_LT(distance(met + 0.003), 1e-3);
  EXPECT_EQ(free_until(changed, after, motion, met + 0.01), met + 0.01);
  const std::vector<double> narrow_ends{0, 1}, narrow_rest(2, 0.0);
  const Trajectory narrow = quintic(times, {narrow_ends, 1}, narrow_rest, narrow_rest);
  EXPECT_THROW((void)free_until(scene, before, narrow), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
