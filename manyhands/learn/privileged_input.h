// What critics see and the policy does not: what the environment has drawn for the episode.
//
// Pinto et al., "Asymmetric actor critic for image-based robot learning", 2018.
#pragma once

#include "manyhands/envs/env_batch.h"
#include "manyhands/learn/archive.h"
#include "manyhands/learn/mlp.h"
#include "manyhands/learn/normaliser.h"
#include "manyhands/learn/trainer_config.h"

namespace manyhands::learn {

/// `EnvBatch::randomized` in units of its running standard deviation: further rows of a critic's input, below those
/// that the policy sees. None unless the config asks for them.
class PrivilegedInput {
 public:
  /// Throws std::invalid_argument if there is nothing to see.
  PrivilegedInput(const EnvSpec& spec, const TrainerConfig& config);

  [[nodiscard]] int dim() const { return normaliser_.dim(); }

  /// Adds what an episode had, values (dim()), to the statistics; they change at the next `refresh`.
  void add(std::span<const float> values);
  void refresh() { normaliser_.refresh(); }

  /// Writes what critics see of values (dim()).
  void write(const float* values, float* z) const { normaliser_.write(values, nullptr, nullptr, z); }
  /// The same of what every world has, into the last rows of the columns of `state`.
  void write_below(const EnvBatch& envs, Matrix<float>& state) const;

  void save(ArchiveWriter& out) const;
  void load(ArchiveReader& in);

 private:
  InputNormaliser normaliser_;
};

}  // namespace manyhands::learn
