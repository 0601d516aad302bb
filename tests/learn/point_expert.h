// A script that solves PointReach, and remembers: every second step it goes at half speed.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "manyhands/envs/experts/expert.h"

namespace manyhands::learn {

class PointExpert final : public Expert {
 public:
  using Expert::act;

  /// The answer in a state in which the script has been asked `asked` times before.
  static float answer(float position, float goal, int asked) {
    const float speed = asked % 2 == 0 ? 20.0f : 10.0f;
    return std::clamp(speed * (goal - position), -1.0f, 1.0f);
  }

  void act(std::span<const float> observation, std::span<const float> goal, std::span<float> action) override {
    asked_.resize(action.size() / 3);
    for (std::size_t w = 0; w < asked_.size(); ++w) {
      const float* row = &observation[6 * w];
      if (row[3] == 0 && row[4] == 0 && row[5] == 0) asked_[w] = 0;  // an episode begins
      for (std::size_t k = 0; k < 3; ++k) action[3 * w + k] = answer(row[k], goal[3 * w + k], asked_[w]);
      ++asked_[w];
    }
  }

  int action_dim() const override { return 3; }

 private:
  std::vector<int> asked_;
};

}  // namespace manyhands::learn
