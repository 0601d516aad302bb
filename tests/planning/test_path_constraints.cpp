// Path constraints beside kinematics in double, looked at closely along whole ways.
#include <gtest/gtest.h>

#include <limits>

#include "manyhands/base/assets.h"
#include "manyhands/math/philox.h"
#include "manyhands/physics/dynamics/kinematics.h"
#include "manyhands/physics/world/world.h"
#include "manyhands/planning/plan.h"

namespace manyhands {
namespace {

using Vec = Vec3<double>;
using Numbers = std::vector<double>;

constexpr double kWithin = 0.2;

/// A Panda that holds its hand down, above a box.
struct ConstrainedPanda {
  ConstrainedPanda()
      : world(World::from_file(asset_path("panda/panda.urdf"))),
        model(world.model()),
        scene(model, model.initial_configuration(), {.joints = joints_that_move(model, hand())}),
        ws(scene.tree) {}

  FrameId hand() const { return model.frame_id("panda_hand"); }
  PathConstraints constraints() const {
    std::vector<PathConstraint> all =
        keep_position(hand(), {Mat3<double>::identity(), {0.4, 0, 0.4}}, {-0.3, -kFar, -0.2}, {kFar, kFar, 0.2});
    all.push_back(keep_axis(hand(), {0, 0, 2}, {0, 0, -1}, kWithin));
    return {model, scene, all};
  }
  /// By how much all is kept, by kinematics of the whole model: negative where it is not.
  double room(const Numbers& planned) {
    forward_kinematics(scene.tree, scene.configuration(planned).data(), ws);
    const Frame& frame = model.frame(hand());
    const Transform<double> X = frame_pose(frame.body, frame.X_BF, ws);
    const double tilt = std::atan2(std::hypot(X.R.z.x, X.R.z.y), -X.R.z.z);
    return std::min({kWithin - tilt, X.p.x - 0.1, X.p.z - 0.2, 0.6 - X.p.z});
  }
  Numbers random_row(RandomStream& random) const {
    Numbers q;
    for (std::size_t k = 0; k < scene.size(); ++k) q.push_back(random.uniform(scene.lower[k], scene.upper[k]));
    return q;
  }

  static constexpr double kFar = std::numeric_limits<double>::infinity();
  World world;
  const Model& model;
  PlanningScene scene;
  Workspace<double> ws;
};

/// One for all tests: making it takes a while.
ConstrainedPanda& shared_panda() {
  static ConstrainedPanda panda;
  return panda;
}

std::vector<float> as_floats(const Numbers& q) { return {q.begin(), q.end()}; }
Numbers as_doubles(const std::vector<float>& q) { return {q.begin(), q.end()}; }

TEST(PathConstraints, ProjectionsKeepAllAndLeaveAloneWhatDoes) {
  ConstrainedPanda& panda = shared_panda();
  PathConstraints constraints = panda.constraints();
  RandomStream random(1, 0, 0);
  int arrived = 0;
  for (int i = 0; i < 300; ++i) {
    const Numbers from = panda.random_row(random);
    std::vector<float> q = as_floats(from);
    EXPECT_EQ(constraints.broken_at(from).empty(), panda.room(from) > 0);
    if (!constraints.project(q)) continue;
    ++arrived;
    EXPECT_GT(panda.room(as_doubles(q)), 0);
    const std::vector<float> before = q;
    ASSERT_TRUE(constraints.project(q));
    EXPECT_EQ(q, before);
  }
  EXPECT_GT(arrived, 150);
}

TEST(PathConstraints, AProjectionGoesTheShortestWay) {
  ConstrainedPanda& panda = shared_panda();
  const PathConstraint level = keep_axis(panda.hand(), {0, 0, 1}, {0, 0, -1}, kWithin);
  PathConstraints constraints(panda.model, panda.scene, {&level, 1});
  Numbers q{0, -0.785, 0, -2.356, 0, 1.571, 0.785};
  q[5] += 0.3;  // the hand tilts about a horizontal axis, to which joints 2, 4 and 6 are parallel
  std::vector<float> projected = as_floats(q);
  ASSERT_TRUE(constraints.project(projected));
  const double each = (0.3 - kWithin / 2) / 3;
  for (const std::size_t k : {0U, 2U, 4U, 6U}) EXPECT_NEAR(static_cast<double>(projected[k]), q[k], 1e-3);
  for (const std::size_t k : {1U, 3U, 5U})
    EXPECT_NEAR(std::abs(static_cast<double>(projected[k]) - q[k]), each, 1e-3) << k;
}

TEST(PathConstraints, WaysThatHoldKeepAllBetweenLooks) {
  ConstrainedPanda& panda = shared_panda();
  PathConstraints constraints = panda.constraints();
  RandomStream random(2, 0, 0);
  int holding = 0, broken = 0;
  while (holding < 60 || broken < 60) {
    std::vector<float> start = as_floats(panda.random_row(random)), linear, square;
    if (!constraints.project(start)) continue;
    for (std::size_t k = 0; k < start.size(); ++k) {
      linear.push_back(random.uniform(-0.3f, 0.3f));
      square.push_back(random.uniform(-0.1f, 0.1f));
    }
    const MotionPiece motion{start, linear, square};
    double least = ConstrainedPanda::kFar;
    for (int i = 0; i <= 500; ++i) {
      Numbers q;
      for (std::size_t k = 0; k < start.size(); ++k)
        q.push_back(coordinate_at(motion, k, static_cast<double>(i) / 500));
      least = std::min(least, panda.room(q));
    }
    const bool holds = constraints.hold(motion);
    if (holds) {
      EXPECT_GT(least, 0);
    } else {
      EXPECT_LT(least, 1e-4);  // of which rounding asks as much room
    }
    ++(holds ? holding : broken);
  }
}

TEST(PathConstraints, PlansKeepThem) {
  ConstrainedPanda& panda = shared_panda();
  ConfigurationCheck check(panda.scene, panda.constraints());
  PathConstraints constraints = panda.constraints();
  RandomStream random(3, 0, 0);
  for (int i = 0; i < 5; ++i) {
    Numbers ends[2]{{-0.6, 0, 0, -2.2, 0, 2.2, 0.785}, {0.6, 0, 0, -2.2, 0, 2.2, 0.785}};
    for (Numbers& end : ends) {
      std::vector<float> q = as_floats(end);
      do {
        for (std::size_t k = 0; k < q.size(); ++k) q[k] = static_cast<float>(end[k] + random.uniform(-0.5, 0.5));
      } while (!constraints.project(q) || check.are_free(as_doubles(q))[0] == 0);
      end = as_doubles(q);
    }
    const Plan plan = find_plan(panda.scene, check, ends[0], ends[1], {.time_limit = 10});
    ASSERT_EQ(plan.status, PlanStatus::kSolved) << plan.message;
    const Trajectory& curve = *plan.curve;
    for (int look = 0; look <= 1000; ++look) {
      Numbers t{curve.duration() * look / 1000}, q(7), v(7), a(7);
      curve.sample(t, q, v, a);
      ASSERT_GT(panda.room(q), 0);
    }
  }
}

TEST(PathConstraints, NonsenseIsRefused) {
  ConstrainedPanda& panda = shared_panda();
  EXPECT_THROW((void)keep_axis(panda.hand(), {0, 0, 0}, {0, 0, 1}, 0.1), std::invalid_argument);
  EXPECT_THROW((void)keep_axis(panda.hand(), {0, 0, 1}, {0, 0, 1}, 0), std::invalid_argument);
  EXPECT_THROW((void)keep_position(panda.hand(), Transform<double>::identity(), {0, 0, 0}, {1, 1, 0}),
               std::invalid_argument);
  const PathConstraint fixed = keep_axis(panda.model.frame_id("panda_link0"), {0, 0, 1}, {0, 0, 1}, 0.1);
  EXPECT_THROW(PathConstraints(panda.model, panda.scene, {&fixed, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
