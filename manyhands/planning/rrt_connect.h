// Paths among obstacles by two trees that grow towards each other.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <utility>

#include "manyhands/planning/steering.h"

namespace manyhands {

/// Until when a search may go on. It ends earlier if `look_up`, which is called every 50 ms, throws.
class Deadline {
 public:
  explicit Deadline(double seconds, std::function<void()> look_up = {})
      : end_(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                std::chrono::duration<double>(seconds < kLong ? seconds : kLong))),
        look_up_(std::move(look_up)),
        next_look_(Clock::now() + kBetweenLooks) {}

  [[nodiscard]] bool has_passed() const {
    const Clock::time_point now = Clock::now();
    if (look_up_ && now >= next_look_) {
      next_look_ = now + kBetweenLooks;
      look_up_();
    }
    return now >= end_;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr double kLong = 1e6;  // [s]
  static constexpr std::chrono::milliseconds kBetweenLooks{50};
  Clock::time_point end_;
  std::function<void()> look_up_;
  mutable Clock::time_point next_look_;
};

struct RrtSettings {
  double range = 2.0;  ///< the longest edge, in the space of planned coordinates [rad or m]
  std::uint64_t seed = 0;
};

/// Waypoints as rows of n.
struct RrtPath {
  std::vector<float> rows{};  ///< empty if none was found
  std::size_t nodes = 0;      ///< of both trees
  std::size_t iterations = 0;
};

/// A path from `start` (n) to one of `goals` (rows of n), all of them free and within the scene's limits, whose edges
/// are free all along. The same for the same seed, unless time runs out. RRT-Connect: Kuffner and LaValle, RRT-Connect:
/// An efficient approach to single-query path planning, ICRA 2000. The smaller of the trees grows; a node from which an
/// edge is not free tries shorter ones next.
[[nodiscard]] RrtPath rrt_connect(const PlanningScene& scene, ConfigurationCheck& check, std::span<const float> start,
                                  std::span<const float> goals, const RrtSettings& settings, const Deadline& deadline);

}  // namespace manyhands
