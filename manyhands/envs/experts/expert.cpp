#include "manyhands/envs/experts/expert.h"

#include <array>
#include <stdexcept>

#include "manyhands/envs/experts/pick_and_place.h"
#include "manyhands/envs/experts/push.h"
#include "manyhands/envs/experts/reach.h"
#include "manyhands/envs/experts/slide.h"
#include "manyhands/envs/experts/stack.h"

namespace manyhands {

namespace {

/// One policy for each world.
template <class Policy>
class PolicyExpert final : public Expert {
 public:
  explicit PolicyExpert(std::string id) : id_(std::move(id)) {}

  void act(const EnvBatch& envs, std::span<float> action) override {
    const EnvSpec& spec = envs.spec();
    if (spec.id != id_) throw std::invalid_argument("the expert of " + id_ + " cannot act in " + spec.id);
    const auto n = static_cast<std::size_t>(envs.num_envs()), columns = static_cast<std::size_t>(spec.action_dim);
    if (action.size() != n * columns) {
      throw std::invalid_argument(id_ + ": the actions have length " + std::to_string(action.size()) + ", expected " +
                                  std::to_string(n * columns));
    }
    worlds_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const HandAction next = worlds_[i].act(&envs.observation()[i * static_cast<std::size_t>(spec.observation_dim)],
                                             &envs.desired_goal()[i * static_cast<std::size_t>(spec.goal_dim)]);
      const std::array parts{next.move.x, next.move.y, next.move.z, next.grip};
      for (std::size_t k = 0; k < columns; ++k) action[i * columns + k] = std::clamp(parts[k], -1.0f, 1.0f);
    }
  }

 private:
  using HandAction = experts::HandAction;

  std::string id_;
  std::vector<Policy> worlds_;
};

/// Calls visit(Policy{}) for every task.
template <class Visit>
void for_each_policy(Visit&& visit) {
  visit(experts::Reach{});
  visit(experts::Slide{});
  visit(experts::Push{});
  visit(experts::PickAndPlace{});
  visit(experts::Stack{});
}

std::vector<std::string> ids_of(const std::string& task) {
  return {"Panda" + task + "-v3", "Panda" + task + "Dense-v3"};
}

}  // namespace

std::vector<std::string> expert_ids() {
  std::vector<std::string> all;
  for_each_policy([&](const auto& policy) {
    for (const std::string& id : ids_of(policy.kTask)) all.push_back(id);
  });
  return all;
}

std::unique_ptr<Expert> make_expert(const std::string& id) {
  std::unique_ptr<Expert> made;
  for_each_policy([&]<class Policy>(const Policy& policy) {
    for (const std::string& known : ids_of(policy.kTask)) {
      if (known == id) made = std::make_unique<PolicyExpert<Policy>>(id);
    }
  });
  if (made) return made;
  std::string message = "no expert for '" + id + "'; there are experts for:";
  for (const std::string& known : expert_ids()) message += ' ' + known;
  throw std::invalid_argument(message);
}

}  // namespace manyhands
