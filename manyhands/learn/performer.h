// Acting by what has been learned, without exploration.
#pragma once

#include <cstdint>
#include <span>

#include "manyhands/envs/env_batch.h"
#include "manyhands/learn/actor.h"
#include "manyhands/learn/normaliser.h"

namespace manyhands::learn {

/// Acts in the worlds of a batch.
class Performer {
 public:
  virtual ~Performer() = default;

  /// Fills `action` (action_dim, worlds) where `running` (worlds) is not 0, in episodes that began `step` steps ago.
  virtual void act(int step, std::span<const std::uint8_t> running, Matrix<float>& action) = 0;
};

/// By the states of the worlds. Borrows all it is given.
class StatePerformer final : public Performer {
 public:
  StatePerformer(const EnvBatch& envs, const InputNormaliser& normaliser, const Actor& actor);

  void act(int step, std::span<const std::uint8_t> running, Matrix<float>& action) override;

 private:
  const EnvBatch& envs_;
  const InputNormaliser& normaliser_;
  const Actor& actor_;
  MlpTape<float> tape_;
};

/// Writes the network's input for the present state of every world into the columns of `state`.
void write_states(const EnvBatch& envs, const InputNormaliser& normaliser, Matrix<float>& state);

}  // namespace manyhands::learn
