// Which of the thousands of geoms of one large world are near each other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "manyhands/physics/collision/broad/bounds.h"

namespace manyhands {

/// Two geoms whose bounds overlap; a < b.
struct NearPair {
  std::uint32_t a{}, b{};

  auto operator<=>(const NearPair&) const = default;
};

/// Sweep and prune (Baraff, Dynamic Simulation of Non-Penetrating Rigid Bodies, 1992): bounds sorted along the axis on
/// which they are spread most, kept in order from step to step; those that overlap along it are compared on the other
/// two, many at a time. The pairs depend on the bounds only, not on the steps before.
class BroadPhase {
 public:
  /// `is_static` (n): true for geoms that never need to be paired with each other.
  explicit BroadPhase(const std::vector<bool>& is_static);

  /// All pairs whose bounds overlap or touch, sorted, without those of two static geoms. `bounds` (n) may be infinite;
  /// bounds with a NaN overlap nothing. Valid until the next call. Allocates only while the number of pairs grows.
  /// Throws std::invalid_argument if `bounds` has another size than `is_static` had.
  std::span<const NearPair> update(std::span<const Aabb<double>> bounds);

 private:
  /// Geoms in the order of their bounds' low ends along the swept axis, and their bounds in single precision, rounded
  /// outwards, followed by as many that overlap nothing as are compared at a time.
  struct Sorted {
    std::vector<std::uint32_t> geom;
    std::vector<double> key;
    std::vector<float> low, high, low_1, high_1, low_2, high_2;

    void reserve();
    void sort(std::span<const Aabb<double>> bounds, int axis, bool afresh);
  };

  void find(std::span<const Aabb<double>> bounds, const Sorted& among, std::size_t first, const Sorted& of,
            std::size_t which);
  void sort_pairs();

  Sorted moving_, static_;
  int axis_ = -1;
  std::vector<NearPair> pairs_, scratch_;
  std::vector<std::uint32_t> count_;
};

}  // namespace manyhands
