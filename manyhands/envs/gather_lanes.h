// Which worlds share a block: those that touch the same things and take as long. A block looks at the contacts of all
// its worlds, and waits for the slowest of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace manyhands {

/// Orders lanes by keys, and moves as few as it must: who has the right key where it is stays.
class LaneGatherer {
 public:
  /// For so many lanes, counted over all blocks.
  explicit LaneGatherer(std::size_t lanes) : wanted_(lanes), passed_(lanes) {}

  /// Calls exchange(a, b) for pairs of lanes until the largest keys come first. `key(lane)` must follow.
  template <class Key, class Exchange>
  void gather(Key&& key, Exchange&& exchange) {
    for (std::size_t lane = 0; lane < wanted_.size(); ++lane) wanted_[lane] = key(lane);
    std::sort(wanted_.begin(), wanted_.end(), std::greater<>());
    std::fill(passed_.begin(), passed_.end(), std::size_t{0});
    for (std::size_t lane = 0; lane < wanted_.size(); ++lane) {
      while (key(lane) != wanted_[lane]) exchange(lane, place_of(key(lane), key));
    }
  }

 private:
  /// The first lane that wants this key and has another.
  template <class Key>
  std::size_t place_of(std::uint64_t wanted, Key&& key) {
    const auto found = std::lower_bound(wanted_.begin(), wanted_.end(), wanted, std::greater<>());
    const auto first = static_cast<std::size_t>(found - wanted_.begin());
    std::size_t& passed = passed_[first];
    while (key(first + passed) == wanted) ++passed;
    return first + passed;
  }

  std::vector<std::uint64_t> wanted_;  ///< (lanes) the keys in order
  std::vector<std::size_t> passed_;    ///< by the first lane of a key: how many from there on have it
};

}  // namespace manyhands
