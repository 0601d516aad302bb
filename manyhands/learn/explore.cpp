#include "manyhands/learn/explore.h"

#include <algorithm>
#include <cmath>

#include "manyhands/learn/random.h"

namespace manyhands::learn {

void explore(const TrainerConfig& config, std::int64_t iteration, bool warming_up, const Matrix<float>& policy_action,
             std::span<const float> advice, Matrix<float>& action) {
  const Eigen::Index count = action.cols();
  const bool all_led = config.expert_rate > 0 && warming_up;
  const Eigen::Index led = all_led ? count : std::lround(config.expert_rate * static_cast<double>(count));
  Random random(config.seed, Purpose::kExploration, static_cast<std::uint64_t>(iteration));
  for (Eigen::Index world = 0; world < count; ++world) {
    const bool random_now = random.uniform() < static_cast<float>(config.random_action_rate);
    const bool uniform = world >= led && (warming_up || random_now);
    const float* wanted =
        world < led ? &advice[static_cast<std::size_t>(world * action.rows())] : policy_action.col(world).data();
    for (Eigen::Index k = 0; k < action.rows(); ++k) {
      const float chosen = wanted[k] + config.exploration_noise * random.normal();
      action(k, world) = uniform ? random.uniform(-1.0f, 1.0f) : std::clamp(chosen, -1.0f, 1.0f);
    }
  }
}

}  // namespace manyhands::learn
