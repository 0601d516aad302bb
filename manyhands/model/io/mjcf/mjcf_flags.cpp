// <option><flag>: what is there in the file, but turned off.
#include "manyhands/model/io/mjcf/mjcf_scene.h"

namespace manyhands::io {

void apply_flags(MjcfScene& scene) {
  const MjcfFlags& flags = scene.settings.flags;
  ModelBuilder& builder = scene.builder;
  for (const MjcfJoint& of_file : scene.joints) {
    Joint& joint = builder.joint(of_file.id);
    if (!flags.spring) joint.stiffness = 0;
    if (!flags.damper) joint.damping = 0;
    if (!flags.friction_loss) joint.friction = 0;
    if (!flags.limit) joint.limits = {.effort = joint.limits.effort, .velocity = joint.limits.velocity};
  }
  for (std::size_t i = 0; i < builder.tendons().size(); ++i) {
    Tendon& tendon = builder.tendon(TendonId(i));
    if (!flags.spring) tendon.stiffness = 0;
    if (!flags.damper) tendon.damping = 0;
    if (!flags.friction_loss) tendon.friction = 0;
    if (flags.limit) continue;
    tendon.lower = -std::numeric_limits<double>::infinity();
    tendon.upper = std::numeric_limits<double>::infinity();
  }
  for (std::size_t i = 0; i < builder.links().size() && !flags.has_passive(); ++i) {
    builder.link(LinkId(i)).gravity_compensation = 0;
  }
  for (const int index : scene.actuators) {
    if (index < 0) continue;
    Actuator& actuator = builder.actuator(ActuatorId(index));
    if (!flags.actuation) actuator.max_force = 0;
    if (flags.clamp_ctrl) continue;
    actuator.min_ctrl = -std::numeric_limits<double>::infinity();
    actuator.max_ctrl = std::numeric_limits<double>::infinity();
  }
}

}  // namespace manyhands::io
