// What tests of the trainer have in common: networks and batches that learn in a second.
#pragma once

#include <utility>
#include <vector>

#include "manyhands/learn/trainer_config.h"

namespace manyhands::learn {

inline TrainerConfig small_config(std::vector<int> hidden_layers, int warmup_transitions, int replay_capacity) {
  TrainerConfig config;
  config.seed = 7;
  config.hidden_layers = std::move(hidden_layers);
  config.batch_size = 64;
  config.warmup_transitions = warmup_transitions;
  config.replay_capacity = replay_capacity;
  config.updates_per_iteration = 2;
  return config;
}

}  // namespace manyhands::learn
