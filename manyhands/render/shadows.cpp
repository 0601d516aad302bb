#include "manyhands/render/shadows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "manyhands/render/ray_shapes.h"
#include "manyhands/render/sample_rays.h"

namespace manyhands {

namespace {

using Vec = Vec3<Rays>;
using Masks = std::array<RayMask, Samples::kPackets>;

constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr Rectangle kNowhere{kInfinite, -kInfinite, kInfinite, -kInfinite};
constexpr float kFarthest = 1e4f;   // casts a shadow [m]
constexpr float kSquare = 1.5f;     // largest side of a square of a sun's grid, in pixels
constexpr float kSoftSquare = 2;    // likewise, of one of many suns
constexpr int kLeastSquares = 256;  // a grid may have so many along a side, and more for large pictures
constexpr float kOff = 1;           // in squares: so far off the surface a grid is asked
constexpr float kNearest = 0.02f;   // what is nearer to the camera does not count [m]

float power_of_two_below(float a) { return std::ldexp(1.0f, std::ilogb(a)); }

bool casts_by_grid(const PlacedItem& placed) { return placed.item->triangles != nullptr; }

/// Side of the squares: by the pixels of what is nearest, but for few enough of them. Powers of two, so that it is the
/// same from picture to picture.
float texel_of(const PictureFrame& frame) {
  const Camera& camera = frame.camera;
  const Rectangle picture{0, static_cast<float>(camera.width), 0, static_cast<float>(camera.height)};
  Rectangle casts = kNowhere;
  float nearest = kInfinite;
  for (const PlacedItem& placed : frame.solid) {
    if (placed.item->type != ShapeType::kPlane && placed.view.meets(picture)) nearest = min(nearest, placed.nearest);
    if (casts_by_grid(placed)) casts = united(casts, placed.shade);
  }
  nearest = nearest < kInfinite ? max(nearest, kNearest) : 1;
  const float focal = static_cast<float>(max(camera.fx, camera.fy));
  const float pixel = (camera.orthographic ? 1 : nearest) / focal;
  const int most = std::max(kLeastSquares, 2 * std::max(camera.width, camera.height));
  const float least = max(casts.right - casts.left, casts.bottom - casts.top) / static_cast<float>(most);
  const float wanted = (frame.look.shadow_rays > 1 ? kSoftSquare : kSquare) * pixel;
  return max(power_of_two_below(wanted), 2 * power_of_two_below(max(least, 1e-9f)));
}

/// An item as a point of the sun sees it.
View view_of(const PictureFrame& frame, const PlacedItem& placed, const SunPoint& sun) {
  const Mat3<float>& R = placed.X_WI.R;
  const Vec3<float>& p = placed.X_WI.p;
  const Vec3<float> ahead = -frame.light.z;
  return {.across = transpose_times(R, sun.across),
          .down = transpose_times(R, sun.down),
          .ahead = transpose_times(R, ahead),
          .at = {dot(sun.across, p), dot(sun.down, p), dot(ahead, p)},
          .is_parallel = true,
          .near = -kInfinite,
          .eye = transpose_times(R, -sun.towards)};
}

/// Makes the rectangle so large that the item's box is in it.
void widen_by(Rectangle& covered, const Item& item, const View& view) {
  for (int k = 0; k < 8; ++k) {
    const Vec3<float> p{k & 1 ? item.high.x : item.low.x, k & 2 ? item.high.y : item.low.y,
                        k & 4 ? item.high.z : item.low.z};
    const float x = dot(view.across, p) + view.at.x, y = dot(view.down, p) + view.at.y;
    covered = united(covered, {x, x, y, y});
  }
}

/// Lanes from which the way along `direction` (world) is blocked by a simple shape.
MANYHANDS_INLINE RayMask blocked(const PlacedItem& placed, RayMask open, const Vec& p, const Vec3<float>& direction,
                                 RayInts seen) {
  const Item& item = *placed.item;
  const Vec o = transpose_times(broadcast<Rays>(placed.X_WI.R), p - broadcast<Rays>(placed.X_WI.p));
  const Vec d = broadcast<Rays>(transpose_times(placed.X_WI.R, direction));
  const Entry<Rays> entry = enter_shape(item.type, item.size, o, d);
  // A convex shape casts no shadow on what faces the light of it.
  return open & (entry.t > Rays(0.0f)) & (entry.t < Rays(kFarthest)) & RayMask(seen != placed.first_seen);
}

/// Lanes whose points lie below what a point of the sun shines on.
MANYHANDS_INLINE RayMask below(const SunPoint& sun, const Vec3<float>& up, RayMask open, const Vec& p) {
  const GridPart& part = sun.nearest.part();
  const Rays column = floor(dot(broadcast<Rays>(sun.across), p)) - Rays(static_cast<float>(part.left));
  const Rays row = floor(dot(broadcast<Rays>(sun.down), p)) - Rays(static_cast<float>(part.top));
  const Rays zero(0.0f), width(static_cast<float>(part.width)), height(static_cast<float>(part.height));
  const RayMask here = open & (column >= zero) & (row >= zero) & (column < width) & (row < height);
  if (none(here)) return here;
  const RayInts i = whole(select(here, column, zero)) + part.left, j = whole(select(here, row, zero)) + part.top;
  return here & (sun.nearest.nearness(i, j) > dot(broadcast<Rays>(up), p));
}

/// Closes the lanes of `open` from which the way to a point of the sun, which leans by `spread` at most, is blocked.
void cast(const PictureFrame& frame, const Samples& s, const SunPoint& sun, float spread, const Lit& lit, Masks& open) {
  for (const PlacedItem& placed : frame.solid) {
    if (casts_by_grid(placed)) continue;
    const float above = placed.height - lit.part.lowest;
    if (above < 0 || !widened(placed.shade, spread * above).meets(lit.part.across)) continue;
    for (std::size_t k = 0; k < size(s.packets); ++k) {
      when(open[k], [&] { open[k] = open[k] & !blocked(placed, open[k], lit.from[k], sun.towards, s.seen[k]); });
    }
  }
  if (sun.nearest.is_empty()) return;
  for (std::size_t k = 0; k < size(s.packets); ++k) {
    when(open[k], [&] {
      const Vec p = fma(Rays(kOff * frame.texel), s.n[k], lit.from[k]);
      open[k] = open[k] & !below(sun, frame.light.z, open[k], p);
    });
  }
}

/// Whether all lanes of the mask have the same number.
bool agree(RayMask mask, Rays a, Rays number) { return none(mask & (a != number)); }

/// A pixel's rays go to n points of the sun; its samples share them. Where the first few of a packet agree, from the
/// sun's rim inwards, all would.
void cast_soft(const PictureFrame& frame, const Samples& s, Lit& lit) {
  constexpr int kFew = 3;
  const int n = static_cast<int>(frame.suns.size()), sharing = std::min(s.per_pixel, n);
  const float rim = static_cast<float>(std::tan(frame.look.sun_size));
  std::array<int, Samples::kPackets> rays{};
  std::array<bool, Samples::kPackets> settled{};
  for (int i = n - 1; i >= 0; --i) {
    Masks open;
    bool wanted = false;
    for (std::size_t k = 0; k < size(s.packets); ++k) {
      const bool own = !settled[k] && i % sharing == s.number[k] % sharing;
      open[k] = own ? lit.mask[k] : RayMask(false);
      rays[k] += own ? 1 : 0;
      wanted = wanted || own;
    }
    if (!wanted) continue;
    cast(frame, s, frame.suns[size(i)], rim, lit, open);
    for (std::size_t k = 0; k < size(s.packets); ++k) {
      const Rays count(static_cast<float>(rays[k]));
      lit.share[k] = select(open[k], lit.share[k] + Rays(1.0f), lit.share[k]);
      settled[k] = settled[k] || (rays[k] == kFew && (agree(lit.mask[k], lit.share[k], Rays(0.0f)) ||
                                                      agree(lit.mask[k], lit.share[k], count)));
    }
  }
  for (std::size_t k = 0; k < size(s.packets); ++k)
    lit.share[k] = lit.share[k] * Rays(1.0f / static_cast<float>(std::max(rays[k], 1)));
}

}  // namespace

void set_suns(PictureFrame& frame) {
  frame.texel = 0;
  frame.suns.resize(frame.look.shadows ? size(frame.look.shadow_rays) : 0);
  if (frame.suns.empty()) return;
  frame.texel = texel_of(frame);
  for (PlacedItem& placed : frame.solid) {
    // No finer than what is shown, or than the grid can tell.
    if (!casts_by_grid(placed)) continue;
    placed.casts = &placed.item->triangles->casting_within(max(placed.error, frame.texel));
  }
  const auto& [x, y, z] = frame.light;
  const int n = frame.look.shadow_rays;
  const float rim = n > 1 ? static_cast<float>(std::tan(frame.look.sun_size)) : 0, rate = 1 / frame.texel;
  for (int i = 0; i < n; ++i) {  // spread evenly over the sun (Vogel's spiral)
    const float r = rim * std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(n));
    const float angle = 2.39996323f * static_cast<float>(i), a = r * std::cos(angle), b = r * std::sin(angle);
    const Vec3<float> aim = fma(a, x, fma(b, y, z));
    SunPoint& sun = frame.suns[size(i)];
    sun.towards = (1 / norm(aim)) * aim;
    sun.across = rate * fma(-a, z, x);
    sun.down = -rate * fma(-b, z, y);
  }
}

void draw_sun(PictureFrame& frame, int i) {
  SunPoint& sun = frame.suns[size(i)];
  Rectangle covered = kNowhere;
  for (const PlacedItem& placed : frame.solid) {
    if (casts_by_grid(placed)) widen_by(covered, *placed.item, view_of(frame, placed, sun));
  }
  GridPart part;
  if (covered.left <= covered.right) {
    part.left = static_cast<int>(std::floor(covered.left)) - 1;
    part.top = static_cast<int>(std::floor(covered.top)) - 1;
    part.width = static_cast<int>(std::ceil(covered.right)) + 1 - part.left;
    part.height = static_cast<int>(std::ceil(covered.bottom)) + 1 - part.top;
  }
  sun.nearest.begin(part, false);
  for (const PlacedItem& placed : frame.solid) {
    if (casts_by_grid(placed)) sun.nearest.draw(*placed.casts, view_of(frame, placed, sun), 0);
  }
}

void cast_shadows(const PictureFrame& frame, const Samples& s, Lit& lit) {
  if (frame.suns.size() > 1) return cast_soft(frame, s, lit);
  Masks open = lit.mask;
  cast(frame, s, frame.suns[0], 0, lit, open);
  for (std::size_t k = 0; k < size(s.packets); ++k) lit.share[k] = select(open[k], Rays(1.0f), lit.share[k]);
}

}  // namespace manyhands
