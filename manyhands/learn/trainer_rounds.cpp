// Training with worlds that run elsewhere.
#include <algorithm>
#include <stdexcept>

#include "manyhands/learn/parameters.h"
#include "manyhands/learn/trainer.h"

namespace manyhands::learn {

void Trainer::spread(std::vector<int> shares) {
  if (config_.algorithm == Algorithm::kPpo) {
    throw std::invalid_argument(
        "PPO learns from what its present policy does in worlds of its own alone, so they cannot run elsewhere; choose "
        "TD3 or SAC");
  }
  if (learner_->actor() == nullptr) {
    throw std::invalid_argument(
        "what learns from pictures takes them of worlds of its own, so they cannot run elsewhere");
  }
  if (shares.empty() || std::ranges::min(shares) < 1) {
    throw std::invalid_argument("Trainer::spread: there must be shares, each of one world or more");
  }
  rounds_ = {.shares = std::move(shares), .order = {}, .places = {}};
  rounds_.places.resize(rounds_.shares.size());
  make_order(0);
}

void Trainer::make_order(std::int64_t iteration) {
  rounds_.order = write_order(*learner_->actor(), normaliser_, iteration, config_.round_steps, learner_->warming_up());
}

void Trainer::receive(std::span<const Message> results) {
  if (results.size() != rounds_.shares.size()) {
    throw std::invalid_argument("Trainer::receive: there are " + std::to_string(rounds_.shares.size()) +
                                " shares, but " + std::to_string(results.size()) + " results");
  }
  const int advice_dim = config_.wants_expert() ? spec_.action_dim : 0;
  std::vector<ShareResult> brought;
  for (const Message& result : results) brought.push_back(read_result(spec_, advice_dim, result));
  for (std::size_t share = 0; share < brought.size(); ++share) {
    for (const Episode& episode : brought[share].episodes) {
      learner_->add(episode.view());
      count_episode(episode.view(), episode.succeeded);
    }
    rounds_.places[share] = std::move(brought[share].place);
    metrics_.env_steps += std::int64_t{config_.round_steps} * rounds_.shares[share];
  }
  normaliser_.refresh();
  make_order(metrics_.iterations + config_.round_steps);
}

TrainMetrics Trainer::learn() {
  LearnStats stats;
  for (int i = 0; i < config_.round_steps && !metrics_.solved; ++i) learn_once(stats);
  return report(stats);
}

void Trainer::save_rounds(ArchiveWriter& out) const {
  out.value(static_cast<int>(rounds_.shares.size()));
  for (const int worlds : rounds_.shares) out.value(worlds);
  out.message(rounds_.order);
  for (const Message& place : rounds_.places) out.message(place);
}

Trainer::Rounds Trainer::read_rounds(ArchiveReader& in) const {
  Rounds rounds{.shares = rounds_.shares, .order = {}, .places = {}};
  in.expect("number of shares of the worlds that run elsewhere", static_cast<int>(rounds.shares.size()));
  for (const int worlds : rounds.shares) in.expect("number of worlds in a share", worlds);
  rounds.order = in.message();
  for (std::size_t i = 0; i < rounds.shares.size(); ++i) rounds.places.push_back(in.message());
  return rounds;
}

}  // namespace manyhands::learn
