// The smallest program on an installed manyhands: a pendulum of one's own, let go from the side.
#include <cstdio>

#include "manyhands/model/model_builder.h"
#include "manyhands/physics/world/world.h"

int main() {
  manyhands::ModelBuilder builder("pendulum");
  const manyhands::LinkId rod = builder.add_link("rod", {.mass = 1.0, .com = {0.0, 0.0, -0.5}});
  builder.add_joint({.name = "hinge",
                     .type = manyhands::JointType::kContinuous,
                     .parent = builder.world(),
                     .child = rod,
                     .axis = {0.0, 1.0, 0.0},
                     .damping = 0.05});
  manyhands::World world(std::make_shared<const manyhands::Model>(builder.build()));
  world.set_q(std::vector{1.57});
  for (int i = 0; i < 10; ++i) {
    world.step(50);
    const manyhands::Energy<double> energy = world.energy();
    std::printf("%.1f s: angle %6.3f rad, energy %6.3f J\n", world.time(), world.q()[0],
                energy.kinetic + energy.potential);
  }
}
