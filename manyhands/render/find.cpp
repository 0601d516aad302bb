#include "manyhands/render/ray_shapes.h"
#include "manyhands/render/sample_rays.h"
#include "manyhands/render/samples.h"

namespace manyhands {

namespace {

/// Which triangle each lane saw last, and of which item; -1: of none.
struct TriangleHits {
  std::array<RayInts, Samples::kPackets> item, part, triangle;
};

void find_shape(const PictureFrame& frame, const PlacedItem& placed, Samples& s, TriangleHits& hits) {
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
      hits.item[k] = select(met, RayInts{} - 1, hits.item[k]);
    });
  }
}

void find_triangles(const PictureFrame& frame, int number, const PlacedItem& placed, Samples& s, TriangleHits& hits) {
  const Item& item = *placed.item;
  const Rays near(static_cast<float>(frame.camera.near));
  for (std::size_t k = 0; k < size(s.packets); ++k) {
    const LocalRay ray = local_ray(frame, placed.X_IC, s.x[k], s.y[k]);
    const RayMask open = s.active[k] & meets_bounds(item.low, item.high, ray.o, ray.d, near, s.depth[k]);
    when(open, [&] {
      RayPacket packet{open, ray.o, ray.d, near, s.depth[k]};
      const RayMask met = item.triangles->meet(packet, hits.part[k], hits.triangle[k]);
      when(met, [&] {
        s.depth[k] = select(met, packet.far, s.depth[k]);
        s.seen[k] = select(met, hits.part[k] + placed.first_seen, s.seen[k]);
        hits.item[k] = select(met, RayInts{} + number, hits.item[k]);
      });
    });
  }
}

/// Depths and normals of the triangles that were seen in the end.
void settle(const PictureFrame& frame, const TriangleHits& hits, Samples& s) {
  for (std::size_t k = 0; k < size(s.packets); ++k) {
    const RayMask met(hits.item[k] >= 0);
    for_lanes<Rays>(met, [&](int j) {
      const PlacedItem& placed = frame.solid[size(hits.item[k][j])];
      const LocalRay rays = local_ray(frame, placed.X_IC, s.x[k], s.y[k]);
      const Vec3<float> d = lane(rays.d, j);
      const Triangles::Surface surface =
          placed.item->triangles->surface({hits.part[k][j], hits.triangle[k][j]}, lane(rays.o, j), d);
      set_lane(s.depth[k], j, surface.t);
      set_lane(s.n[k], j, placed.X_WI.R * surface.n);
    });
  }
}

}  // namespace

void find(const PictureFrame& frame, Samples& s) {
  TriangleHits hits;
  const Rays far(static_cast<float>(frame.camera.far));
  for (std::size_t k = 0; k < size(s.packets); ++k) {
    s.depth[k] = far;
    s.seen[k] = hits.item[k] = hits.part[k] = hits.triangle[k] = RayInts{} - 1;
    s.n[k] = {Rays(0.0f), Rays(0.0f), Rays(1.0f)};
  }
  bool has_triangles = false;
  for (std::size_t i = 0; i < frame.solid.size(); ++i) {
    const PlacedItem& placed = frame.solid[i];
    if (!placed.view.meets(s.part)) continue;
    if (placed.item->triangles == nullptr) {
      find_shape(frame, placed, s, hits);
    } else {
      has_triangles = true;
      find_triangles(frame, static_cast<int>(i), placed, s, hits);
    }
  }
  if (has_triangles) settle(frame, hits, s);
}

}  // namespace manyhands
