// Where on a texture's image the points of a surface lie. Internal to the renderer.
#pragma once

#include <cmath>
#include <numbers>

#include "manyhands/math/functions.h"
#include "manyhands/model/description.h"
#include "manyhands/render/texture.h"

namespace manyhands {

/// A surface with a texture, in its own axes S.
struct TexturedSurface {
  int seen;  ///< its number in the palette of the frame
  ShapeType type;
  Vec3<float> low, high;  ///< of the box that holds it, in S [m]; not of planes
  Vec3<float> rate;       ///< 1 / (high - low) [1/m]
  Transform<float> X_WS;
  const Texture* texture;
};

/// A point on an image: from 0 at its left and upper edges to 1 at the others, and beyond where it is repeated.
struct ImagePoint {
  float u, v;
  float across, down;  ///< how many images come to a metre there
};

namespace internal {

/// Seen from the side towards which the normal points most; from above, x is to the right and y up.
inline ImagePoint on_box(const TexturedSurface& s, const Vec3<float>& p, const Vec3<float>& n) {
  const Vec3<float> part{(p.x - s.low.x) * s.rate.x, (p.y - s.low.y) * s.rate.y, (p.z - s.low.z) * s.rate.z};
  const auto seen_from = [](bool behind, float along) { return behind ? 1 - along : along; };
  const float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  if (z >= x && z >= y) return {seen_from(n.z < 0, part.x), 1 - part.y, s.rate.x, s.rate.y};
  if (x >= y) return {seen_from(n.x < 0, part.y), 1 - part.z, s.rate.y, s.rate.z};
  return {seen_from(n.y > 0, part.x), 1 - part.z, s.rate.x, s.rate.z};
}

/// Round the z axis, from 0 where x points.
inline ImagePoint around(const Vec3<float>& p, float v, float down) {
  constexpr float kTurn = 2 * std::numbers::pi_v<float>, kPole = 1e-4f;
  const float from_axis = std::sqrt(p.x * p.x + p.y * p.y);
  return {manyhands::atan2(p.y, p.x) / kTurn, v, 1 / (kTurn * max(from_axis, kPole)), down};
}

}  // namespace internal

/// p, n: a point of the surface and its unit normal, in S.
[[nodiscard]] inline ImagePoint image_point(const TexturedSurface& s, const Vec3<float>& p, const Vec3<float>& n) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const auto once = [&]() -> ImagePoint {
    switch (s.type) {
      case ShapeType::kPlane:
        return {p.x, -p.y, 1, 1};
      case ShapeType::kSphere: {
        const float from_axis = std::sqrt(p.x * p.x + p.y * p.y);
        return internal::around(p, manyhands::atan2(from_axis, p.z) / kPi, 2 / kPi * s.rate.z);
      }
      case ShapeType::kCylinder:
        if (std::abs(n.z) > 0.7f) return internal::on_box(s, p, n);
        [[fallthrough]];
      case ShapeType::kCapsule:
        return internal::around(p, (s.high.z - p.z) * s.rate.z, s.rate.z);
      default:
        return internal::on_box(s, p, n);
    }
  };
  const ImagePoint at = once();
  const auto& [across, down] = s.texture->repeat;
  return {across * at.u, down * at.v, across * at.across, down * at.down};
}

/// The mean linear light (red, green, blue, 0) of the texture over a pixel that is `width` wide across the view and
/// sees the surface along d (unit, in S): a longer stretch where it looks along the surface.
[[nodiscard]] inline Lanes4 texture_light(const TexturedSurface& s, const Vec3<float>& p, const Vec3<float>& n,
                                          const Vec3<float>& d, float width) {
  constexpr float kMost = 4;  // looks at the image
  const Image& image = *s.texture->image;
  const ImagePoint middle = image_point(s, p, n);
  const float per_metre =
      max(middle.across * static_cast<float>(image.width()), middle.down * static_cast<float>(image.height()));
  const float facing = max(std::abs(dot(n, d)), 0.02f), stretch = width / facing;
  const float looks = clamp(std::floor(stretch * per_metre / max(width * per_metre, 1.0f) + 0.5f), 1.0f, kMost);
  const float wide = max(width, stretch / looks) * per_metre;
  if (looks == 1) return image.mean_at(middle.u, middle.v, wide);
  const float share = 1 / looks, length = std::sqrt(1 - facing * facing);
  const Vec3<float> step = (share * stretch / length) * (d - dot(n, d) * n);
  Lanes4 sum(0.0f);
  for (int i = 0; i < static_cast<int>(looks); ++i) {
    const float offset = static_cast<float>(i) + 0.5f - 0.5f * looks;
    const ImagePoint at = image_point(s, fma(offset, step, p), n);
    sum += image.mean_at(at.u, at.v, wide);
  }
  return Lanes4(share) * sum;
}

}  // namespace manyhands
