#include "manyhands/envs/sight.h"

#include <algorithm>

namespace manyhands {

namespace {

std::vector<Eye> checked(std::vector<Eye> eyes) {
  if (eyes.empty()) throw std::invalid_argument("Sight: there is no camera, expected one or more");
  for (const Eye& eye : eyes) {
    if (eye.camera.width == eyes.front().camera.width && eye.camera.height == eyes.front().camera.height) continue;
    throw std::invalid_argument("Sight: cameras differ in width or height; give all the same");
  }
  return eyes;
}

}  // namespace

Sight::Sight(const EnvBatch& envs, std::vector<Eye> eyes, int num_threads)
    : eyes_(checked(std::move(eyes))), pictures_(envs, num_threads) {}

std::size_t Sight::picture_size() const {
  return 3 * static_cast<std::size_t>(width()) * static_cast<std::size_t>(height());
}

void Sight::take(std::span<const SeenWorld> views, std::span<std::uint8_t> colours) {
  std::vector<Shot> shots;
  shots.reserve(views.size() * eyes_.size());
  for (const SeenWorld& view : views) {
    for (std::uint32_t number = 0; number < eyes_.size(); ++number) {
      const Eye& eye = eyes_[number];
      shots.push_back(pictures_.shot(view, eye.camera, eye.look, eye.variation, number));
    }
  }
  pictures_.renderer().render(shots, {colours, {}, {}, {}});
}

}  // namespace manyhands
