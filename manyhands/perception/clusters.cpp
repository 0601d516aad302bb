#include "manyhands/perception/clusters.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>

namespace manyhands {

namespace {

constexpr int kNoise = -1;

/// The points in their cells, and which of them are cores.
class Clustering {
 public:
  using Cell = PointGrid::Cell;

  Clustering(std::span<const Point> points, double reach, std::size_t min_samples)
      : points_(points), reach_(reach), grid_(points, reach), parent_(points.size()), is_core_(points.size(), false) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    for (const Cell& cell : grid_.cells()) near_.push_back(grid_.near(cell));
    for (std::size_t c = 0; c < near_.size(); ++c) find_cores(c, min_samples);
    for (std::size_t c = 0; c < near_.size(); ++c) {
      if (!cores_[c].empty()) unite_cells(c, c);
    }
    for (std::size_t c = 0; c < near_.size(); ++c) {
      for (const std::size_t other : near_[c]) {
        if (other > c && !cores_[c].empty() && !cores_[other].empty()) unite_cells(c, other);
      }
    }
  }

  [[nodiscard]] std::vector<int> labels() {
    std::vector<int> label(points_.size(), kNoise);
    int clusters = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!is_core_[i]) continue;
      const std::size_t root = root_of(i);  // the cluster's first core
      label[i] = root == i ? clusters++ : label[root];
    }
    for (std::size_t c = 0; c < near_.size(); ++c) {
      for (const std::size_t i : grid_.cells()[c].points) {
        if (!is_core_[i]) label[i] = label_of_border(points_[i], c, label);
      }
    }
    return label;
  }

 private:
  [[nodiscard]] bool holds_neighbours(const Point& low, const Point& high, const Cell& cell) const {
    return largest_distance(low, high, cell.low, cell.high) <= reach_;
  }
  [[nodiscard]] bool is_near(const Point& p, const Cell& cell) const {
    return least_distance(p, p, cell.low, cell.high) <= reach_;
  }

  [[nodiscard]] bool has_neighbours(const Point& p, std::size_t c, std::size_t count) const {
    std::size_t found = 0;
    for (const std::size_t other : near_[c]) {
      const Cell& cell = grid_.cells()[other];
      if (!is_near(p, cell)) continue;
      if (holds_neighbours(p, p, cell)) {
        found += cell.points.size();
      } else {
        for (const std::size_t i : cell.points) found += norm(points_[i] - p) <= reach_ ? 1 : 0;
      }
      if (found >= count) return true;
    }
    return false;
  }

  void find_cores(std::size_t c, std::size_t min_samples) {
    const Cell& cell = grid_.cells()[c];
    const bool all = cell.points.size() >= min_samples && holds_neighbours(cell.low, cell.high, cell);
    std::vector<std::size_t>& cores = cores_.emplace_back();
    for (const std::size_t i : cell.points) {
      is_core_[i] = all || has_neighbours(points_[i], c, min_samples);
      if (is_core_[i]) cores.push_back(i);
    }
  }

  [[nodiscard]] std::size_t root_of(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::size_t a, std::size_t b) {
    a = root_of(a), b = root_of(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  /// The cores of two cells, or of one, that lie within reach of each other.
  void unite_cells(std::size_t a, std::size_t b) {
    const Cell &cell_a = grid_.cells()[a], &cell_b = grid_.cells()[b];
    if (holds_neighbours(cell_a.low, cell_a.high, cell_b)) {
      for (const std::size_t i : cores_[a]) unite(i, cores_[b].front());
      for (const std::size_t i : cores_[b]) unite(i, cores_[a].front());
      return;
    }
    const bool whole =  // each of one cluster already: one pair is enough
        holds_neighbours(cell_a.low, cell_a.high, cell_a) && holds_neighbours(cell_b.low, cell_b.high, cell_b);
    if (whole && root_of(cores_[a].front()) == root_of(cores_[b].front())) return;
    for (const std::size_t i : cores_[a]) {
      if (!is_near(points_[i], cell_b)) continue;
      for (const std::size_t j : cores_[b]) {
        if (norm(points_[j] - points_[i]) > reach_) continue;
        unite(i, j);
        if (whole) return;
      }
    }
  }

  /// Of the lowest cluster with a core within reach.
  [[nodiscard]] int label_of_border(const Point& p, std::size_t c, std::span<const int> label) const {
    int lowest = kNoise;
    for (const std::size_t other : near_[c]) {
      if (!is_near(p, grid_.cells()[other])) continue;
      for (const std::size_t i : cores_[other]) {
        if ((lowest == kNoise || label[i] < lowest) && norm(points_[i] - p) <= reach_) lowest = label[i];
      }
    }
    return lowest;
  }

  std::span<const Point> points_;
  double reach_;
  PointGrid grid_;
  std::vector<std::size_t> parent_;  // of a forest whose trees are the clusters
  std::vector<bool> is_core_;
  std::vector<std::vector<std::size_t>> near_{}, cores_{};  // of each cell
};

}  // namespace

std::vector<int> dbscan(std::span<const Point> points, double reach, int min_samples) {
  if (min_samples < 1)
    throw std::invalid_argument("min_samples is " + std::to_string(min_samples) + "; expected 1 or more");
  return Clustering(points, reach, static_cast<std::size_t>(min_samples)).labels();
}

}  // namespace manyhands
