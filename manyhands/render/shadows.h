// Shadows: of simple shapes by rays, of meshes by what each point of the sun shines on. Internal to the renderer.
#pragma once

#include "manyhands/render/samples.h"

namespace manyhands {

/// The points of samples that look towards the light, and how much of it they get.
struct Lit {
  std::array<RayMask, Samples::kPackets> mask;
  std::array<Vec3<Rays>, Samples::kPackets> from;
  std::array<Rays, Samples::kPackets> share;
  LitPart part;
};

inline constexpr float kAbove = 1e-3f;  ///< rays to the sun start so far off the surface [m]

/// Chooses the points of the sun that shine on a frame whose items are placed, and how finely they do.
void set_suns(PictureFrame& frame);
/// Draws what number i of them shines on.
void draw_sun(PictureFrame& frame, int i);
/// Adds to lit.share what reaches the samples' points.
void cast_shadows(const PictureFrame& frame, const Samples& samples, Lit& lit);

}  // namespace manyhands
