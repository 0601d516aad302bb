#include "manyhands/control/joint_control.h"

namespace manyhands {

void require_single_joints(const Model& model) {
  for (const Joint& joint : model.joints()) {
    switch (joint.type) {
      case JointType::kFixed:
      case JointType::kRevolute:
      case JointType::kContinuous:
      case JointType::kPrismatic:
        break;
      case JointType::kSpherical:
      case JointType::kPlanar:
      case JointType::kFloating:
      case JointType::kMocap:
        throw ModelError("joint '" + joint.name + "' has not one degree of freedom; this controller is for models of " +
                         "revolute, continuous, prismatic and fixed joints");
    }
  }
}

}  // namespace manyhands
