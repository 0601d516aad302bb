// Poses of a frame in another that moves, too: both sides of a torso with a common joint.
#include <gtest/gtest.h>

#include "manyhands/kinematics/ik_search.h"
#include "manyhands/math/philox.h"
#include "manyhands/model/io/urdf/urdf.h"

namespace manyhands {
namespace {

/// A waist, and on it two arms of six joints about changing axes, 0.2 m a link.
std::string torso() {
  std::string text = "<robot name='torso'><link name='base'/><link name='chest'/>";
  const auto joint = [&](const std::string& name, const std::string& parent, const std::string& child,
                         const std::string& xyz, const std::string& axis) {
    text += "<joint name='" + name + "' type='revolute'><parent link='" + parent + "'/><child link='" + child +
            "'/><origin xyz='" + xyz + "'/><axis xyz='" + axis +
            "'/><limit lower='-2' upper='2' effort='1' velocity='1'/></joint>";
  };
  joint("waist", "base", "chest", "0 0 0.5", "0 0 1");
  const std::string axes[] = {"1 0 0", "0 1 0", "0 0 1"};
  for (const std::string side : {"left", "right"}) {
    std::string parent = "chest", xyz = side == "left" ? "0 0.3 0.1" : "0 -0.3 0.1";
    for (int i = 0; i < 6; ++i) {
      const std::string link = side + std::to_string(i);
      text += "<link name='" + link + "'/>";
      joint(side + "_joint" + std::to_string(i), parent, link, xyz, axes[i % 3]);
      parent = link;
      xyz = "0.2 0 0.02";
    }
  }
  return text + "</robot>";
}

struct Torso {
  Model model = load_urdf_string(torso()).model;
  FrameId left = model.frame_id("left5"), right = model.frame_id("right5");
  IkChain chain{model, right, left};
  Tree<double> tree{model};
  ParamsStorage<double> params{model};
  Workspace<double> ws{tree};

  std::vector<double> random_q(std::uint32_t seed, double most) const {
    RandomStream random(seed, 0, 0);
    std::vector<double> q;
    for (int i = 0; i < model.nq(); ++i) q.push_back(static_cast<double>(random.uniform(-1.0F, 1.0F)) * most);
    return q;
  }

  Transform<double> relative(const std::vector<double>& q) {
    forward_kinematics(tree, q.data(), ws);
    const auto pose = [&](FrameId frame) { return frame_pose(model.frame(frame).body, model.frame(frame).X_BF, ws); };
    return inverse(pose(left)) * pose(right);
  }
};

double error(const Transform<double>& a, const Transform<double>& b) {
  return norm(a.p - b.p) + norm(rotation_vector(to_quat(a.R * transpose(b.R))));
}

TEST(IkRelative, SolvesForTheJointsBetweenBothFrames) {
  const Torso torso;
  EXPECT_EQ(torso.chain.dofs.size(), 12u);
  const auto waist = static_cast<std::size_t>(torso.model.joint(torso.model.joint_id("waist")).iv);
  EXPECT_EQ(std::ranges::count(torso.chain.dofs, waist), 0);
}

/// A step of Newton squares the error, to which a wrong Jacobian does not lead: a hundredth of the distance leaves a
/// ten thousandth of what is left.
TEST(IkRelative, StepsAreThoseOfTheJacobian) {
  Torso torso;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const std::vector<double> there = torso.random_q(seed, 1.5), way = torso.random_q(seed + 100, 1.0);
    const IkTarget<double> target{torso.relative(there), Vec3<double>::zero()};
    const auto left_after_a_step = [&](double distance) {
      std::vector<double> q = there;
      for (std::size_t i = 0; i < q.size(); ++i) q[i] += distance * way[i];
      const IkSettings once{.max_iterations = 1, .damping = 0, .error_damping = 0};
      (void)solve_goal(torso.tree, torso.params, torso.chain, once, IkGoal{}, target, q.data(), torso.ws);
      return error(torso.relative(q), target.X_WF);
    };
    const double coarse = left_after_a_step(1e-2), fine = left_after_a_step(1e-4);
    EXPECT_LT(fine, 1e-3 * coarse) << "seed " << seed;
  }
}

TEST(IkRelative, ReachesAndLeavesTheCommonJointAlone) {
  Torso torso;
  IkSearch search(torso.model, torso.right, torso.left);
  std::vector<IkTarget<double>> targets;
  for (std::uint32_t seed = 0; seed < 200; ++seed)
    targets.push_back({torso.relative(torso.random_q(seed, 1.9)), Vec3<double>::zero()});
  const std::vector<double> start = torso.random_q(7, 0.5);
  const IkSolutions found = search.find(IkGoal{}, targets, start);
  const auto n = start.size();
  for (std::size_t i = 0; i < targets.size(); ++i) {
    EXPECT_EQ(found.success[i], 1) << i;
    const std::vector<double> q(&found.q[i * n], &found.q[i * n] + n);
    EXPECT_LT(error(torso.relative(q), targets[i].X_WF), 2e-4) << i;
    EXPECT_EQ(q[0], start[0]);
  }
}

/// What is refused is looked for again, up to the last attempt.
TEST(IkSearch, GoesOnUntilASolutionIsAccepted) {
  Torso torso;
  IkSearch search(torso.model, torso.right, torso.left);
  const IkTarget<double> target{torso.relative(torso.random_q(3, 1.0)), Vec3<double>::zero()};
  const std::vector<double> start = torso.model.neutral_configuration();
  const auto left0 = static_cast<std::size_t>(torso.model.joint(torso.model.joint_id("left_joint0")).iq);
  const IkSolutions some =
      search.find(IkGoal{}, {&target, 1}, start, {}, [&](std::span<const double> q) { return q[left0] > 1; });
  EXPECT_EQ(some.success[0], 1);
  EXPECT_GT(some.q[left0], 1);
  const IkSolutions none =
      search.find(IkGoal{}, {&target, 1}, start, {.restarts = 5}, [](std::span<const double>) { return false; });
  EXPECT_EQ(none.success[0], 0);
  EXPECT_EQ(none.attempts[0], 6);
  EXPECT_LT(none.position_error[0], 1e-5);
}

}  // namespace
}  // namespace manyhands
