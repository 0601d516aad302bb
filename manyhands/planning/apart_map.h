// Where the one or two joints between two parts keep these apart, whatever all other joints do.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace manyhands {

struct PlanningScene;
struct PartPair;

/// Cells in the space of those joints, each known to keep both parts apart or not.
class ApartMap {
 public:
  static constexpr std::size_t kCells = 64;  // of each joint's range

  /// One of the joints, as a planned coordinate, and its limits [rad or m].
  struct Axis {
    std::size_t coordinate{};
    double lower{}, upper{};
  };
  /// Cells from `first` on, `count` of each axis.
  struct Box {
    std::array<std::size_t, 2> first{}, count{1, 1};
  };

  ApartMap() = default;                       ///< knows nothing
  explicit ApartMap(std::vector<Axis> axes);  ///< of one or two; nothing is known to be apart

  [[nodiscard]] const std::vector<Axis>& axes() const { return axes_; }
  [[nodiscard]] Box whole() const;
  [[nodiscard]] double middle(const Box& box, std::size_t axis) const;
  [[nodiscard]] double half_width(const Box& box, std::size_t axis) const;

  void set_apart(const Box& box);
  void finish();  ///< after the last box

  [[nodiscard]] bool is_apart_everywhere() const { return !axes_.empty() && open_.back() == 0; }
  /// Whether both are apart wherever the joints are between `low` and `high`, one number for each axis.
  [[nodiscard]] bool is_apart(const std::array<float, 2>& low, const std::array<float, 2>& high) const;

 private:
  [[nodiscard]] double width(std::size_t axis) const;  // of a cell
  [[nodiscard]] std::size_t place(std::size_t i, std::size_t j) const { return i * (kCells + 1) + j; }

  std::vector<Axis> axes_;
  std::vector<int> open_;  // (kCells + 1, kCells + 1): cells below (i, j) that are not known to be apart
};

namespace internal {

class ExactCheck;

/// Of a pair with one or two joints between, that have limits; else a map that knows nothing. In a box of these joints
/// no point moves by more than the reach of joints times its halves; what stays open is halved, as long as that is
/// much.
[[nodiscard]] ApartMap apart_map(const PlanningScene& scene, const PartPair& pair, ExactCheck& exact);

}  // namespace internal

}  // namespace manyhands
