#include "manyhands/render/backdrop.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "manyhands/render/sample_rays.h"
#include "manyhands/render/shadows.h"

namespace manyhands {

namespace {

constexpr std::size_t kKept = 8;

class Words {
 public:
  explicit Words(std::vector<std::uint64_t>& to) : to_(to) {}
  void add(double number) { to_.push_back(std::bit_cast<std::uint64_t>(number)); }
  void add(float number) { to_.push_back(std::bit_cast<std::uint32_t>(number)); }
  template <std::integral T>
  void add(T number) {
    to_.push_back(static_cast<std::uint64_t>(number));
  }
  void add(const void* address) { to_.push_back(std::bit_cast<std::uintptr_t>(address)); }
  template <class T>
  void add(const Vec3<T>& a) {
    add(a.x);
    add(a.y);
    add(a.z);
  }
  template <class T>
  void add(const Transform<T>& X) {
    for (const Vec3<T>& a : {X.R.x, X.R.y, X.R.z, X.p}) add(a);
  }

 private:
  std::vector<std::uint64_t>& to_;
};

void add_view(Words& words, const PictureFrame& frame) {
  const Camera& camera = frame.camera;
  for (const int number : {camera.width, camera.height, int{camera.orthographic}}) words.add(number);
  for (const double number : {camera.fx, camera.fy, camera.cx, camera.cy, camera.near, camera.far}) words.add(number);
  const Look& look = frame.look;
  words.add(look.light);
  for (const float number : {look.sun, look.ambient, frame.texel}) words.add(number);
  for (const int number : {int{look.shadows}, look.shadow_rays, look.antialiasing}) words.add(number);
  words.add(look.sun_size);
  for (const Colour& colour : {look.horizon, look.zenith}) {
    for (const float part : colour) words.add(part);
  }
  words.add(frame.X_WC);
}

void add_item(Words& words, const PictureFrame& frame, const PlacedItem& placed) {
  const Item& item = *placed.item;
  words.add(static_cast<int>(item.type));
  words.add(item.size);
  for (const void* mesh : {static_cast<const void*>(placed.shown), static_cast<const void*>(placed.casts)})
    words.add(mesh);
  words.add(placed.X_WI);
  words.add(placed.X_IC);
  words.add(placed.first_seen);
  for (int i = placed.first_seen; i < placed.first_seen + item.num_seen; ++i) {
    const Paint& paint = frame.paint[size(i)];
    for (const float part : {paint.red, paint.green, paint.blue}) words.add(part);
    words.add(static_cast<int>(paint.pattern));
    words.add(int{paint.is_textured});
  }
}

}  // namespace

BackdropKey backdrop_key(const PictureFrame& frame) {
  BackdropKey key;
  Words words(key.words);
  add_view(words, frame);
  for (const PlacedItem& placed : frame.solid_items(true)) {
    add_item(words, frame, placed);
    for (const TexturedSurface& surface : frame.textured) {
      if (surface.seen < placed.first_seen || surface.seen >= placed.first_seen + placed.item->num_seen) continue;
      words.add(surface.seen);
      words.add(static_cast<const void*>(surface.texture->image.get()));
      for (const float number : surface.texture->repeat) words.add(number);
      key.images.push_back(surface.texture->image);
    }
  }
  return key;
}

PictureFrame still_part(const PictureFrame& frame) {
  PictureFrame part = frame;
  part.solid.resize(frame.num_still);
  part.clear.clear();
  for (int i = 0; i < static_cast<int>(part.suns.size()); ++i) draw_sun(part, i);
  return part;
}

std::vector<bool> touched_tiles(const PictureFrame& frame, const Backdrop& backdrop) {
  const Camera& camera = frame.camera;
  const float rim = static_cast<float>(std::tan(frame.look.sun_size));
  const float room = 4 * frame.texel + 2 * kAbove;  // what is asked about the sun lies so far off at most
  const auto may_shade = [&](const PlacedItem& placed, const LitPart& lit) {
    if (frame.suns.empty() || placed.height < lit.lowest - room) return false;
    return widened(placed.shade, room + rim * (placed.height - lit.lowest)).meets(lit.across);
  };
  std::vector<bool> touched;
  touched.reserve(backdrop.tiles.size());
  for (int y = 0; y < camera.height; y += kTile) {
    for (int x = 0; x < camera.width; x += kTile) {
      const Rectangle part = tile_part(x, y);
      const LitPart& lit = backdrop.tiles[touched.size()].lit;
      const auto touches = [&](const PlacedItem& placed) { return placed.view.meets(part) || may_shade(placed, lit); };
      const auto covers = [&](const PlacedItem& placed) { return placed.view.meets(part); };
      touched.push_back(std::ranges::any_of(frame.solid_items(false), touches) ||
                        std::ranges::any_of(frame.clear, covers));
    }
  }
  return touched;
}

std::shared_ptr<const Backdrop> Backdrops::find(const BackdropKey& key, bool& is_wanted) {
  const std::scoped_lock lock(mutex_);
  is_wanted = false;
  const auto found = std::ranges::find(entries_, key, &Entry::key);
  if (found == entries_.end()) {
    if (entries_.size() == kKept) entries_.erase(entries_.begin());
    entries_.push_back({key, nullptr});
    return nullptr;
  }
  std::rotate(found, found + 1, entries_.end());
  Entry& entry = entries_.back();
  is_wanted = !entry.is_drawn;
  entry.is_drawn = true;
  return entry.backdrop;
}

void Backdrops::keep(const BackdropKey& key, std::shared_ptr<const Backdrop> backdrop) {
  const std::scoped_lock lock(mutex_);
  const auto found = std::ranges::find(entries_, key, &Entry::key);
  if (found != entries_.end()) found->backdrop = std::move(backdrop);
}

}  // namespace manyhands
