// What asserts ask of trees and states: true of what is built, false of what is broken in one place.
#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "manyhands/math/instantiate.h"
#include "manyhands/physics/dynamics/checks.h"
#include "tests/physics/dynamics/random_tree.h"

namespace manyhands {
namespace {

TEST(Checks, TopologyOfATree) {
  const Model model = testing::random_tree(1, 12);
  const Tree<double> tree(model);
  EXPECT_TRUE(internal::is_topology_sound(tree));
  const auto broken = [&](auto&& breaks) {
    Tree<double> copy = tree;
    breaks(copy);
    return !internal::is_topology_sound(copy);
  };
  EXPECT_TRUE(broken([](Tree<double>& t) { t.bodies[2].parent = 2; }));
  EXPECT_TRUE(broken([](Tree<double>& t) { t.bodies[2].parent = -1; }));
  EXPECT_TRUE(broken([](Tree<double>& t) { t.bodies[1].nv = t.nv + 1; }));
  EXPECT_TRUE(broken([](Tree<double>& t) { t.dof_parent[0] = 0; }));
  EXPECT_TRUE(broken([](Tree<double>& t) { t.dof_q.pop_back(); }));
}

TEST(Checks, FiniteInEveryLane) {
  std::array<Lanes4, 3> values{Lanes4(1.0f), Lanes4(2.0f), Lanes4(3.0f)};
  EXPECT_TRUE(internal::all_finite(values.data(), 3));
  set_lane(values[1], 2, std::numeric_limits<float>::infinity());
  EXPECT_FALSE(internal::all_finite(values.data(), 3));
  EXPECT_TRUE(internal::all_finite(values.data(), 1));
}

}  // namespace
}  // namespace manyhands
