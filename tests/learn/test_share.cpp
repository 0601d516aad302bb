// Worlds that run apart from their trainer: what comes back is what they did, and the same whoever did it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <memory>

#include "manyhands/learn/trainer.h"
#include "tests/learn/point_expert.h"
#include "tests/learn/point_reach.h"
#include "tests/learn/small_config.h"

namespace manyhands::learn {
namespace {

TrainerConfig guided_config() {
  TrainerConfig config = small_config({24, 16}, 300, 3000);
  config.expert_rate = 0.25;
  config.cloning_weight = 2;
  config.evaluation_interval = 12;
  config.evaluation_episodes = 20;
  config.stop_streak = 0;
  return config;
}

/// A process of its own, as far as a test needs one.
struct Worker {
  Worker(const TrainerConfig& config, int first, int worlds) : envs(worlds), share(envs, &expert, config, first) {}

  PointReach envs;
  PointExpert expert;
  Share share;
};

/// A trainer and its workers: worlds 0 to 5, 6 to 15.
class Spread {
 public:
  explicit Spread(const TrainerConfig& config)
      : config_(config), envs_(1), evaluation_(20), trainer(envs_, &evaluation_, config, &expert_) {
    trainer.spread({6, 10});
    start(0);
    start(1);
  }

  /// A new worker takes the place of one that is lost.
  void start(int share) {
    workers_[static_cast<std::size_t>(share)] = std::make_unique<Worker>(config_, 6 * share, share == 0 ? 6 : 10);
  }

  [[nodiscard]] std::vector<Message> run() {
    std::vector<Message> results;
    for (int share = 0; share < 2; ++share) {
      results.push_back(workers_[static_cast<std::size_t>(share)]->share.run(trainer.order(), trainer.place(share)));
    }
    return results;
  }

  void rounds(int count) {
    for (int i = 0; i < count; ++i) {
      trainer.receive(run());
      trainer.learn();
    }
  }

 private:
  TrainerConfig config_;
  PointReach envs_, evaluation_;
  PointExpert expert_;
  std::array<std::unique_ptr<Worker>, 2> workers_;

 public:
  Trainer trainer;
};

void expect_same(const Trainer& a, const Trainer& b) {
  const Policy one = a.policy(), other = b.policy();
  EXPECT_EQ(one.mean, other.mean);
  for (std::size_t l = 0; l < one.layers.size(); ++l) {
    EXPECT_EQ(one.layers[l].weight, other.layers[l].weight);
    EXPECT_EQ(one.layers[l].bias, other.layers[l].bias);
  }
  EXPECT_EQ(a.metrics().env_steps, b.metrics().env_steps);
  EXPECT_EQ(a.metrics().episodes, b.metrics().episodes);
  EXPECT_EQ(a.metrics().gradient_steps, b.metrics().gradient_steps);
  EXPECT_EQ(a.metrics().evaluations, b.metrics().evaluations);
}

TEST(Share, BringsWhatTheWorldsDidUnderTheTrainersPolicy) {
  TrainerConfig config = small_config({24, 16}, 1, 3000);
  config.exploration_noise = 0;
  config.random_action_rate = 0;
  PointReach envs(1), elsewhere(8);
  Trainer trainer(envs, nullptr, config);
  trainer.spread({8});
  Share share(elsewhere, nullptr, config, 0);
  while (trainer.metrics().episodes == 0) {  // the first ones act at random
    trainer.receive(std::vector<Message>{share.run(trainer.order(), trainer.place(0))});
  }
  Message place = trainer.place(0);
  int checked = 0;
  for (int round = 0; round < 40; ++round) {
    const ShareResult result = read_result(elsewhere.spec(), 0, share.run(trainer.order(), place));
    place = result.place;
    if (round < 10) continue;  // until all have begun under this order
    for (const Episode& episode : result.episodes) {
      EXPECT_EQ(episode.succeeded, episode.terminated);
      for (int t = 0; t < episode.length; ++t) {
        const auto at = static_cast<std::size_t>(3 * t);
        std::vector<float> action(3);
        trainer.predict(std::span(episode.observation).subspan(2 * at, 6),
                        std::span(episode.achieved_goal).subspan(at, 3), episode.desired_goal, false, action);
        for (std::size_t k = 0; k < 3; ++k) {
          EXPECT_NEAR(episode.action[at + k], action[k], 1e-6f);
          // The environment's own law.
          const float position = episode.observation[2 * at + k],
                      velocity = 0.04f * episode.observation[2 * at + 3 + k];
          const float step = velocity + 0.5f * (0.05f * episode.action[at + k] - velocity);
          EXPECT_NEAR(episode.observation[2 * at + 6 + k], position + step, 1e-5f);
          EXPECT_EQ(episode.achieved_goal[at + k], position);
        }
        const bool reached = episode.terminated && t + 1 == episode.length;
        EXPECT_EQ(episode.reward[static_cast<std::size_t>(t)], reached ? 0.0f : -1.0f);
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 500);
}

TEST(Share, WhatIsLostIsDoneAgainToTheBit) {
  Spread whole(guided_config()), unlucky(guided_config());
  whole.rounds(30);
  for (int round = 0; round < 30; ++round) {
    if (round % 3 == 0) unlucky.start(round % 2);  // lost before it did anything
    if (round % 7 == 6) {
      (void)unlucky.run();  // all is lost on the way
      unlucky.start(0);
      unlucky.start(1);
    }
    unlucky.rounds(1);
  }
  EXPECT_GT(whole.trainer.metrics().gradient_steps, 100);
  EXPECT_GT(whole.trainer.metrics().evaluations, 3);
  expect_same(whole.trainer, unlucky.trainer);
}

TEST(Share, ContinuesFromACheckpointToTheBit) {
  const auto path = std::filesystem::temp_directory_path() / ("manyhands_share_" + std::to_string(::getpid()));
  Spread whole(guided_config()), resumed(guided_config());
  whole.rounds(20);
  whole.trainer.save(path);
  whole.rounds(20);
  resumed.rounds(3);
  EXPECT_TRUE(resumed.trainer.load(path));
  resumed.start(0);
  resumed.start(1);
  resumed.rounds(20);
  expect_same(whole.trainer, resumed.trainer);

  PointReach envs(1);
  PointExpert expert;
  Trainer alone(envs, nullptr, guided_config(), &expert);
  try {
    (void)alone.load(path);
    ADD_FAILURE() << "its worlds are here";
  } catch (const CheckpointError& error) {
    EXPECT_NE(std::string(error.what()).find("number of shares"), std::string::npos) << error.what();
  }
  std::filesystem::remove(path);
}

TEST(Share, LearnsAsWorldsHereDo) {
  TrainerConfig config = small_config({64, 64}, 2000, 100'000);
  config.updates_per_iteration = 8;
  PointReach envs(1), evaluation(250), left(20), right(44);
  Trainer trainer(envs, &evaluation, config);
  trainer.spread({20, 44});
  Share one(left, nullptr, config, 0), other(right, nullptr, config, 20);
  for (int round = 0; round < 200 && !trainer.metrics().solved; ++round) {
    const std::vector<Message> results = {one.run(trainer.order(), trainer.place(0)),
                                          other.run(trainer.order(), trainer.place(1))};
    trainer.receive(results);
    trainer.learn();
  }
  EXPECT_TRUE(trainer.metrics().solved);
}

/// Of `count` worlds from `first` on, those in which the expert acts after the warm-up.
int led_worlds(int first, int count) {
  TrainerConfig config = small_config({8}, 1, 3000);
  config.expert_rate = 0.1;
  config.exploration_noise = 0;
  config.random_action_rate = 0;
  PointReach elsewhere(count);
  PointExpert expert;
  const InputNormaliser normaliser(6, 3, config.input_clip);
  const Actor actor(PolicyKind::kDeterministic, normaliser.dim(), 3, config);
  Collector collector(elsewhere, &expert, 0);
  Matrix<float> action = Matrix<float>::Zero(3, count);
  StateExploration(actor, config, first, count).choose(actor, collector, normaliser, 0, false, action);
  int led = 0;
  for (int w = 0; w < count; ++w) {
    led += action(0, w) == collector.advice()[static_cast<std::size_t>(3 * w)];
  }
  return led;
}

TEST(Share, OfAnExpertsWorldsTakesItsPart) {
  EXPECT_EQ(led_worlds(0, 40), 4);
  EXPECT_EQ(led_worlds(0, 20), 2);
  EXPECT_EQ(led_worlds(20, 20), 2);
  int led = 0;
  for (int world = 0; world < 40; ++world) led += led_worlds(world, 1);
  EXPECT_EQ(led, 4);
}

TEST(Share, RefusesWhatIsNotItsOwnAndTakesNothingOfIt) {
  Spread spread(guided_config());
  spread.rounds(15);
  const TrainMetrics before = spread.trainer.metrics();
  const Message order = spread.trainer.order();
  std::vector<Message> results = spread.run();
  const Message whole = results[1];
  for (std::size_t length = 0; length < whole.size(); length += 1 + whole.size() / 97) {
    results[1] = Message(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_THROW(spread.trainer.receive(results), CheckpointError) << length;
  }
  EXPECT_THROW(spread.trainer.receive(std::span(results).first(1)), std::invalid_argument);
  EXPECT_EQ(spread.trainer.metrics().episodes, before.episodes);
  EXPECT_EQ(spread.trainer.order(), order);

  Worker worker(guided_config(), 0, 6);
  EXPECT_THROW((void)worker.share.run({}, {}), CheckpointError);
  EXPECT_THROW((void)worker.share.run(order, std::span(order).first(40)), CheckpointError);
  EXPECT_THROW((void)worker.share.run(order, spread.trainer.place(1)), CheckpointError) << "of ten worlds";
  EXPECT_THROW(spread.trainer.advance(1), std::logic_error);
}

TEST(Share, IsNotForPpo) {
  PointReach envs(64);
  TrainerConfig config;
  config.algorithm = Algorithm::kPpo;
  Trainer trainer(envs, nullptr, config);
  EXPECT_THROW(trainer.spread({32, 32}), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands::learn
