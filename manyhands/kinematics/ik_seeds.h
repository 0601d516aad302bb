// Configurations by where they bring a frame: starts from which an attempt at a goal is likely to be short.
#pragma once

#include <span>
#include <vector>

#include "manyhands/kinematics/ik_goals.h"

namespace manyhands::internal {

/// Random configurations of a chain within its limits, sorted by where its frame is then. The same for every goal,
/// start and seed of a search.
class IkSeeds {
 public:
  static constexpr int kRanks = 8;  ///< how many of those near a goal are worth an attempt

  IkSeeds(const Tree<float>& tree, const Params<float>& params, const IkChain& chain);

  /// Coordinates (of the chain's dofs) from near the goal, which asks for a position: the best of them is of rank 0.
  [[nodiscard]] std::span<const float> near(const IkGoal& goal, const IkTarget<double>& target, int rank) const;

  /// Coordinate k of such a configuration: for a joint that turns without limits, by whole turns as near as can be to
  /// `here`.
  [[nodiscard]] float coordinate(std::span<const float> seed, std::size_t k, float here) const;

 private:
  static constexpr std::size_t kLeaf = 128, kLevels = 6, kSize = kLeaf << kLevels;  // of the tree by halves
  static constexpr std::size_t kNumbers = 8;  // position, quaternion, and how near to its limits each joint is

  void place_all(const Tree<float>& tree, const Params<float>& params, const IkChain& chain);
  void sort(std::span<std::size_t> order, std::size_t node);
  void arrange(std::span<const std::size_t> order);
  [[nodiscard]] std::size_t leaf_of(const Vec3<double>& p) const;

  std::size_t dofs_;
  std::vector<std::uint8_t> turns_freely_;                              // (dofs)
  std::vector<float> q_;                                                // (kSize, dofs)
  std::vector<float> numbers_;                                          // (leaves, kNumbers, kLeaf)
  std::vector<float> split_ = std::vector<float>((1u << kLevels) - 1);  // of the nodes, the root first
};

}  // namespace manyhands::internal
