// The rays of samples, in the axes of whatever they are tried against. Internal to the renderer.
#pragma once

#include "manyhands/math/control_flow.h"
#include "manyhands/render/frame.h"

namespace manyhands {

[[nodiscard]] MANYHANDS_INLINE std::size_t size(int n) { return static_cast<std::size_t>(n); }

MANYHANDS_INLINE void set_lane(Vec3<Rays>& to, int k, const Vec3<float>& from) {
  set_lane(to.x, k, from.x);
  set_lane(to.y, k, from.y);
  set_lane(to.z, k, from.z);
}

struct LocalRay {
  Vec3<Rays> o, d;
};

/// In the axes of A: a step of length 1 along d is one metre of depth.
MANYHANDS_INLINE LocalRay local_ray(const PictureFrame& frame, const Transform<float>& X_AC, Rays x, Rays y) {
  const Camera& camera = frame.camera;
  const Rays a = (x - Rays(static_cast<float>(camera.cx))) * Rays(static_cast<float>(1 / camera.fx));
  const Rays b = (y - Rays(static_cast<float>(camera.cy))) * Rays(static_cast<float>(1 / camera.fy));
  const Vec3<Rays> z = broadcast<Rays>(X_AC.R.z), p = broadcast<Rays>(X_AC.p);
  const Vec3<Rays> across = fma(a, broadcast<Rays>(X_AC.R.x), b * broadcast<Rays>(X_AC.R.y));
  if (camera.orthographic) return {p + across, z};
  return {p, across + z};
}

}  // namespace manyhands
