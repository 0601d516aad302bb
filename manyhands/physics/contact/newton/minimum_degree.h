// The order in which unknowns are eliminated, so that factors stay sparse.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace manyhands::internal {

/// Greedy: next comes a node with the fewest neighbours; what it leaves behind are neighbours of each other (Tinney and
/// Walker 1967). For graphs of some thousand nodes, kept as a matrix of bits; nothing is allocated for graphs no larger
/// than one before.
class MinimumDegree {
 public:
  /// Nodes without edges.
  void reset(int nodes);

  void connect(int a, int b);

  /// (nodes) in the order of elimination. The edges are used up by it.
  [[nodiscard]] std::span<const int> find_order();

 private:
  [[nodiscard]] std::span<std::uint64_t> neighbours(int node);

  std::size_t words_ = 0;  ///< of a node's row
  std::vector<std::uint64_t> bits_;
  std::vector<int> degree_;  ///< (nodes)
  std::vector<int> order_;
};

}  // namespace manyhands::internal
