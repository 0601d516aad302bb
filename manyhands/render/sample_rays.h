// The rays of samples, in the axes of whatever they are tried against. Internal to the renderer.
#pragma once

#include "manyhands/math/control_flow.h"
#include "manyhands/render/frame.h"
#include "manyhands/render/triangles.h"

namespace manyhands {

[[nodiscard]] MANYHANDS_INLINE std::size_t size(int n) { return static_cast<std::size_t>(n); }

MANYHANDS_INLINE RayInts whole(Rays a) { return __builtin_convertvector(a.v, RayInts); }

/// The point of a grid with `scale` points to a pixel that lies at a position [pixels].
MANYHANDS_INLINE RayInts grid_point(Rays x, int scale) { return whole(floor(x * Rays(static_cast<float>(scale)))); }

/// What is drawn of an item that is a mesh.
MANYHANDS_INLINE const ClusteredMesh& mesh_of(const PlacedItem& placed, bool is_exact) {
  return is_exact ? placed.item->triangles->exact() : *placed.shown;
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
