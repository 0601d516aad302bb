// Pictures of environments.
#pragma once

#include "manyhands/envs/env_batch.h"
#include "manyhands/math/philox.h"
#include "manyhands/render/renderer.h"

namespace manyhands {

/// How pictures differ from episode to episode: most numbers are the most that something is off, either way.
struct PictureVariation {
  double position = 0;    ///< of the camera, along each axis of its frame [m]
  double direction = 0;   ///< of its view, about each of its axes [rad]
  double zoom = 0;        ///< of its focal lengths, as a share
  double light = 0;       ///< of the direction to the sun, along each axis of a unit vector
  double brightness = 0;  ///< of sun and sky, as a share
  double colour = 0;      ///< of each geom's red, green and blue
  double texture = 0;     ///< chance that floor, table, an obstacle or an object shows one in place of its colour
  std::vector<Texture> textures{};  ///< to choose from; none: `assorted_images`, repeated up to four times

  [[nodiscard]] bool operator==(const PictureVariation&) const = default;
};

/// What is seen of a world at one time.
struct SeenWorld {
  std::vector<double> q{};            ///< (nq) of the scene's model
  std::vector<Vec3<double>> sizes{};  ///< (objects), see Shape [m]
  std::vector<float> goal{};          ///< (goal_dim)
};

/// Shows the worlds of a batch, their goals drawn over them as see-through copies of what is to come there.
class EnvPictures {
 public:
  /// `envs` is borrowed. Threads as in Renderer. Throws std::logic_error where there is nothing to see.
  explicit EnvPictures(const EnvBatch& envs, int num_threads = 0);

  [[nodiscard]] const EnvBatch& envs() const { return envs_; }
  [[nodiscard]] Renderer& renderer() { return renderer_; }
  [[nodiscard]] const Model& model() const { return renderer_.scene().model(); }
  /// A world as it is now. Throws std::out_of_range on worlds that are not there.
  [[nodiscard]] SeenWorld view(int world) const;
  /// What varies is drawn from the bits of the episode's goal: the same in every picture of an episode, and wherever
  /// that episode is played again. `camera_number` tells cameras apart that see the same episode.
  [[nodiscard]] Shot shot(const SeenWorld& view, const Camera& camera, const Look& look,
                          const PictureVariation& variation = {}, std::uint32_t camera_number = 0) const;

 private:
  explicit EnvPictures(const EnvBatch& envs, EnvScene scene, int num_threads);
  void vary(Shot& shot, const PictureVariation& variation, RandomStream random) const;
  void vary_colours(Shot& shot, double most, RandomStream& random) const;
  void vary_textures(Shot& shot, const PictureVariation& variation, RandomStream& random) const;
  [[nodiscard]] std::vector<Mark> goal_marks(std::span<const float> goal, std::span<const Vec3<double>> sizes) const;

  const EnvBatch& envs_;
  std::vector<GeomId> objects_;
  std::vector<Pattern> patterns_;    // (geoms)
  std::vector<bool> takes_texture_;  // (geoms)
  Renderer renderer_;
};

}  // namespace manyhands
