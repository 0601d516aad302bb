#include "manyhands/render/look.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace manyhands {

float linear_light(float srgb) {
  const float c = clamp(srgb, 0.0f, 1.0f);
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

void require_look(const Look& look) {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw std::invalid_argument("look: " + what);
  };
  require(norm(look.light) > 1e-9 && is_finite(norm(look.light)), "the direction to the light has no length");
  require(look.sun >= 0 && look.ambient >= 0 && is_finite(look.sun + look.ambient),
          "sun and ambient are brightnesses of 0 or more");
  require(look.shadow_rays >= 1 && look.shadow_rays <= 256, "shadow_rays must be from 1 to 256");
  require(look.sun_size >= 0 && look.sun_size < 1, "sun_size must be from 0 to 1 rad");
  require(look.antialiasing >= 1 && look.antialiasing <= 8, "antialiasing must be from 1 to 8");
}

}  // namespace manyhands
