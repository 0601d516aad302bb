// Closed forms: every configuration they give leads to the pose, and the one that it was made from is among them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "manyhands/base/assets.h"
#include "manyhands/kinematics/closed_form.h"
#include "manyhands/math/philox.h"
#include "manyhands/model/io/urdf/urdf.h"
#include "manyhands/model/model_builder.h"

namespace manyhands {
namespace {

/// As industrial arms are: a shoulder off the first axis, an elbow that is bent at 0, a spherical wrist.
Model spherical_wrist() {
  ModelBuilder builder("industrial");
  const std::array<Vec3<double>, 6> shift{
      {{0, 0, 0.4}, {0.15, 0.1, 0}, {0.05, 0.02, 0.6}, {0.2, 0, 0.1}, {0.4, 0, 0}, {0.08, 0, 0}}};
  const std::array<Vec3<double>, 6> axis{{{0, 0, 1}, {0, 1, 0}, {0, -1, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}}};
  LinkId parent = builder.world();
  for (std::size_t k = 0; k < shift.size(); ++k) {
    const std::string number = std::to_string(k + 1);
    const LinkId link = builder.add_link("link" + number, {.mass = 1, .inertia = {1, 1, 1, 0, 0, 0}});
    builder.add_joint({.name = "joint" + number,
                       .type = JointType::kContinuous,
                       .parent = parent,
                       .child = link,
                       .X_PF = {rotation_from_rpy(Vec3<double>{0, 0, 0}), shift[k]},
                       .axis = axis[k]});
    parent = link;
  }
  return builder.build();
}

struct Arm {
  Arm(const std::string& file, const std::string& frame_name)
      : model(file.empty() ? spherical_wrist() : load_urdf(asset_path(file), {.load_meshes = false}).model),
        frame(model.frame_id(frame_name)) {}

  Transform<double> pose(const ClosedForm& form, const ClosedForm::Angles& q) {
    std::vector<double> all = model.neutral_configuration();
    for (std::size_t k = 0; k < q.size(); ++k) all[form.dofs()[k]] = q[k];
    forward_kinematics(tree, all.data(), ws);
    return frame_pose(model.frame(frame).body, model.frame(frame).X_BF, ws);
  }

  Model model;
  FrameId frame;
  Tree<double> tree{model};
  Workspace<double> ws{tree};
};

double difference(const Transform<double>& a, const Transform<double>& b) {
  return norm(a.p - b.p) + norm(a.R.x - b.R.x) + norm(a.R.y - b.R.y);
}

double difference(const ClosedForm::Angles& a, const ClosedForm::Angles& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    most = std::max(most, std::abs(std::remainder(a[k] - b[k], 2 * std::numbers::pi)));
  return most;
}

class ClosedForms : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(ClosedForms, FindAllThatLeadThere) {
  Arm arm(GetParam().first, GetParam().second);
  const std::optional<ClosedForm> form = ClosedForm::of(arm.model, arm.frame);
  ASSERT_TRUE(form);
  std::size_t eight = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    RandomStream random(7, i, 0);
    ClosedForm::Angles q{};
    for (double& angle : q) angle = random.uniform(-3.1f, 3.1f);
    const Transform<double> X = arm.pose(*form, q);
    const std::vector<ClosedForm::Angles> all = form->solve(X);
    ASSERT_LE(all.size(), 8u);
    eight += all.size() == 8;
    double nearest = 10;
    for (const ClosedForm::Angles& one : all) {
      ASSERT_LT(difference(arm.pose(*form, one), X), 1e-7) << "pose " << i;
      nearest = std::min(nearest, difference(one, q));
    }
    ASSERT_LT(nearest, 1e-5) << "pose " << i;
  }
  EXPECT_GT(eight, 200u);
}

TEST_P(ClosedForms, OutOfReachIsNothing) {
  Arm arm(GetParam().first, GetParam().second);
  const ClosedForm form = ClosedForm::of(arm.model, arm.frame).value();
  EXPECT_TRUE(form.solve({Mat3<double>::identity(), {3, 0, 0}}).empty());
}

/// Outstretched and with aligned axes: what is found leads there, something is, and nothing twice.
TEST_P(ClosedForms, SingularPosesAreReached) {
  Arm arm(GetParam().first, GetParam().second);
  const ClosedForm form = ClosedForm::of(arm.model, arm.frame).value();
  for (const ClosedForm::Angles& q : {ClosedForm::Angles{}, {0.3, -0.4, 0, 0.2, 0, 0}, {0, -1, 1.2, 0, 0, 0}}) {
    const Transform<double> X = arm.pose(form, q);
    const std::vector<ClosedForm::Angles> all = form.solve(X);
    EXPECT_FALSE(all.empty());
    for (const ClosedForm::Angles& one : all) EXPECT_LT(difference(arm.pose(form, one), X), 1e-6);
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) EXPECT_GT(difference(all[i], all[k]), 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Arms, ClosedForms,
                         testing::Values(std::pair{"robots/six_axis.urdf", "flange"}, std::pair{"", "link6"},
                                         std::pair{"arm6/arm6.urdf", "arm6_grasptarget"}),
                         [](const auto& arm) { return "arm" + std::to_string(arm.index); });

TEST(ClosedForm, OtherArmsHaveNone) {
  for (const auto& [file, frame] :
       {std::pair{"panda/panda.urdf", "panda_grasptarget"}, std::pair{"robots/scara.urdf", "flange"},
        std::pair{"robots/six_axis_slim.urdf", "flange"},  // its wrist is no point
        std::pair{"robots/seven_axis.urdf", "flange"}}) {
    Arm arm(file, frame);
    EXPECT_FALSE(ClosedForm::of(arm.model, arm.frame)) << file;
  }
}

}  // namespace
}  // namespace manyhands
