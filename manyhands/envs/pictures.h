// Pictures of environments.
#pragma once

#include "manyhands/envs/env_batch.h"
#include "manyhands/render/renderer.h"

namespace manyhands {

/// Shows the worlds of a batch, their goals drawn over them as see-through copies of what is to come there.
class EnvPictures {
 public:
  /// `envs` is borrowed. Threads as in Renderer. Throws std::logic_error where there is nothing to see.
  explicit EnvPictures(const EnvBatch& envs, int num_threads = 0);

  [[nodiscard]] const EnvBatch& envs() const { return envs_; }
  [[nodiscard]] Renderer& renderer() { return renderer_; }
  [[nodiscard]] const Model& model() const { return renderer_.scene().model(); }
  /// The world as it is now. Throws std::out_of_range on worlds that are not there.
  [[nodiscard]] Shot shot(int world, const Camera& camera, const Look& look) const;

 private:
  explicit EnvPictures(const EnvBatch& envs, EnvScene scene, int num_threads);
  [[nodiscard]] std::vector<Mark> goal_marks(std::span<const float> goal, std::span<const Vec3<double>> sizes) const;

  const EnvBatch& envs_;
  std::vector<GeomId> objects_;
  std::vector<Pattern> patterns_;  // (geoms)
  Renderer renderer_;
};

}  // namespace manyhands
