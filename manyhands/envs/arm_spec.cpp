#include "manyhands/envs/arm_spec.h"

#include <stdexcept>

#include "manyhands/envs/arm6.h"
#include "manyhands/envs/panda.h"

namespace manyhands {

ArmControl arm_control(const std::string& name) {
  std::string known;
  for (const auto& [word, control] : kArmControls) {
    if (name == word) return control;
    known += (known.empty() ? "'" : ", '") + std::string(word) + "'";
  }
  throw std::invalid_argument("control_type is '" + name + "', expected one of " + known);
}

ArmSpec arm_spec(const std::string& name) {
  if (name == "panda") return panda_arm();
  if (name == "arm6") return arm6();
  throw std::invalid_argument("robot is '" + name + "', expected 'panda', 'arm6' or an ArmSpec of your own");
}

}  // namespace manyhands
