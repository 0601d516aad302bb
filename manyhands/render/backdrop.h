// What stands still before a camera that stands still, kept from picture to picture. Internal to the renderer.
#pragma once

#include <memory>

#include "manyhands/base/process_mutex.h"
#include "manyhands/render/samples.h"

namespace manyhands {

/// A picture of what stands still, tile by tile. Where nothing that may move is before a tile or between it and the
/// sun, the tile has the same bits in the whole picture; elsewhere looking for what moves goes on from it.
struct Backdrop {
  struct Tile {
    Found shown, exact;  ///< with coarser copies of meshes, and without
    LitPart lit;         ///< all that has been shaded in it
  };
  std::vector<Tile> tiles;  ///< row by row
  std::vector<std::uint8_t> rough{}, smooth{};
};

/// All numbers on which a backdrop depends, bit by bit.
struct BackdropKey {
  std::vector<std::uint64_t> words{};
  std::vector<std::shared_ptr<const Image>> images{};  ///< kept, so that no other gets their addresses

  [[nodiscard]] bool operator==(const BackdropKey& other) const { return words == other.words; }
};
[[nodiscard]] BackdropKey backdrop_key(const PictureFrame& frame);

/// The frame without what may move, or may be seen through; it borrows from the whole one. Its suns shine on that.
[[nodiscard]] PictureFrame still_part(const PictureFrame& frame);

/// Which tiles of the picture are not those of the backdrop, row by row.
[[nodiscard]] std::vector<bool> touched_tiles(const PictureFrame& frame, const Backdrop& backdrop);

/// The last few. Whether one is there decides what a picture costs, not what it shows.
class Backdrops {
 public:
  /// None if it is not there; is_wanted: because it is seen again, the caller should draw and `keep` it.
  [[nodiscard]] std::shared_ptr<const Backdrop> find(const BackdropKey& key, bool& is_wanted);
  void keep(const BackdropKey& key, std::shared_ptr<const Backdrop> backdrop);

 private:
  struct Entry {
    BackdropKey key;
    std::shared_ptr<const Backdrop> backdrop;
    bool is_drawn = false;  // by somebody, now or before
  };
  ProcessMutex mutex_;
  std::vector<Entry> entries_;  // what was asked for last stands last
};

}  // namespace manyhands
