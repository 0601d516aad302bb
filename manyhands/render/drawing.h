// The pixels of a picture whose frame is prepared. Internal to the renderer.
#pragma once

#include "manyhands/render/renderer.h"

namespace manyhands {

inline constexpr int kTile = 8;  ///< pixels: a packet is a row of one

/// The rows from `first` to before `end`, both multiples of kTile or the picture's height; `layers` lends its memory.
/// to: of this picture alone. Colours have rough edges.
void draw(const PictureFrame& frame, std::span<const Seen> seen, int first, int end, Layers& layers,
          const Pictures& to);
/// Takes more samples of pixels that differ from their neighbours in `rough`, the whole picture's colours.
void smooth(const PictureFrame& frame, std::span<const std::uint8_t> rough, int first, int end, Layers& layers,
            std::span<std::uint8_t> to);

}  // namespace manyhands
