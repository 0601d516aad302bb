// What is seen along up to 64 rays through a small part of a picture. Internal to the renderer.
#pragma once

#include "manyhands/render/frame.h"

namespace manyhands {

struct Samples {
  static constexpr int kPackets = 8;

  // ---- given ----
  int packets = 0;
  Rectangle part{};                        ///< of the picture; holds all positions [pixels]
  std::array<RayMask, kPackets> active{};  ///< which lanes are wanted
  std::array<Rays, kPackets> x{}, y{};     ///< positions [pixels]
  int per_pixel = 1;                       ///< samples that share a pixel, and its rays to the sun
  std::array<int, kPackets> number{};      ///< of the packet's among those of its pixels

  // ---- found by `find` ----
  std::array<Rays, kPackets> depth{};    ///< camera.far where there is nothing [m]
  std::array<RayInts, kPackets> seen{};  ///< numbers of paints; -1 where there is nothing
  std::array<Vec3<Rays>, kPackets> n{};  ///< unit, in the world, towards the camera

  // ---- found by `shade` ----
  std::array<Rays, kPackets> red{}, green{}, blue{};  ///< as screens take them, 0 to 255
};

/// Depths, and what is seen, of the frame's solid items.
void find(const PictureFrame& frame, Samples& samples);
/// Colours, after `find`.
void shade(const PictureFrame& frame, Samples& samples);

}  // namespace manyhands
