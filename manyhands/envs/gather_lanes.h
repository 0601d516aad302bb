// Which worlds share a block: those with as much work. A block takes as long as its slowest world.
#pragma once

#include <cstddef>

namespace manyhands {

/// How much work a world makes in a step.
enum class Work : unsigned char {
  kFree,      ///< its arm is far from everything
  kNear,      ///< something is so near that contact must be looked for
  kTouching,  ///< the arm presses on something
};

/// Calls exchange(a, b) for pairs of lanes, counted over all blocks, until those with the most work are the first;
/// `work(lane)` must follow. Lanes that are where they belong stay.
template <class WorkOf, class Exchange>
void gather_lanes(std::size_t lanes, WorkOf&& work, Exchange&& exchange) {
  std::size_t first = 0;
  for (const Work least : {Work::kTouching, Work::kNear}) {
    for (std::size_t last = lanes;;) {
      while (first < last && work(first) >= least) ++first;
      while (first < last && work(last - 1) < least) --last;
      if (first == last) break;
      exchange(first, --last);
    }
  }
}

}  // namespace manyhands
