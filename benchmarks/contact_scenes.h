// The scenes in contact that are timed: what stands in them, where, and how to tell that they are what they claim.
#pragma once

#include <array>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "manyhands/base/assets.h"
#include "manyhands/envs/panda.h"
#include "manyhands/model/compose.h"
#include "manyhands/model/io/urdf/urdf.h"

namespace benchmarks {

inline constexpr int kContactWorlds = 64;
inline constexpr double kContactTimeStep = 0.002;  // [s]
inline constexpr double kCubeSize = 0.04;          // [m]
inline constexpr double kFingerTip = 0.0072;       // how far the fingers reach beyond the grasp target [m]
inline constexpr std::size_t kPandaJoints = 9;

enum class ContactScene {
  kTable,  ///< a cube lies on the table, the arm keeps away
  kGrasp,  ///< a cube is held in the air between the fingers
  kPress,  ///< two cubes stand on each other, the arm leans on them with closed fingers
};
inline constexpr std::array kContactScenes{ContactScene::kTable, ContactScene::kGrasp, ContactScene::kPress};

inline const char* name_of(ContactScene scene) {
  constexpr std::array kNames{"cube on table", "grasp", "stack pressed"};
  return kNames[static_cast<std::size_t>(scene)];
}

inline int cubes_of(ContactScene scene) { return scene == ContactScene::kPress ? 2 : 1; }

/// The largest motor forces. Where the arm leans on the cubes its shoulder is too weak to hold it up, by 8 N m.
inline std::array<double, kPandaJoints> motor_forces(ContactScene scene) {
  const std::vector<double> usual = manyhands::panda_arm().max_force;
  std::array<double, kPandaJoints> forces{};
  std::ranges::copy(usual, forces.begin());
  if (scene == ContactScene::kPress) forces[1] = 20;
  return forces;
}

/// Where one world starts, and what its motors want.
struct ContactStart {
  std::array<double, kPandaJoints> q{}, target{};
  std::vector<manyhands::Vec3<double>> cubes;  ///< their centres
  double yaw = 0;                              ///< of the cubes
};

/// The Panda with the table before it and cubes of 1 kg and 4 cm.
inline manyhands::Model contact_model(int cubes) {
  const std::filesystem::path file = manyhands::asset_path("panda/panda.urdf");
  std::ostringstream robot;
  robot << std::ifstream(file).rdbuf();
  std::string text = robot.str();
  std::string more =
      "<link name='table'><collision><geometry><box size='1.1 0.7 0.4'/></geometry></collision></link>"
      "<joint name='table_joint' type='fixed'><parent link='panda_link0'/><child link='table'/>"
      "<origin xyz='0.3 0 -0.2'/></joint>";
  for (int i = 0; i < cubes; ++i) {
    const std::string name = "cube" + std::to_string(i);
    more += "<link name='" + name +
            "'><contact><lateral_friction value='1'/></contact><inertial><mass value='1'/>"
            "<inertia ixx='2.6666667e-4' iyy='2.6666667e-4' izz='2.6666667e-4' ixy='0' ixz='0' iyz='0'/></inertial>"
            "<collision><geometry><box size='0.04 0.04 0.04'/></geometry></collision></link>"
            "<joint name='" +
            name + "_joint' type='floating'><parent link='panda_link0'/><child link='" + name + "'/></joint>";
  }
  text.insert(text.rfind("</robot>"), more);
  // In one file they would be one robot, whose links do not touch each other: that holds of the arm's alone.
  const manyhands::Model arm = manyhands::load_urdf(file).model;
  const manyhands::Model all =
      manyhands::load_urdf_string(text, "contact scene", file.parent_path(), {.self_collision = true}).model;
  manyhands::ModelBuilder builder = manyhands::builder_of(all);
  manyhands::PartMap map;
  for (const manyhands::Link& link : arm.links()) map.links.push_back(all.link_id(link.name).value());
  manyhands::exclude_self_collision(builder, arm, map);
  return builder.build();
}

/// Puts the hand, pointing down, with its grasp target at given places, from the neutral pose.
class HandPlacer {
 public:
  explicit HandPlacer(const manyhands::Model& model)
      : chain_(model, model.frame_id("panda_grasptarget")), tree_(model), params_(model), ws_(tree_) {}

  /// The arm's joints, or an empty optional where no pose was found.
  std::array<double, kPandaJoints> arm_at(const manyhands::Vec3<double>& p, double fingers) {
    std::vector<double> q(static_cast<std::size_t>(tree_.nq));
    std::ranges::copy(manyhands::panda_arm().neutral, q.begin());
    manyhands::Transform<double> goal;
    goal.R = {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    goal.p = p;
    manyhands::IkSettings settings;
    settings.max_iterations = 200;
    settings.position_tolerance = settings.rotation_tolerance = 1e-9;
    if (!manyhands::solve_ik(tree_, params_, chain_, settings, goal, q.data(), ws_).success) {
      throw std::runtime_error("the arm does not reach the place that a contact scene asks for");
    }
    std::array<double, kPandaJoints> joints{};
    std::copy_n(q.begin(), kPandaJoints, joints.begin());
    joints[7] = joints[8] = fingers;
    return joints;
  }

 private:
  manyhands::IkChain chain_;
  manyhands::Tree<double> tree_;
  manyhands::ParamsStorage<double> params_;
  manyhands::Workspace<double> ws_;
};

/// The k-th of some numbers in [-1, 1] that lie evenly (the additive recurrence of irrational `step`).
inline double spread(int k, double step) {
  const double x = (k + 0.5) * step;
  return 2 * (x - std::floor(x)) - 1;
}

/// Every world's start, each a little different.
inline std::vector<ContactStart> contact_starts(ContactScene scene, const manyhands::Model& model) {
  using Point = manyhands::Vec3<double>;
  constexpr double kHalf = kCubeSize / 2, kHeight = 0.3, kGap = 0.0002;
  HandPlacer hand(model);
  std::vector<ContactStart> starts;
  for (int k = 0; k < kContactWorlds; ++k) {
    const double a = spread(k, 0.8191725), b = spread(k, 0.6710436), c = spread(k, 0.5497005);
    ContactStart start;
    switch (scene) {
      case ContactScene::kTable:
        std::ranges::copy(manyhands::panda_arm().neutral, start.q.begin());
        start.target = start.q;
        start.cubes = {Point{0.6 + 0.05 * a, 0.05 * b, kHalf}};
        start.yaw = 0.5 * c;
        break;
      case ContactScene::kGrasp: {
        const Point p{0.5 + 0.05 * a, 0.05 * b, kHeight + 0.05 * c};
        start.q = start.target = hand.arm_at(p, kHalf);
        start.target[7] = start.target[8] = 0;
        start.cubes = {p + Point{0.003 * b, 0, 0.003 * c}};
        break;
      }
      case ContactScene::kPress: {
        const Point p{0.5 + 0.05 * a, 0.05 * b, 2 * kCubeSize + kFingerTip};
        start.q = start.target = hand.arm_at(p + Point{0, 0, kGap}, 0);
        start.cubes = {Point{p.x, p.y, kHalf}, Point{p.x + 0.002 * b, p.y + 0.002 * c, 3 * kHalf}};
        break;
      }
    }
    starts.push_back(start);
  }
  return starts;
}

}  // namespace benchmarks
