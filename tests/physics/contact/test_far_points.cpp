// Points that nothing seems to bring together are left out of a step, and take part where its solution reaches them.
#include <gtest/gtest.h>

#include <array>

#include "manyhands/model/io/mjcf/mjcf.h"
#include "manyhands/physics/step/step.h"
#include "manyhands/physics/world/world.h"

namespace manyhands {
namespace {

using ModelPointer = std::shared_ptr<const Model>;

constexpr double h = 0.002;

ModelPointer scene(const std::string& world) {
  return std::make_shared<const Model>(
      load_mjcf_string("<mujoco><option gravity='0 0 0'/><worldbody>" + world + "</worldbody></mujoco>").model);
}

std::string slider(const std::string& name, double x) {
  return "<body name='" + name + "' pos='" + std::to_string(x) + " 0 0'><joint type='slide' axis='1 0 0'/>" +
         "<geom type='sphere' size='0.05' mass='1'/></body>";
}

/// The points that take part in a step of a world at rest.
std::size_t points_of_step(const Model& model) {
  const System<double> system(model);
  const ParamsStorage<double> params(model);
  StateStorage<double> state(model, system.contact_numbers());
  StepWorkspace<double> ws(system);
  step(system, params, h, state, ws);
  return ws.contact.problem.points.size();
}

TEST(FarPoints, ANeighbourAtRestTakesNoPart) {
  EXPECT_EQ(points_of_step(*scene(slider("a", 0) + slider("b", 0.101))), 0u);
  EXPECT_EQ(points_of_step(*scene(slider("a", 0) + slider("b", 0.10001))), 1u);
}

/// Inelastic, so that both go on at half the speed: 5 mm in the step, of which the wall leaves 0.5.
TEST(FarPoints, AWallBehindABodyThatIsHitStopsItInTheSameStep) {
  World world(scene(slider("a", 0) + slider("b", 0.102) + "<geom type='box' size='0.1 0.1 0.1' pos='0.2525 0 0'/>"), h);
  world.set_v(std::array{5.0, 0.0});
  world.step();
  EXPECT_NEAR(world.body_pose("b").p.x, 0.1025, 1e-9);
  EXPECT_LE(world.body_pose("a").p.x, 0.0025 + 1e-9);
}

TEST(FarPoints, AChainOfBodiesIsReachedOneAfterTheOther) {
  std::string row;
  for (int i = 0; i < 6; ++i) row += slider("s" + std::to_string(i), 0.1005 * i);
  World world(scene(row + "<geom type='box' size='0.1 0.1 0.1' pos='0.653 0 0'/>"), h);
  world.set_v(std::array{20.0, 0.0, 0.0, 0.0, 0.0, 0.0});
  for (int i = 0; i < 20; ++i) {
    world.step();
    for (int k = 0; k < 5; ++k) {
      const double gap = world.q()[static_cast<std::size_t>(k) + 1] - world.q()[static_cast<std::size_t>(k)] + 0.0005;
      EXPECT_GE(gap, -1e-9) << "after bodies " << k << " and " << k + 1 << " in step " << i;
    }
    EXPECT_LE(world.q()[5], 0.0005 + 1e-9);
  }
}

}  // namespace
}  // namespace manyhands
