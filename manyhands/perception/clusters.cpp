#include "manyhands/perception/clusters.h"

#include <stdexcept>
#include <string>

namespace manyhands {

std::vector<int> dbscan(std::span<const Point> points, double reach, int min_samples) {
  constexpr int kNoise = -1;
  if (min_samples < 1)
    throw std::invalid_argument("min_samples is " + std::to_string(min_samples) + "; expected 1 or more");
  const PointGrid grid(points, reach);
  std::vector<int> cluster(points.size(), kNoise);
  std::vector<std::size_t> front, near;
  std::vector<bool> looked(points.size(), false);
  const auto find_near = [&](std::size_t i) {
    near.clear();
    grid.near(points[i], near);
    looked[i] = true;
    return near.size() >= static_cast<std::size_t>(min_samples);
  };
  int clusters = 0;
  for (std::size_t seed = 0; seed < points.size(); ++seed) {
    if (cluster[seed] != kNoise || looked[seed] || !find_near(seed)) continue;
    const int number = clusters++;
    cluster[seed] = number;
    const auto take_in = [&] {
      for (const std::size_t other : near) {
        if (cluster[other] != kNoise) continue;
        cluster[other] = number;
        if (!looked[other]) front.push_back(other);
      }
    };
    take_in();
    while (!front.empty()) {
      const std::size_t i = front.back();
      front.pop_back();
      if (find_near(i)) take_in();
    }
  }
  return cluster;
}

}  // namespace manyhands
