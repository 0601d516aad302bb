#include "manyhands/envs/experts/expert.h"

#include <array>
#include <stdexcept>
#include <utility>

#include "manyhands/envs/experts/flip.h"
#include "manyhands/envs/experts/flip_at_sight.h"
#include "manyhands/envs/experts/joints.h"
#include "manyhands/envs/experts/joints_at_sight.h"
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
  using Expert::act;

  void act(std::span<const float> observation, std::span<const float> desired_goal, std::span<float> action) override {
    const std::size_t n = action.size() / Policy::kActions;
    check("observations", observation.size(), n * Policy::kObservation);
    check("desired goals", desired_goal.size(), n * Policy::kGoal);
    check("actions", action.size(), n * Policy::kActions);
    worlds_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const experts::HandAction next =
          worlds_[i].act(&observation[i * Policy::kObservation], &desired_goal[i * Policy::kGoal]);
      const std::array parts{next.move.x, next.move.y, next.move.z, next.grip};
      for (std::size_t k = 0; k < Policy::kActions; ++k)
        action[i * Policy::kActions + k] = std::clamp(parts[k], -1.0f, 1.0f);
    }
  }

  [[nodiscard]] int action_dim() const override { return Policy::kActions; }

 private:
  static void check(const std::string& what, std::size_t length, std::size_t expected) {
    if (length == expected) return;
    throw std::invalid_argument("the expert of " + std::string(Policy::kTask) + ": the " + what + " have length " +
                                std::to_string(length) + ", expected " + std::to_string(expected));
  }

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
  visit(experts::Flip{});
}

std::vector<std::string> ids_of(const std::string& task, const std::string& control) {
  return {"Panda" + task + control + "-v3", "Panda" + task + control + "Dense-v3"};
}

/// Makes the expert of a script if the id is of its task; `Joints` makes it drive joints.
template <class Policy, class Joints>
void make_if_known(const std::string& id, std::unique_ptr<Expert>& made) {
  for (const std::string& known : ids_of(Policy::kTask, "")) {
    if (known == id) made = std::make_unique<PolicyExpert<Policy>>();
  }
  for (const std::string& known : ids_of(Policy::kTask, "Joints")) {
    if (known == id) made = std::make_unique<Joints>(std::make_unique<PolicyExpert<Policy>>());
  }
}

}  // namespace

std::vector<std::string> expert_ids() {
  std::vector<std::string> all;
  for_each_policy([&](const auto& policy) {
    for (const char* control : {"", "Joints"}) {
      for (const std::string& id : ids_of(policy.kTask, control)) all.push_back(id);
    }
  });
  return all;
}

std::unique_ptr<Expert> make_expert(const std::string& id) {
  std::unique_ptr<Expert> made;
  for_each_policy([&]<class Policy>(const Policy&) { make_if_known<Policy, JointsExpert>(id, made); });
  if (made) return made;
  std::string message = "no expert for '" + id + "'; there are experts for:";
  for (const std::string& known : expert_ids()) message += ' ' + known;
  throw std::invalid_argument(message);
}

std::unique_ptr<Expert> make_adviser(const std::string& id) {
  std::unique_ptr<Expert> made;
  make_if_known<experts::FlipAtSight, JointsAtSight>(id, made);
  if (made) return made;
  for_each_policy([&]<class Policy>(const Policy&) { make_if_known<Policy, JointsAtSight>(id, made); });
  return made ? std::move(made) : make_expert(id);
}

}  // namespace manyhands
