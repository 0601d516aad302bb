// A network that sees acts in worlds, from what a memory holds of them.
#pragma once

#include <array>

#include "manyhands/learn/halves.h"
#include "manyhands/learn/normaliser.h"
#include "manyhands/learn/picture_memory.h"
#include "manyhands/learn/picture_net.h"

namespace manyhands::learn {

/// Numbers of a memory's row: observation, achieved goal, desired goal, and what else is kept with them.
struct StateRow {
  int observation_dim{}, goal_dim{}, extra{};

  [[nodiscard]] int size() const { return observation_dim + 2 * goal_dim + extra; }
  /// Writes the normalised state (normaliser.dim()).
  void write(const InputNormaliser& normaliser, const float* row, float* z) const;
  /// The rows (worlds, size()) of a batch as it is now; what is extra is left alone.
  void fill(const EnvBatch& envs, std::vector<float>& rows) const;
};

/// One part of a mini-batch, and the normalised state of its samples (dim, batch).
struct PictureBatch {
  PictureTape<float> tape;
  Matrix<float> z;

  /// Makes a row of the memory the sample. The network is given the first `own` numbers of the state.
  void set(Eigen::Index sample, const PictureMemory& memory, int row, const StateRow& layout, int own,
           const InputNormaliser& normaliser);
};

class PictureActor {
 public:
  /// `net` is borrowed. The first `own` numbers of a normalised state of `z_dim` are given to it.
  PictureActor(const PictureNet<float>& net, const StateRow& layout, int own, int z_dim, int worlds, int num_threads);

  /// Fills `action` (action_dim, worlds) for the last moment in memory, only where `running` if that is given.
  void act(const PictureMemory& memory, const InputNormaliser& normaliser, std::span<const std::uint8_t> running,
           Matrix<float>& action);

 private:
  const PictureNet<float>& net_;
  StateRow layout_;
  int own_, worlds_;
  std::array<PictureBatch, 2> halves_;
  Halves threads_;
};

}  // namespace manyhands::learn
