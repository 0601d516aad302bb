// How a scene is lit, and what is behind it.
#pragma once

#include <array>

#include "manyhands/math/vec3.h"

namespace manyhands {

using Colour = std::array<float, 3>;  ///< red, green, blue as screens take them (sRGB), 0 to 1

struct Look {
  Vec3<double> light{0.35, -0.45, 0.82};  ///< towards the sun, in the world; of any length above 0
  float sun = 0.72f;                      ///< brightness of what faces it
  float ambient = 0.42f;                  ///< brightness without it, from the whole sky
  bool shadows = true;
  int shadow_rays = 1;     ///< of a pixel; more than 1: soft shadows, of a sun that is `sun_size` wide
  double sun_size = 0.08;  ///< [rad], from its centre to its rim
  int antialiasing = 1;    ///< n: n x n samples where a pixel differs from its neighbours
  Colour horizon{0.86f, 0.89f, 0.92f}, zenith{0.46f, 0.58f, 0.72f};
};

/// The linear light of a number as screens take it (sRGB, IEC 61966-2-1).
[[nodiscard]] float linear_light(float srgb);

/// Throws std::invalid_argument unless every number is in its range.
void require_look(const Look& look);

}  // namespace manyhands
