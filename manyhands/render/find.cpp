#include "manyhands/render/ray_shapes.h"
#include "manyhands/render/sample_rays.h"
#include "manyhands/render/samples.h"
#include "manyhands/render/surface.h"

namespace manyhands {

namespace {

void find_shape(const PictureFrame& frame, const PlacedItem& placed, Samples& s) {
  const Rays near(static_cast<float>(frame.camera.near));
  const Item& item = *placed.item;
  const Mat3<Rays> R_WI = broadcast<Rays>(placed.X_WI.R);
  for (std::size_t k = 0; k < size(s.packets); ++k) {
    const LocalRay ray = local_ray(frame, placed.X_IC, s.x[k], s.y[k]);
    const Entry<Rays> entry = enter_shape(item.type, item.size, ray.o, ray.d);
    const RayMask met = s.active[k] & (entry.t >= near) & (entry.t < s.depth[k]);
    when(met, [&] {
      s.depth[k] = select(met, entry.t, s.depth[k]);
      s.n[k] = select(met, R_WI * entry.n, s.n[k]);
      s.seen[k] = select(met, RayInts{} + placed.first_seen, s.seen[k]);
    });
  }
}

}  // namespace

void clear(const PictureFrame& frame, Samples& s) {
  const Rays far(static_cast<float>(frame.camera.far));
  for (std::size_t k = 0; k < size(s.packets); ++k) {
    s.depth[k] = far;
    s.seen[k] = RayInts{} - 1;
    s.n[k] = {Rays(0.0f), Rays(0.0f), Rays(1.0f)};
  }
}

void find(const PictureFrame& frame, const Layers& layers, bool still, Samples& s) {
  for (const PlacedItem& placed : frame.solid_items(still)) {
    if (placed.item->triangles == nullptr && placed.view.meets(s.part)) find_shape(frame, placed, s);
  }
  const Raster& raster = still ? layers.still : layers.moving;
  if (raster.is_empty()) return;
  for (std::size_t k = 0; k < size(s.packets); ++k) {
    RayInts number, triangle;
    raster.at(s.active[k], grid_point(s.x[k], layers.scale), grid_point(s.y[k], layers.scale), number, triangle);
    RayMask left(number >= 0);
    while (any(left)) {
      int first = 0;
      while (!lane(left, first)) ++first;
      const PlacedItem& placed = frame.solid[size(number[first])];
      const RayMask here = left & RayMask(number == number[first]);
      left = left & !here;
      const LocalRay ray = local_ray(frame, placed.X_IC, s.x[k], s.y[k]);
      const Surface surface = surface_at(mesh_of(placed, layers.is_exact), triangle, here, ray.o, ray.d);
      const RayMask met = here & (surface.t < s.depth[k]);
      s.depth[k] = select(met, surface.t, s.depth[k]);
      const Vec3<Rays> n = select(dot(surface.n, ray.d) > Rays(0.0f), -surface.n, surface.n);
      s.n[k] = select(met, broadcast<Rays>(placed.X_WI.R) * n, s.n[k]);
      s.seen[k] = select(met, surface.part + placed.first_seen, s.seen[k]);
    }
  }
}

}  // namespace manyhands
