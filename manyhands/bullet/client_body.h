// What a client knows of one body. Internal to Client.
#pragma once

#include "manyhands/bullet/client.h"
#include "manyhands/physics/dynamics/params.h"
#include "manyhands/physics/dynamics/tree.h"
#include "manyhands/physics/dynamics/workspace.h"

namespace manyhands::bullet {

/// The motor of a joint, and what was asked of it.
struct MotorMemory {
  MotorSetting setting{};
  bool is_default = true;  ///< a velocity motor of 1 N s at rest
  double max_velocity = std::numeric_limits<double>::infinity();
  double torque = 0;                             ///< of TORQUE_CONTROL, for the next step
  std::optional<MotorSetting> pd{};              ///< of PD_CONTROL and STABLE_PD_CONTROL
  std::optional<BallSetting> ball{}, ball_pd{};  ///< the same of a spherical joint
  Vec3<double> ball_torque = Vec3<double>::zero();
  bool has_sensor = false;
};

struct LinkMemory {
  std::optional<double> contact_stiffness{}, contact_damping{};
  double margin = 0.001;
  std::array<int, 2> filter{1, -1};
  std::vector<std::array<float, 4>> rgba{};  ///< of its visuals
  std::vector<int> textures{};               ///< of its visuals; -1: their own
};

/// The body alone, its inertial frame in the world's: what kinematics and dynamics are computed with.
struct Mechanism {
  explicit Mechanism(Model own) : model(std::move(own)), tree(model), params(model), ws(tree) {}

  Model model;
  Tree<double> tree;
  ParamsStorage<double> params;
  Workspace<double> ws;
  std::vector<int> iq{}, iv{};  ///< (joints that move) where their numbers are in q and v
};

struct Client::Body {
  int id = 0;
  BodyPlan plan{};
  std::int64_t edition = -1;
  LinkId first_link{};     ///< of the base, in the world
  JointId first_joint{};   ///< of link 0
  std::vector<int> dof{};  ///< (links) of each joint among those that move; -1 of fixed ones
  int num_dofs = 0;
  double linear_damping = 0.04, angular_damping = 0.04;
  double max_joint_velocity = 100;
  bool is_capped = false;  ///< a program asked for it: PyBullet's own cap would only hide that something goes wrong
  std::vector<MotorMemory> motors{};       ///< (links)
  std::vector<LinkMemory> memory{};        ///< base, then links
  bool has_clamps = false;                 ///< some motor's command depends on the state
  std::unique_ptr<Mechanism> mechanism{};  ///< once kinematics are asked for

  [[nodiscard]] LinkMemory& of(int link) { return memory[static_cast<std::size_t>(link + 1)]; }
  [[nodiscard]] const LinkMemory& of(int link) const { return memory[static_cast<std::size_t>(link + 1)]; }
  [[nodiscard]] MotorMemory& motor(int joint) { return motors[static_cast<std::size_t>(joint)]; }
  [[nodiscard]] bool has_link(int link) const { return link >= -1 && link < plan.num_links(); }
  [[nodiscard]] bool has_joint(int joint) const { return joint >= 0 && joint < plan.num_links(); }
};

}  // namespace manyhands::bullet
