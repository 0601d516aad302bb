// What the networks see: observation, desired goal and the way to the goal, scaled by running statistics.
#pragma once

#include <span>

#include "manyhands/learn/archive.h"
#include "manyhands/learn/mlp.h"
#include "manyhands/learn/relations.h"

namespace manyhands::learn {

/// Network input z = clip((x - mean) * scale, -clip, clip) of x = [observation, desired_goal, desired_goal -
/// achieved_goal, relations], with mean and 1/scale the mean and standard deviation of all x added so far; for
/// differences 0 and 2 cm, so that they tell apart what is near.
///
/// All of it is part of the exported policy.
class InputNormaliser {
 public:
  InputNormaliser() = default;
  /// `relations`: see TrainerConfig. Throws std::invalid_argument if they lie outside of an observation, or the goal is
  /// no rotation. `least_deviation`: below it what varies counts as noise, and is not blown up further.
  InputNormaliser(int observation_dim, int goal_dim, float clip, Relations relations = {},
                  double least_deviation = 1e-2);
  /// With statistics that are known: mean and scale (dim()).
  InputNormaliser(int observation_dim, int goal_dim, float clip, Relations relations, std::span<const float> mean,
                  std::span<const float> scale);

  [[nodiscard]] int dim() const { return static_cast<int>(mean_.size()); }

  /// Adds one sample to the statistics; `mean` and `scale` change at the next `refresh`.
  void add(const float* observation, const float* achieved_goal, const float* desired_goal);
  void refresh();

  /// Writes z (dim()) for one sample.
  void write(const float* observation, const float* achieved_goal, const float* desired_goal, float* z) const;

  [[nodiscard]] const Vector<float>& mean() const { return mean_; }
  [[nodiscard]] const Vector<float>& scale() const { return scale_; }
  [[nodiscard]] float clip() const { return clip_; }
  [[nodiscard]] const Relations& relations() const { return relations_; }

  void save(ArchiveWriter& out) const;
  void load(ArchiveReader& in);

 private:
  void write_raw(const float* observation, const float* achieved_goal, const float* desired_goal, float* x) const;

  int observation_dim_ = 0, goal_dim_ = 0;
  float clip_ = 5;
  double least_deviation_ = 1e-2;
  Relations relations_;
  double count_ = 0;
  Vector<double> running_mean_, sum_of_squares_;  // Welford, 1962
  Vector<float> mean_, scale_, raw_;
};

}  // namespace manyhands::learn
