// What a scene measures by name.
#pragma once

#include <string>

#include "manyhands/model/description.h"

namespace manyhands {

/// MuJoCo's kinds, with its values but for the order of quaternions. F is a frame on a link: its pose in R, another
/// frame, or in the world.
enum class SensorType {
  kJointPosition,             ///< q of a joint of one degree of freedom [rad or m]
  kJointVelocity,             ///< its rate
  kBallQuaternion,            ///< of a ball joint, xyzw
  kBallAngularVelocity,       ///< of a ball joint, in the child's axes [rad/s]
  kTendonPosition,            ///< length
  kTendonVelocity,            ///< its rate
  kActuatorPosition,          ///< gear q
  kActuatorVelocity,          ///< gear v
  kActuatorForce,             ///< of the actuator itself, in the last step: at the joint divided by gear
  kFramePosition,             ///< p_RF [m]
  kFrameQuaternion,           ///< R_RF, xyzw
  kFrameXAxis,                ///< in R
  kFrameYAxis,                ///<
  kFrameZAxis,                ///<
  kFrameLinearVelocity,       ///< of F's origin as seen from R, in R's axes [m/s]
  kFrameAngularVelocity,      ///< [rad/s]
  kFrameLinearAcceleration,   ///< of F's origin in the world, in the last step [m/s^2]
  kFrameAngularAcceleration,  ///< likewise [rad/s^2]
  kSubtreeCenterOfMass,       ///< of a link and all that hangs on it [m]
  kSubtreeLinearVelocity,     ///< of that point [m/s]
  kSubtreeAngularMomentum,    ///< about it [kg m^2/s]
  kVelocimeter,               ///< velocity of F's origin, in F's axes [m/s]
  kGyro,                      ///< angular velocity, in F's axes [rad/s]
  kAccelerometer,             ///< acceleration of F's origin less gravity, in F's axes, in the last step [m/s^2]
  kForce,        ///< between a link and its parent in the last step, tendons' pulls included, in F's axes [N]
  kTorque,       ///< likewise, about F's origin [N m]
  kTouch,        ///< normal forces of contacts within a volume in the last step [N]
  kRangefinder,  ///< along F's z to the next geom of another body; -1 without one [m]
  kClock,        ///< [s]
};

/// How many numbers a sensor gives.
[[nodiscard]] int size_of(SensorType type);
/// MuJoCo's name for it.
[[nodiscard]] const char* to_string(SensorType type);
inline constexpr int kSensorTypes = static_cast<int>(SensorType::kClock) + 1;

struct Sensor {  ///< what is measured, where, and within which bounds
  std::string name{};
  SensorType type{};
  JointId joint{};
  TendonId tendon{};
  ActuatorId actuator{};
  LinkId link{};
  Transform<double> X_LF = Transform<double>::identity();
  LinkId reference{};  ///< invalid: the world
  Transform<double> X_LR = Transform<double>::identity();
  Shape volume{};     ///< of kTouch, at F
  double cutoff = 0;  ///< numbers stay between -cutoff and cutoff, positive ones below it; 0: all are there
};

}  // namespace manyhands
