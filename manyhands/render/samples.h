// What is seen along up to 64 rays through a small part of a picture. Internal to the renderer.
#pragma once

#include "manyhands/render/frame.h"

namespace manyhands {

/// The meshes that a part of a picture shows, drawn with `scale` x `scale` points to a pixel.
struct Layers {
  int scale = 1;
  bool is_exact = false;        ///< the meshes themselves, not their coarser copies
  Raster still, moving;         ///< by number of the frame's solid item
  std::vector<Raster> clear{};  ///< of each see-through item
};

inline constexpr int kTile = 8;  ///< pixels, along the side of a square: a packet is a row of it

/// The square whose upper left pixel is (x, y).
[[nodiscard]] inline Rectangle tile_part(int x, int y) {
  const float left = static_cast<float>(x), top = static_cast<float>(y);
  return {left, left + kTile, top, top + kTile};
}

/// What is seen along the rays of up to eight packets.
struct Found {
  static constexpr int kPackets = 8;
  std::array<Rays, kPackets> depth{};    ///< camera.far where there is nothing [m]
  std::array<RayInts, kPackets> seen{};  ///< numbers of paints; -1 where there is nothing
  std::array<Vec3<Rays>, kPackets> n{};  ///< unit, in the world, towards the camera
};

/// Where points that face the sun lie.
struct LitPart {
  Rectangle across;  ///< the light; of nothing, left > right [m]
  float lowest;      ///< towards it [m]
};
[[nodiscard]] LitPart nothing_lit();
/// Makes `lit` so large that `other` is in it.
void widen(LitPart& lit, const LitPart& other);

struct Samples : Found {  // by `find`
  // ---- given ----
  int packets = 0;
  Rectangle part{};                        ///< of the picture; holds all positions [pixels]
  std::array<RayMask, kPackets> active{};  ///< which lanes are wanted
  std::array<Rays, kPackets> x{}, y{};     ///< positions [pixels]
  int per_pixel = 1;                       ///< samples that share a pixel, and its rays to the sun
  std::array<int, kPackets> number{};      ///< of the packet's among those of its pixels

  // ---- found by `shade` ----
  std::array<Rays, kPackets> red{}, green{}, blue{};  ///< as screens take them, 0 to 255
  LitPart lit = nothing_lit();
};

/// Begins to look: nothing is found.
void clear(const PictureFrame& frame, Samples& samples);
/// Depths, and what is seen, of the frame's solid items that stand still, or of those that may move, before what has
/// been found so far. `layers` holds them at the samples.
void find(const PictureFrame& frame, const Layers& layers, bool still, Samples& samples);
/// Colours, of what has been found.
void shade(const PictureFrame& frame, const Layers& layers, Samples& samples);

}  // namespace manyhands
