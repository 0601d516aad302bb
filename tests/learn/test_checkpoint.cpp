// A checkpoint continues to the bit, appears whole or not at all, and refuses what is not its own.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "manyhands/learn/trainer.h"
#include "tests/learn/point_reach.h"
#include "tests/learn/small_config.h"

namespace manyhands::learn {
namespace {

namespace fs = std::filesystem;

class Checkpoint : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("manyhands_checkpoint_" + std::to_string(::getpid()) + "_" +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
    path_ = folder_ / "trainer.ckpt";
  }
  void TearDown() override { fs::remove_all(folder_); }

  static TrainerConfig config() {
    // A small replay: the ring is full, and more than one episode old, at the checkpoint.
    TrainerConfig config = small_config({24, 16}, 300, 900);
    config.target_noise = 0.1f;
    config.num_critics = 2;
    config.policy_delay = 2;
    config.evaluation_interval = 7;
    config.stop_streak = 0;
    return config;
  }

  std::string bytes() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void write(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  std::size_t files_in_folder() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_, path_;
};

void expect_same(const Policy& a, const Policy& b) {
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.scale, b.scale);
  for (std::size_t l = 0; l < a.layers.size(); ++l) {
    EXPECT_EQ(a.layers[l].weight, b.layers[l].weight);
    EXPECT_EQ(a.layers[l].bias, b.layers[l].bias);
  }
}

std::string load_error(Trainer& trainer, const fs::path& path) {
  try {
    (void)trainer.load(path);
  } catch (const CheckpointError& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(Checkpoint, ContinuesToTheBit) {
  PointReach envs(16), evaluation(20);
  Trainer whole(envs, &evaluation, config());
  whole.advance(83);
  whole.save(path_);
  const TrainMetrics expected = whole.advance(59);

  PointReach other_envs(16), other_evaluation(20);
  TrainerConfig other = config();
  other.seed = 1234;  // the seed comes from the file
  Trainer resumed(other_envs, &other_evaluation, other);
  resumed.advance(5);
  EXPECT_TRUE(resumed.load(path_));
  EXPECT_EQ(resumed.metrics().iterations, 83);
  const TrainMetrics metrics = resumed.advance(59);

  EXPECT_EQ(metrics.iterations, expected.iterations);
  EXPECT_EQ(metrics.env_steps, expected.env_steps);
  EXPECT_EQ(metrics.gradient_steps, expected.gradient_steps);
  EXPECT_EQ(metrics.episodes, expected.episodes);
  EXPECT_EQ(metrics.evaluations, expected.evaluations);
  EXPECT_EQ(metrics.success_rate, expected.success_rate);
  EXPECT_EQ(metrics.evaluation_success_rate, expected.evaluation_success_rate);
  EXPECT_EQ(metrics.critic_loss, expected.critic_loss);
  EXPECT_EQ(metrics.policy_q_mean, expected.policy_q_mean);
  expect_same(resumed.policy(), whole.policy());
}

TEST_F(Checkpoint, StartsNewEpisodesWhereTheEnvironmentHasChanged) {
  PointReach envs(16);
  Trainer trainer(envs, nullptr, config());
  trainer.advance(83);
  trainer.save(path_);
  PointReach changed(16, 0.99);
  Trainer resumed(changed, nullptr, config());
  EXPECT_FALSE(resumed.load(path_));
  expect_same(resumed.policy(), trainer.policy());
  EXPECT_EQ(resumed.advance(20).iterations, 103);
}

TEST_F(Checkpoint, WithoutReplayIsSmallAndFillsItAgain) {
  PointReach envs(16);
  Trainer trainer(envs, nullptr, config());
  trainer.advance(83);
  trainer.save(path_);
  const auto with_replay = fs::file_size(path_);
  trainer.save(path_, false);
  EXPECT_LT(fs::file_size(path_), with_replay);
  const std::int64_t gradient_steps = trainer.metrics().gradient_steps;
  EXPECT_TRUE(trainer.load(path_));
  EXPECT_EQ(trainer.advance(1).gradient_steps, gradient_steps) << "warms up first";
  EXPECT_GT(trainer.advance(80).gradient_steps, gradient_steps);
}

TEST_F(Checkpoint, RefusesDamagedFilesAndStaysAsItWas) {
  PointReach envs(16);
  Trainer trainer(envs, nullptr, config());
  trainer.advance(60);
  trainer.save(path_);
  const std::string good = bytes();
  const Policy before = trainer.policy();

  for (const std::size_t length :
       {std::size_t{0}, std::size_t{5}, std::size_t{31}, std::size_t{32}, good.size() / 2, good.size() - 1}) {
    write(good.substr(0, length));
    EXPECT_NE(load_error(trainer, path_).find(path_.string()), std::string::npos) << length;
  }
  write(good + "x");
  EXPECT_NE(load_error(trainer, path_).find("bytes too many"), std::string::npos);
  for (std::size_t at = 0; at < good.size(); at += 1 + good.size() / 97) {
    std::string damaged = good;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    write(damaged);
    EXPECT_NE(load_error(trainer, path_), "no error") << "byte " << at;
  }
  fs::remove(path_);
  EXPECT_NE(load_error(trainer, path_).find("no such file"), std::string::npos);
  EXPECT_NE(load_error(trainer, folder_).find("no such file"), std::string::npos);
  expect_same(trainer.policy(), before);

  write(good);
  EXPECT_TRUE(trainer.load(path_));
}

TEST_F(Checkpoint, SaysWhatDiffers) {
  PointReach envs(16);
  const Trainer trainer(envs, nullptr, config());
  trainer.save(path_);
  const auto error_with = [&](int worlds, auto change) {
    PointReach other_envs(worlds);
    TrainerConfig other = config();
    change(other);
    Trainer trainer_with(other_envs, nullptr, other);
    return load_error(trainer_with, path_);
  };
  EXPECT_NE(error_with(8, [](TrainerConfig&) {}).find("its number of worlds is 16, this trainer's is 8"),
            std::string::npos);
  EXPECT_NE(error_with(16, [](TrainerConfig& c) { c.hidden_layers = {24, 17}; }).find("hidden layer size is 16"),
            std::string::npos);
  EXPECT_NE(error_with(16, [](TrainerConfig& c) { c.num_critics = 1; }).find("number of critics is 2"),
            std::string::npos);
  EXPECT_NE(error_with(16, [](TrainerConfig& c) { c.replay_capacity = 901; }).find("replay capacity is 900"),
            std::string::npos);
  EXPECT_EQ(error_with(16, [](TrainerConfig& c) { c.actor_learning_rate = 1e-4f; }), "no error");
}

TEST_F(Checkpoint, FailsToWriteCleanly) {
  PointReach envs(4);
  const Trainer trainer(envs, nullptr, config());
  EXPECT_THROW(trainer.save(folder_ / "missing" / "trainer.ckpt"), CheckpointError);
  fs::create_directories(path_ / "occupied");  // a folder that is not empty cannot be replaced by a file
  EXPECT_THROW(trainer.save(path_), CheckpointError);
  EXPECT_EQ(files_in_folder(), 1u) << "the draft is removed";
}

}  // namespace
}  // namespace manyhands::learn
