// What a command does: the force of an actuator on a joint or tendon, or at a site.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>

#include "manyhands/model/description.h"

namespace manyhands {

enum class ActuatorType {
  kForce,     ///< force = gear ctrl
  kPosition,  ///< force = gear (kp (ctrl - gear q) - kd gear v); an angle between two sites takes the shorter way
  kVelocity,  ///< force = gear kd (ctrl - gear v)
  kAffine,    ///< force = gear (gain . (1, gear q, gear v) ctrl + bias . (1, gear q, gear v))
};

/// Whether its force may depend on q and v.
[[nodiscard]] inline bool is_drive(ActuatorType type) { return type != ActuatorType::kForce; }

enum class ActivationType {
  kNone,         ///< none: ctrl acts at once
  kIntegrator,   ///< d act / dt = ctrl
  kFilter,       ///< d act / dt = (ctrl - act) / time_constant, by Euler's method
  kFilterExact,  ///< the same, solved exactly for a ctrl that is constant over the step
};

/// A state between command and force: the actuator's law reads `act` in the place of ctrl.
struct Activation {
  ActivationType type = ActivationType::kNone;
  double time_constant = 1;  ///< [s]
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool early = false;  ///< whether the law reads the activation at the step's end, not at its beginning
};

/// A site S on a link, at which an actuator pulls: with `force` at its origin and `torque`, for each unit of the
/// actuator's force. They are in the axes of S, or of the reference R, against which it pulls then: the dofs that move
/// both do not feel it. q is where S is from R, `force` . p_RS + `torque` . rotation vector of R_RS; 0 without a
/// reference. v is the rate at which the wrench does work.
struct ActuatorSite {
  LinkId link{};
  Transform<double> X_LS = Transform<double>::identity();
  LinkId reference{};  ///< invalid: none
  Transform<double> X_LR = Transform<double>::identity();
  Vec3<double> force = Vec3<double>::zero();
  Vec3<double> torque = Vec3<double>::zero();
};

/// A drive on a joint of one degree of freedom, on a tendon, whose length is its q, or at a site; commanded by one
/// number, `ctrl`. Drives of one joint or tendon add up; each keeps within its own bounds.
struct Actuator {
  std::string name{};
  ActuatorType type = ActuatorType::kForce;
  JointId joint{};
  TendonId tendon{};
  std::optional<ActuatorSite> site{};  ///< one of the three
  double gear = 1;
  double ctrl_scale = 1, ctrl_offset = 0;  ///< ctrl_scale ctrl + ctrl_offset stands where laws say ctrl
  double kp = 0;                           ///< [N m/rad or N/m]
  double kd = 0;                           ///< [N m s/rad or N s/m]
  std::array<double, 3> gain{1, 0, 0};     ///< of kAffine
  std::array<double, 3> bias{0, 0, 0};     ///< of kAffine
  Activation activation{};
  int iact = -1;  ///< index of its activation in act; -1 without one. Set by ModelBuilder::build
  double min_ctrl = -std::numeric_limits<double>::infinity();
  double max_ctrl = std::numeric_limits<double>::infinity();
  double max_force = std::numeric_limits<double>::infinity();  ///< at the joint [N m or N]
  std::optional<double> min_force{};                           ///< likewise; without it -max_force

  [[nodiscard]] bool has_activation() const { return activation.type != ActivationType::kNone; }
  [[nodiscard]] double least_force() const { return min_force.value_or(-max_force); }
};

}  // namespace manyhands
