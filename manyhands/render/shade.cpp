#include <algorithm>
#include <array>
#include <cmath>

#include "manyhands/render/ray_shapes.h"
#include "manyhands/render/sample_rays.h"
#include "manyhands/render/samples.h"
#include "manyhands/render/shadows.h"
#include "manyhands/render/surface.h"

namespace manyhands {

namespace {

using Vec = Vec3<Rays>;

constexpr float kGloss = 0.10f;                    // brightness of highlights
constexpr float kCheck = 0.5f;                     // side of a square [m]
constexpr float kFadeFrom = 2.0f, kFadeTo = 7.0f;  // where floors fade into the horizon [m]

struct Light {
  Rays red, green, blue;
};

MANYHANDS_INLINE Light mix(Rays f, const Light& a, const Light& b) {
  return {fma(f, b.red - a.red, a.red), fma(f, b.green - a.green, a.green), fma(f, b.blue - a.blue, a.blue)};
}

MANYHANDS_INLINE Light scaled(Rays f, const Light& a) { return {f * a.red, f * a.green, f * a.blue}; }

MANYHANDS_INLINE Light select(RayMask m, const Light& a, const Light& b) {
  return {select(m, a.red, b.red), select(m, a.green, b.green), select(m, a.blue, b.blue)};
}

MANYHANDS_INLINE Light everywhere(const Paint& paint) { return {Rays(paint.red), Rays(paint.green), Rays(paint.blue)}; }

float least(Rays a) {
  float r = lane(a, 0);
  for (int k = 1; k < kRays; ++k) r = min(r, lane(a, k));
  return r;
}
float greatest(Rays a) { return -least(-a); }

/// 0 to 255 as screens take it. The curve of sRGB by three roots (Chilliant, sRGB Approximations for HLSL, 2012).
MANYHANDS_INLINE Rays encoded(Rays light) {
  const Rays x = clamp(light, Rays(0.0f), Rays(1.0f));
  const Rays a = sqrt(x), b = sqrt(a), c = sqrt(b);
  const Rays curve = fma(Rays(0.585122381f), a, fma(Rays(0.783140355f), b, Rays(-0.368262736f) * c));
  return clamp(Rays(255.0f) * curve, Rays(0.0f), Rays(255.0f));
}

// ---- colours ---------------------------------------------------------------------------------------------------

MANYHANDS_INLINE Rays fraction(Rays x) { return x - floor(x); }

/// The mean of a row of squares over a width of w squares, -1 to 1.
MANYHANDS_INLINE Rays stripes(Rays x, Rays w) {
  const Rays half(0.5f);
  const Rays a = abs(fraction(half * fma(-half, w, x)) - half), b = abs(fraction(half * fma(half, w, x)) - half);
  return Rays(2.0f) * (a - b) / w;
}

/// How wide a pixel is across the view at these depths [m].
MANYHANDS_INLINE Rays pixel_width(const Camera& camera, Rays depth) {
  const Rays one(static_cast<float>(1 / camera.fy));
  return camera.orthographic ? one : depth * one;
}

MANYHANDS_INLINE Light checks(const PictureFrame& frame, const PlacedItem& placed, const Vec& p, Rays depth,
                              Rays facing, const Light& paint) {
  const Vec o = transpose_times(broadcast<Rays>(placed.X_WI.R), p - broadcast<Rays>(placed.X_WI.p));
  const Rays across = pixel_width(frame.camera, depth);
  const Rays w = max(across / max(facing, Rays(0.02f)), Rays(1e-4f)) * Rays(1 / kCheck);
  const Rays f = stripes(o.x * Rays(1 / kCheck), w) * stripes(o.y * Rays(1 / kCheck), w);
  return scaled(fma(Rays(0.16f), f, Rays(1.0f)), paint);
}

/// Each face of a die has a colour of its own (linear light).
MANYHANDS_INLINE Light die(const PlacedItem& placed, const Vec& n, const Light& paint) {
  const Vec face = transpose_times(broadcast<Rays>(placed.X_WI.R), n);
  static constexpr std::array<std::array<float, 3>, 6> kFaces{{{0.60f, 0.02f, 0.03f},
                                                               {0.90f, 0.27f, 0.02f},
                                                               {0.01f, 0.30f, 0.06f},
                                                               {0.93f, 0.69f, 0.03f},
                                                               {0.01f, 0.15f, 0.51f},
                                                               {0.85f, 0.85f, 0.85f}}};
  Light colour = paint;
  for (std::size_t i = 0; i < kFaces.size(); ++i) {
    const Rays along = i < 2 ? face.x : i < 4 ? face.y : face.z;
    const RayMask is_this = (i % 2 == 0 ? along : -along) > Rays(0.7f);
    const auto& own = kFaces[i];
    colour = select(is_this, {Rays(own[0]) * paint.red, Rays(own[1]) * paint.green, Rays(own[2]) * paint.blue}, colour);
  }
  return colour;
}

MANYHANDS_INLINE Light sky(const PictureFrame& frame, const Vec& d) {
  const Rays up = max(d.z, Rays(0.0f)) / norm(d);
  return mix(sqrt(up), everywhere(frame.horizon), everywhere(frame.zenith));
}

MANYHANDS_INLINE Light reflected(const PictureFrame& frame, const Vec& n, const Vec& d, Rays share,
                                 const Light& paint) {
  const Look& look = frame.look;
  const Vec light = broadcast<Rays>(frame.light.z);
  const Rays from_sky = Rays(look.ambient) * fma(Rays(0.35f), n.z, Rays(0.65f));
  const Rays from_sun = Rays(look.sun) * share * max(dot(n, light), Rays(0.0f));
  const Vec middle = light - (Rays(1.0f) / norm(d)) * d;
  Rays gloss = max(dot(n, middle), Rays(0.0f)) / max(norm(middle), Rays(1e-6f));
  for (int i = 0; i < 5; ++i) gloss = gloss * gloss;
  gloss = gloss * Rays(kGloss * look.sun) * share;
  const Rays both = from_sky + from_sun;
  return {fma(both, paint.red, gloss), fma(both, paint.green, gloss), fma(both, paint.blue, gloss)};
}

/// The paint of points p with normals n (unit), seen along d (all in the world), where what is seen has a texture.
Light textured(const PictureFrame& frame, RayInts seen, const Vec& p, const Vec& n, const Vec& d, Rays depth,
               Light paint) {
  for (const TexturedSurface& surface : frame.textured) {
    const RayMask here(seen == surface.seen);
    when(here, [&] {
      const Mat3<Rays> R_WS = broadcast<Rays>(surface.X_WS.R);
      const Vec p_S = transpose_times(R_WS, p - broadcast<Rays>(surface.X_WS.p)), n_S = transpose_times(R_WS, n);
      const Vec d_S = (Rays(1.0f) / norm(d)) * transpose_times(R_WS, d);
      const Rays width = pixel_width(frame.camera, depth);
      for_lanes<Rays>(here, [&](int j) {
        const Lanes4 light = texture_light(surface, lane(p_S, j), lane(n_S, j), lane(d_S, j), lane(width, j));
        set_lane(paint.red, j, lane(light, 0) * lane(paint.red, j));
        set_lane(paint.green, j, lane(light, 1) * lane(paint.green, j));
        set_lane(paint.blue, j, lane(light, 2) * lane(paint.blue, j));
      });
    });
  }
  return paint;
}

Light paint_of(const PictureFrame& frame, RayInts seen) {
  Light paint;
  for (int k = 0; k < kRays; ++k) {
    const int number = seen[k];
    const Paint* own = number < 0 ? nullptr : &frame.paint[size(number)];
    set_lane(paint.red, k, own ? own->red : 0.0f);
    set_lane(paint.green, k, own ? own->green : 0.0f);
    set_lane(paint.blue, k, own ? own->blue : 0.0f);
  }
  return paint;
}

/// What lies before the solid surfaces, over `light`.
void add_clear(const PictureFrame& frame, const Layers& layers, const Samples& s, std::size_t k, const Vec& d_W,
               Light& light) {
  for (std::size_t i = 0; i < frame.clear.size(); ++i) {
    const PlacedItem& placed = frame.clear[i];
    if (!placed.view.meets(s.part)) continue;
    const LocalRay ray = local_ray(frame, placed.X_IC, s.x[k], s.y[k]);
    const Rays near(static_cast<float>(frame.camera.near));
    RayMask met;
    Rays t;
    RayInts seen = RayInts{} + placed.first_seen;
    Vec n{Rays(0.0f), Rays(0.0f), Rays(1.0f)};
    if (placed.item->triangles == nullptr) {
      const Entry<Rays> entry = enter_shape(placed.item->type, placed.item->size, ray.o, ray.d);
      t = entry.t;
      met = s.active[k] & (t >= near) & (t < s.depth[k]);
      n = broadcast<Rays>(placed.X_WI.R) * entry.n;
    } else {
      if (layers.clear[i].is_empty()) continue;
      RayInts number, triangle;
      layers.clear[i].at(s.active[k], grid_point(s.x[k], layers.scale), grid_point(s.y[k], layers.scale), number,
                         triangle);
      const RayMask there(number >= 0);
      const Surface surface = surface_at(mesh_of(placed, layers.is_exact), triangle, there, ray.o, ray.d);
      t = surface.t;
      met = there & (t >= near) & (t < s.depth[k]);
      seen = seen + surface.part;
      n = broadcast<Rays>(placed.X_WI.R) * surface.n;
      n = select(dot(n, d_W) > Rays(0.0f), -n, n);
    }
    when(met, [&] {
      Light paint = paint_of(frame, seen);
      const Paint& own = frame.paint[size(placed.first_seen)];
      if (own.pattern == Pattern::kDie && !own.is_textured) paint = die(placed, n, paint);
      if (!frame.textured.empty()) {
        const Vec p = broadcast<Rays>(placed.X_WI) * fma(t, ray.d, ray.o);
        paint = textured(frame, select(met, seen, RayInts{} - 1), p, n, d_W, t, paint);
      }
      Rays alpha(0.0f);
      for (int j = 0; j < kRays; ++j) set_lane(alpha, j, frame.paint[size(seen[j])].alpha);
      light = select(met, mix(alpha, light, reflected(frame, n, d_W, Rays(1.0f), paint)), light);
    });
  }
}

/// The paint of a packet's solid surfaces with what is on them, and by how much they fade into the horizon.
Light patterned(const PictureFrame& frame, const Samples& s, std::size_t k, const Vec& p, const Vec& d, Light paint,
                Rays& fade) {
  fade = Rays(0.0f);
  if (!frame.textured.empty()) paint = textured(frame, s.seen[k], p, s.n[k], d, s.depth[k], paint);
  for (const PlacedItem& placed : frame.solid) {
    const Paint& own = frame.paint[size(placed.first_seen)];
    if (own.pattern == Pattern::kPlain || !placed.view.meets(s.part)) continue;
    const RayMask here(s.seen[k] == placed.first_seen);
    when(here, [&] {
      if (own.pattern == Pattern::kDie) {
        if (!own.is_textured) paint = select(here, die(placed, s.n[k], paint), paint);
        return;
      }
      const Rays facing = -dot(s.n[k], d) / norm(d);
      if (!own.is_textured) paint = select(here, checks(frame, placed, p, s.depth[k], facing, paint), paint);
      const Rays along = (s.depth[k] - Rays(kFadeFrom)) * Rays(1 / (kFadeTo - kFadeFrom));
      const Rays f = clamp(along, Rays(0.0f), Rays(1.0f));
      fade = select(here, f * f * (Rays(3.0f) - Rays(2.0f) * f), fade);
    });
  }
  return paint;
}

}  // namespace

LitPart nothing_lit() {
  const float never = internal::kNever;
  return {{never, -never, never, -never}, never};
}

void widen(LitPart& lit, const LitPart& other) {
  lit.across = united(lit.across, other.across);
  lit.lowest = min(lit.lowest, other.lowest);
}

void shade(const PictureFrame& frame, const Layers& layers, Samples& s) {
  Lit lit;
  std::array<Vec, Samples::kPackets> d, p;
  const float never = internal::kNever;
  Rays left(never), right(-never), top(never), bottom(-never), lowest(never);
  const Vec light = broadcast<Rays>(frame.light.z);
  const Vec across_x = broadcast<Rays>(frame.light.x), across_y = broadcast<Rays>(frame.light.y);
  bool is_lit = false;
  for (std::size_t k = 0; k < size(s.packets); ++k) {
    const LocalRay ray = local_ray(frame, frame.X_WC, s.x[k], s.y[k]);
    d[k] = ray.d;
    p[k] = fma(s.depth[k], ray.d, ray.o);
    lit.mask[k] = s.active[k] & RayMask(s.seen[k] >= 0) & (dot(s.n[k], light) > Rays(0.0f));
    lit.from[k] = fma(Rays(kAbove), s.n[k], p[k]);
    lit.share[k] = Rays(frame.look.shadows ? 0.0f : 1.0f);
    const Rays u = dot(across_x, p[k]), v = dot(across_y, p[k]), w = dot(light, p[k]);
    left = select(lit.mask[k], min(left, u), left);
    right = select(lit.mask[k], max(right, u), right);
    top = select(lit.mask[k], min(top, v), top);
    bottom = select(lit.mask[k], max(bottom, v), bottom);
    lowest = select(lit.mask[k], min(lowest, w), lowest);
    is_lit = is_lit || any(lit.mask[k]);
  }
  if (frame.look.shadows && is_lit) {
    lit.part = {{least(left), greatest(right), least(top), greatest(bottom)}, least(lowest)};
    widen(s.lit, lit.part);
    cast_shadows(frame, s, lit);
  }
  for (std::size_t k = 0; k < size(s.packets); ++k) {
    Light result = sky(frame, d[k]);
    const RayMask there(s.seen[k] >= 0);
    when(there, [&] {
      Rays fade;
      const Light paint = patterned(frame, s, k, p[k], d[k], paint_of(frame, s.seen[k]), fade);
      const Light surface = reflected(frame, s.n[k], d[k], lit.share[k], paint);
      result = select(there, mix(fade, surface, everywhere(frame.horizon)), result);
    });
    add_clear(frame, layers, s, k, d[k], result);
    s.red[k] = encoded(result.red);
    s.green[k] = encoded(result.green);
    s.blue[k] = encoded(result.blue);
  }
}

}  // namespace manyhands
