// Pictures as networks take them: of several cameras in many worlds, colours alone.
#pragma once

#include "manyhands/envs/pictures.h"

namespace manyhands {

/// A camera through which a policy sees, and what differs in its pictures from episode to episode.
struct Eye {
  Camera camera{};
  Look look{};
  PictureVariation variation{};
};

class Sight {  ///< takes the pictures of environments
 public:
  /// `envs` is borrowed. Threads as in Renderer. Throws std::invalid_argument without eyes, or unless their pictures
  /// are of one size, std::logic_error where there is nothing to see.
  Sight(const EnvBatch& envs, std::vector<Eye> eyes, int num_threads = 0);

  [[nodiscard]] int num_eyes() const { return static_cast<int>(eyes_.size()); }
  [[nodiscard]] int width() const { return eyes_.front().camera.width; }
  [[nodiscard]] int height() const { return eyes_.front().camera.height; }
  /// Bytes of one picture.
  [[nodiscard]] std::size_t picture_size() const;

  [[nodiscard]] SeenWorld view(int world) const { return pictures_.view(world); }
  /// Writes (views, eyes, height, width, 3) red, green, blue. Throws std::invalid_argument on another length.
  void take(std::span<const SeenWorld> views, std::span<std::uint8_t> colours);

 private:
  std::vector<Eye> eyes_;
  EnvPictures pictures_;
};

}  // namespace manyhands
