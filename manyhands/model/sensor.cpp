#include "manyhands/model/sensor.h"

namespace manyhands {

int size_of(SensorType type) {
  switch (type) {
    case SensorType::kBallQuaternion:
    case SensorType::kFrameQuaternion:
      return 4;
    case SensorType::kJointPosition:
    case SensorType::kJointVelocity:
    case SensorType::kTendonPosition:
    case SensorType::kTendonVelocity:
    case SensorType::kActuatorPosition:
    case SensorType::kActuatorVelocity:
    case SensorType::kActuatorForce:
    case SensorType::kTouch:
    case SensorType::kRangefinder:
    case SensorType::kClock:
      return 1;
    default:
      return 3;
  }
}

const char* to_string(SensorType type) {
  switch (type) {
    case SensorType::kJointPosition:
      return "jointpos";
    case SensorType::kJointVelocity:
      return "jointvel";
    case SensorType::kBallQuaternion:
      return "ballquat";
    case SensorType::kBallAngularVelocity:
      return "ballangvel";
    case SensorType::kTendonPosition:
      return "tendonpos";
    case SensorType::kTendonVelocity:
      return "tendonvel";
    case SensorType::kActuatorPosition:
      return "actuatorpos";
    case SensorType::kActuatorVelocity:
      return "actuatorvel";
    case SensorType::kActuatorForce:
      return "actuatorfrc";
    case SensorType::kFramePosition:
      return "framepos";
    case SensorType::kFrameQuaternion:
      return "framequat";
    case SensorType::kFrameXAxis:
      return "framexaxis";
    case SensorType::kFrameYAxis:
      return "frameyaxis";
    case SensorType::kFrameZAxis:
      return "framezaxis";
    case SensorType::kFrameLinearVelocity:
      return "framelinvel";
    case SensorType::kFrameAngularVelocity:
      return "frameangvel";
    case SensorType::kFrameLinearAcceleration:
      return "framelinacc";
    case SensorType::kFrameAngularAcceleration:
      return "frameangacc";
    case SensorType::kSubtreeCenterOfMass:
      return "subtreecom";
    case SensorType::kSubtreeLinearVelocity:
      return "subtreelinvel";
    case SensorType::kSubtreeAngularMomentum:
      return "subtreeangmom";
    case SensorType::kVelocimeter:
      return "velocimeter";
    case SensorType::kGyro:
      return "gyro";
    case SensorType::kAccelerometer:
      return "accelerometer";
    case SensorType::kForce:
      return "force";
    case SensorType::kTorque:
      return "torque";
    case SensorType::kTouch:
      return "touch";
    case SensorType::kRangefinder:
      return "rangefinder";
    case SensorType::kClock:
      return "clock";
  }
  return "";
}

}  // namespace manyhands
