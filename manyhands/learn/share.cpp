#include "manyhands/learn/share.h"

#include <algorithm>

#include "manyhands/learn/parameters.h"

namespace manyhands::learn {

namespace {

/// Shares draw from streams of their own.
TrainerConfig config_of_share(TrainerConfig config, int first) {
  config.validate();
  config.seed = derive_seed(config.seed, Purpose::kShareSeed, static_cast<std::uint64_t>(first));
  return config;
}

void write_episode(const EpisodeView& episode, bool succeeded, ArchiveWriter& out) {
  out.value(episode.length);
  out.value(episode.terminated);
  out.value(succeeded);
  for (const std::span<const float> rows : {episode.observation, episode.achieved_goal, episode.desired_goal,
                                            episode.action, episode.reward, episode.advice, episode.randomized}) {
    out.array(rows);
  }
}

Episode read_episode(const EnvSpec& spec, int advice_dim, ArchiveReader& in) {
  Episode episode;
  in.value(episode.length);
  in.check(episode.length > 0 && episode.length <= spec.max_episode_steps, "an episode has a wrong length");
  in.value(episode.terminated);
  in.value(episode.succeeded);
  const auto read = [&](std::vector<float>& to, int rows, int width) {
    to.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(width));
    in.array(std::span(to));
  };
  read(episode.observation, episode.length + 1, spec.observation_dim);
  read(episode.achieved_goal, episode.length + 1, spec.goal_dim);
  read(episode.desired_goal, 1, spec.goal_dim);
  read(episode.action, episode.length, spec.action_dim);
  read(episode.reward, episode.length, 1);
  read(episode.advice, episode.length, advice_dim);
  read(episode.randomized, 1, static_cast<int>(spec.randomized.size()));
  return episode;
}

}  // namespace

Message write_order(const Actor& actor, const InputNormaliser& normaliser, std::int64_t iteration, int steps,
                    bool warming_up) {
  ArchiveWriter out;
  out.array(floats(actor.net().parameters()));
  out.array(floats(actor.log_std()));
  normaliser.save(out);
  out.value(iteration);
  out.value(steps);
  out.value(warming_up);
  return std::move(out).take();
}

Share::Share(EnvBatch& envs, Expert* expert, const TrainerConfig& config, int first)
    : normaliser_(envs.spec().observation_dim, envs.spec().goal_dim, config.input_clip, config.relations()),
      actor_(policy_kind(config.algorithm, envs.spec().choices), normaliser_.dim(), envs.spec().action_dim,
             config_of_share(config, first)),
      collector_(envs, config.wants_expert() ? expert : nullptr, config_of_share(config, first).seed),
      exploration_(actor_, config_of_share(config, first), first, envs.num_envs()),
      action_(Matrix<float>::Zero(envs.spec().action_dim, envs.num_envs())) {}

Message Share::run(std::span<const std::byte> order, std::span<const std::byte> place) {
  ArchiveReader in(order, "a trainer's order");
  in.array(floats(actor_.net().parameters()));
  in.array(floats(actor_.log_std()));
  normaliser_.load(in);
  const auto begin = in.value<std::int64_t>();
  const int steps = in.value<int>();
  const bool warming_up = in.value<bool>();
  in.finish();
  go_to(place);

  ArchiveWriter episodes;
  int count = 0;
  for (int step = 0; step < steps; ++step) {
    exploration_.choose(actor_, collector_, normaliser_, begin + step, warming_up, action_);
    collector_.step(floats(action_));
    for (const int world : collector_.finished()) {
      write_episode(collector_.episode(world), collector_.succeeded(world), episodes);
      ++count;
    }
    collector_.restart_finished();
  }
  ArchiveWriter here;
  collector_.save(here);
  place_ = std::move(here).take();

  ArchiveWriter out;
  out.message(place_);
  out.value(count);
  Message result = std::move(out).take(), rest = std::move(episodes).take();
  result.insert(result.end(), rest.begin(), rest.end());
  return result;
}

/// Plays the running episodes of `place` again, unless the worlds are there.
void Share::go_to(std::span<const std::byte> place) {
  if (std::ranges::equal(place, place_)) return;
  ArchiveReader in(place, "the place of a share of the worlds");
  const Collector::Running running = collector_.read(in);
  in.finish();
  (void)collector_.restore(running);
  place_.assign(place.begin(), place.end());
}

EpisodeView Episode::view() const {
  return {.length = length,
          .terminated = terminated,
          .observation = observation,
          .achieved_goal = achieved_goal,
          .desired_goal = desired_goal,
          .action = action,
          .reward = reward,
          .advice = advice,
          .randomized = randomized};
}

ShareResult read_result(const EnvSpec& spec, int advice_dim, std::span<const std::byte> message) {
  ArchiveReader in(message, "the episodes of a share of the worlds");
  ShareResult result;
  result.place = in.message();
  for (int left = in.value<int>(); left > 0; --left) result.episodes.push_back(read_episode(spec, advice_dim, in));
  in.finish();
  return result;
}

}  // namespace manyhands::learn
