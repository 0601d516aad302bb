// Learning from pictures: what is remembered, that it is the same on any threads and across checkpoints, and that it
// learns.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "manyhands/envs/make.h"
#include "manyhands/learn/picture_cloning.h"
#include "manyhands/learn/trainer.h"

namespace manyhands::learn {
namespace {

namespace fs = std::filesystem;

constexpr int kWorlds = 6;

std::vector<Eye> two_eyes(int size = 24) {
  Eye front{.camera = perspective_camera(size, size, 0.75)}, wrist{.camera = perspective_camera(size, size, 1.2)};
  front.camera.X_FC = look_at({0.75, -0.55, 0.5}, {-0.12, 0, 0.1});
  front.variation = {.position = 0.02, .light = 0.3, .colour = 0.1};
  wrist.camera.frame = "panda_grasptarget";
  wrist.camera.X_FC = look_at({0.07, 0, -0.1}, {0.03, 0, 0.1}, {1, 0, 0});
  return {front, wrist};
}

TrainerConfig small_pictures() {
  TrainerConfig config;
  config.algorithm = Algorithm::kDagger;
  config.cloning_weight = 1;
  config.cloning_filter = false;
  config.seed = 5;
  config.num_threads = 1;
  config.hidden_layers = {32};
  config.channels = {8, 8};
  config.shift = 1;
  config.batch_size = 32;
  config.warmup_transitions = 60;
  config.replay_capacity = 240;
  config.updates_per_iteration = 2;
  config.expert_rate = 0.3;
  config.evaluation_interval = 20;
  config.evaluation_episodes = 3;
  config.stop_streak = 0;
  return config;
}

/// Reach with an expert, and a trainer that sees it.
struct Seeing {
  explicit Seeing(const TrainerConfig& config, const std::vector<Eye>& eyes = two_eyes())
      : envs(make_env_batch("PandaReach-v3", kWorlds)),
        evaluation(make_env_batch("PandaReach-v3", 3)),
        expert(make_expert("PandaReach-v3")),
        trainer(*envs, evaluation.get(), config, expert.get(), eyes) {}

  std::unique_ptr<EnvBatch> envs, evaluation;
  std::unique_ptr<Expert> expert;
  Trainer trainer;
};

void expect_same(const Policy& a, const Policy& b) {
  EXPECT_EQ(a.mean, b.mean);
  ASSERT_EQ(a.eyes.size(), b.eyes.size());
  for (std::size_t eye = 0; eye < a.eyes.size(); ++eye) {
    for (std::size_t l = 0; l < a.eyes[eye].size(); ++l) EXPECT_EQ(a.eyes[eye][l].weight, b.eyes[eye][l].weight);
  }
  for (std::size_t l = 0; l < a.layers.size(); ++l) EXPECT_EQ(a.layers[l].weight, b.layers[l].weight);
}

class Memory : public testing::Test {
 protected:
  std::vector<std::uint8_t> picture(int world, int eye) {
    std::vector<std::uint8_t> both(2 * sight_.picture_size());
    sight_.take(std::vector{sight_.view(world)}, both);
    const auto begin =
        both.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(eye) * sight_.picture_size());
    return {begin, begin + static_cast<std::ptrdiff_t>(sight_.picture_size())};
  }
  std::vector<std::uint8_t> copied(const std::uint8_t* from) const { return {from, from + sight_.picture_size()}; }

  std::unique_ptr<EnvBatch> envs_ = make_env_batch("PandaPush-v3", 2);
  Sight sight_{*envs_, two_eyes(), 1};
  std::vector<float> action_ = {1, 0, 0, 0, 1, 0};
};

TEST_F(Memory, StacksEndWithTheirOwnEpisode) {
  PictureMemory memory(sight_, 2, 5, 3, 1);
  envs_->reset({}, std::vector<std::uint64_t>{1, 2});
  std::vector<std::vector<std::uint8_t>> seen;  // by world 1's second eye
  // World 1 starts anew at moment 4; by moment 8 the ring of 5 has lost the first ones.
  for (int t = 0; t < 9; ++t) {
    if (t == 4) envs_->reset(std::vector<std::uint8_t>{0, 1});
    seen.push_back(picture(1, 1));
    memory.add(std::vector<int>{t, t < 4 ? t : t - 4}, std::vector<float>{0.0f, static_cast<float>(t)});
    const int newest = memory.size() - 1;
    EXPECT_EQ(memory.numbers(newest)[0], static_cast<float>(t));
    const Stack stack = memory.stack(newest, 1);
    ASSERT_EQ(stack.size(), 3U);
    for (int back = 0; back < 3; ++back) {
      const int wanted = std::max(t - back, t < 4 ? 0 : 4);
      EXPECT_EQ(copied(stack[static_cast<std::size_t>(back)]), seen[static_cast<std::size_t>(wanted)])
          << t << " " << back;
    }
    envs_->step(action_);
  }
  EXPECT_EQ(memory.size(), 2 * 3);  // of five moments the oldest two are in stacks alone
  EXPECT_EQ(memory.numbers(1)[0], 6.0f);
  EXPECT_NE(seen[0], seen[3]);
}

TEST_F(Memory, TakesPicturesAgainFromAFile) {
  const fs::path path = fs::temp_directory_path() / ("manyhands_memory_" + std::to_string(::getpid()));
  PictureMemory memory(sight_, 2, 5, 2, 1), copy(sight_, 2, 5, 2, 1);
  envs_->reset({}, std::vector<std::uint64_t>{3, 4});
  for (int t = 0; t < 8; ++t) {
    memory.add(std::vector<int>{t, t}, std::vector<float>{0.5f, static_cast<float>(t)});
    envs_->step(action_);
  }
  ArchiveWriter out;
  memory.save(out);
  out.commit(path);
  ArchiveReader in(path);
  copy.load(in);
  in.finish();
  EXPECT_LT(fs::file_size(path), 20'000U);  // no pictures in it
  ASSERT_EQ(copy.size(), memory.size());
  for (int i = 0; i < copy.size(); ++i) {
    EXPECT_EQ(copy.numbers(i)[0], memory.numbers(i)[0]);
    for (int eye = 0; eye < 2; ++eye) {
      const Stack found = copy.stack(i, eye), wanted = memory.stack(i, eye);
      for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(copied(found[k]), copied(wanted[k]));
    }
  }
  fs::remove(path);
}

TEST(PictureCloning, IsTheSameOnAnyNumberOfThreads) {
  TrainerConfig config = small_pictures();
  Seeing one(config);
  config.num_threads = 2;
  Seeing two(config);
  one.trainer.advance(45);
  const TrainMetrics metrics = two.trainer.advance(45);
  expect_same(one.trainer.policy(), two.trainer.policy());
  EXPECT_EQ(one.trainer.metrics().evaluation_success_rate, metrics.evaluation_success_rate);
  EXPECT_GT(metrics.gradient_steps, 50);
  EXPECT_EQ(metrics.evaluations, 2);
}

TEST(PictureCloning, GoesOnFromACheckpointToTheBit) {
  const fs::path path = fs::temp_directory_path() / ("manyhands_pictures_" + std::to_string(::getpid()));
  Seeing whole(small_pictures()), first(small_pictures()), second(small_pictures());
  whole.trainer.advance(90);  // of which the replay holds 40
  first.trainer.advance(53);
  first.trainer.save(path);
  EXPECT_TRUE(second.trainer.load(path));
  second.trainer.advance(37);
  expect_same(whole.trainer.policy(), second.trainer.policy());
  EXPECT_EQ(whole.trainer.metrics().episodes, second.trainer.metrics().episodes);
  EXPECT_EQ(whole.envs->state_hash(), second.envs->state_hash());

  TrainerConfig other = small_pictures();
  other.frame_stack = 3;
  Seeing different(other);
  EXPECT_THROW(different.trainer.load(path), CheckpointError);
  fs::remove(path);
}

TEST(PictureCloning, LearnsToReach) {
  TrainerConfig config = small_pictures();
  config.num_threads = 2;
  config.updates_per_iteration = 10;
  config.actor_learning_rate = 2e-3f;
  config.target_rate = 0.02f;
  config.batch_size = 64;
  config.warmup_transitions = 600;
  config.replay_capacity = 3000;
  config.evaluation_interval = 1000;
  Seeing reach(config, two_eyes(36));
  const double before = reach.trainer.evaluate(*reach.evaluation, 24, 1).success_rate;
  const double first = reach.trainer.advance(110).critic_loss;
  const double last = reach.trainer.advance(90).critic_loss;
  EXPECT_LT(last, 0.75 * first);
  EXPECT_GT(reach.trainer.evaluate(*reach.evaluation, 24, 1).success_rate, before + 0.2);
}

TEST(PictureCloning, SaysWhatItCannotSee) {
  const auto complaint = [](const TrainerConfig& config, const std::vector<Eye>& eyes) {
    try {
      Seeing refused(config, eyes);
    } catch (const std::invalid_argument& reason) {
      return std::string(reason.what());
    }
    return std::string("none");
  };
  EXPECT_NE(complaint(TrainerConfig{}, two_eyes()).find("only DAgger"), std::string::npos);
  EXPECT_NE(complaint(small_pictures(), two_eyes(8)).find("too small"), std::string::npos);
  std::vector<Eye> unequal = two_eyes();
  unequal[1].camera = perspective_camera(30, 30, 1);
  EXPECT_NE(complaint(small_pictures(), unequal).find("differ in width"), std::string::npos);
  TrainerConfig config = small_pictures();
  config.frame_stack = 0;
  EXPECT_NE(complaint(config, two_eyes()).find("frame_stack is 0"), std::string::npos);
  Seeing fine(small_pictures());
  std::vector<float> action(3);
  EXPECT_THROW(fine.trainer.predict(std::vector<float>(6), std::vector<float>(3), std::vector<float>(3), false, action),
               std::logic_error);
}

}  // namespace
}  // namespace manyhands::learn
