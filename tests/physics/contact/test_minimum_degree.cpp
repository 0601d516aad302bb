// The order of elimination against its definition, on sets.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "manyhands/physics/contact/newton/minimum_degree.h"

namespace manyhands {
namespace {

/// Graphs of one word and of several, in the same memory: whoever is next has the fewest neighbours among those left.
TEST(MinimumDegree, EliminatesWhoHasFewestNeighbours) {
  std::mt19937_64 random(1);
  internal::MinimumDegree minimum;
  for (int run = 0; run < 60; ++run) {
    const int nodes = 1 + static_cast<int>(random() % 200), edges = static_cast<int>(random() % 400);
    std::vector<std::set<int>> graph(static_cast<std::size_t>(nodes));
    minimum.reset(nodes);
    for (int k = 0; k < edges; ++k) {
      const auto a = random() % graph.size(), b = random() % graph.size();
      minimum.connect(static_cast<int>(a), static_cast<int>(b));
      if (a == b) continue;
      graph[a].insert(static_cast<int>(b));
      graph[b].insert(static_cast<int>(a));
    }
    std::set<int> left;
    for (int i = 0; i < nodes; ++i) left.insert(i);
    const std::span<const int> order = minimum.find_order();
    ASSERT_EQ(order.size(), graph.size());
    for (const int next : order) {
      ASSERT_EQ(left.count(next), 1u) << "run " << run;
      const std::set<int> around = graph[static_cast<std::size_t>(next)];
      for (const int i : left) ASSERT_LE(around.size(), graph[static_cast<std::size_t>(i)].size()) << "run " << run;
      left.erase(next);
      for (const int i : around) {
        std::set<int>& row = graph[static_cast<std::size_t>(i)];
        row.insert(around.begin(), around.end());
        row.erase(i);
        row.erase(next);
      }
    }
  }
}

}  // namespace
}  // namespace manyhands
