// The pixels of a picture whose frame is prepared. Internal to the renderer.
#pragma once

#include "manyhands/render/backdrop.h"
#include "manyhands/render/renderer.h"

namespace manyhands {

/// A picture that is being drawn.
struct Drawing {
  const PictureFrame& frame;
  std::span<const Seen> seen;          ///< of the scene
  const Backdrop* backdrop = nullptr;  ///< what stands still, if it is known
  std::vector<bool> touched{};         ///< then: which tiles are not those of the backdrop
  Backdrop* into = nullptr;            ///< is filled with what is found, if the frame is one of what stands still
};

/// The rows from `first` to before `end`, both multiples of kTile or the picture's height; `layers` lends its memory.
/// to: of this picture alone. Colours have rough edges.
void draw(const Drawing& drawing, int first, int end, Layers& layers, const Pictures& to);
/// Takes more samples of pixels that differ from their neighbours in `rough`, the whole picture's colours.
void smooth(const Drawing& drawing, std::span<const std::uint8_t> rough, int first, int end, Layers& layers,
            std::span<std::uint8_t> to);

}  // namespace manyhands
