#include "manyhands/render/drawing.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "manyhands/render/sample_rays.h"

namespace manyhands {

namespace {

/// An item as the camera sees it, in a grid with `scale` points to a pixel each way.
View view_of(const PlacedItem& placed, const Camera& camera, int scale) {
  const auto scaled = [&](double number) { return static_cast<float>(scale * number); };
  const float fx = scaled(camera.fx), fy = scaled(camera.fy), cx = scaled(camera.cx), cy = scaled(camera.cy);
  const auto& [x, y, z] = placed.X_IC.R;  // as rows, they lead from I to C
  const Vec3<float>& eye = placed.X_IC.p;
  View view;
  view.is_parallel = camera.orthographic;
  view.near = static_cast<float>(camera.near);
  view.ahead = z;
  view.across = camera.orthographic ? fx * x : fma(fx, x, cx * z);
  view.down = camera.orthographic ? fy * y : fma(fy, y, cy * z);
  view.at = {-dot(view.across, eye), -dot(view.down, eye), -dot(z, eye)};
  if (camera.orthographic) view.at = view.at + Vec3<float>{cx, cy, 0};
  view.eye = camera.orthographic ? z : eye;
  view.sees_backs = placed.nearest <= max(view.near, 1e-3f);  // the camera may be inside of it
  return view;
}

/// Draws the meshes that the rows from `first` to before `end` show; those that stand still only if they are wanted.
void draw_layers(const PictureFrame& frame, int first, int end, int scale, bool is_exact, bool wants_still,
                 Layers& layers) {
  const Camera& camera = frame.camera;
  const GridPart part{0, scale * first, scale * camera.width, scale * (end - first)};
  layers.scale = scale;
  layers.is_exact = is_exact;
  layers.still.begin(part, true);
  layers.moving.begin(part, true);
  layers.clear.resize(std::max(layers.clear.size(), frame.clear.size()));
  const Rectangle rows{0, static_cast<float>(camera.width), static_cast<float>(first), static_cast<float>(end)};
  const auto draw_into = [&](Raster& raster, const PlacedItem& placed, std::size_t number) {
    if (placed.item->triangles == nullptr || !placed.view.meets(rows)) return;
    raster.draw(mesh_of(placed, is_exact), view_of(placed, camera, scale), static_cast<int>(number));
  };
  for (std::size_t i = wants_still ? 0 : frame.num_still; i < frame.solid.size(); ++i) {
    draw_into(i < frame.num_still ? layers.still : layers.moving, frame.solid[i], i);
  }
  for (std::size_t i = 0; i < frame.clear.size(); ++i) {
    layers.clear[i].begin(part, true);
    draw_into(layers.clear[i], frame.clear[i], i);
  }
}

void find_still(const PictureFrame& frame, const Layers& layers, Samples& samples) {
  clear(frame, samples);
  find(frame, layers, true, samples);
}

Samples grid(const Camera& camera, int x0, int y0) {
  Samples s;
  s.packets = std::min(kTile, camera.height - y0);
  const float left = static_cast<float>(x0), top = static_cast<float>(y0);
  s.part = tile_part(x0, y0);
  for (int k = 0; k < s.packets; ++k) {
    for (int j = 0; j < kRays; ++j) {
      set_lane(s.x[size(k)], j, left + static_cast<float>(j) + 0.5f);
      s.active[size(k)].bits[j] = x0 + j < camera.width ? -1 : 0;
    }
    s.y[size(k)] = Rays(top + static_cast<float>(k) + 0.5f);
  }
  return s;
}

std::uint8_t byte(float value) { return static_cast<std::uint8_t>(value + 0.5f); }

struct Tile {
  int x, y;            // its first pixel
  std::size_t number;  // row by row
};

/// Calls visit(tile) for the tiles of some rows.
template <class Visit>
void for_each_tile(const Camera& camera, int first, int end, Visit&& visit) {
  const int columns = (camera.width + kTile - 1) / kTile;
  for (int y = first; y < end; y += kTile) {
    for (int x = 0; x < camera.width; x += kTile) visit(Tile{x, y, size(y / kTile * columns + x / kTile)});
  }
}

void copy_colours(const Camera& camera, const Tile& tile, std::span<const std::uint8_t> from,
                  std::span<std::uint8_t> to) {
  const int columns = std::min(kTile, camera.width - tile.x);
  for (int y = tile.y; y < std::min(tile.y + kTile, camera.height); ++y) {
    const std::size_t first = 3 * (size(y) * size(camera.width) + size(tile.x));
    std::copy_n(&from[first], 3 * size(columns), &to[first]);
  }
}

/// Whether a tile or one beside it is not that of the backdrop: then its edges may be others.
bool is_touched(const Drawing& drawing, const Tile& tile) {
  const Camera& camera = drawing.frame.camera;
  const std::size_t columns = size((camera.width + kTile - 1) / kTile);
  const auto is = [&](bool exists, std::size_t number) { return exists && drawing.touched[number]; };
  return is(true, tile.number) || is(tile.x > 0, tile.number - 1) ||
         is(tile.x + kTile < camera.width, tile.number + 1) || is(tile.y > 0, tile.number - columns) ||
         is(tile.y + kTile < camera.height, tile.number + columns);
}

/// Calls visit(pixel, packet, lane) for the pixels of a tile at (x0, y0).
template <class Visit>
void for_each_pixel(const Camera& camera, const Samples& s, int x0, int y0, Visit&& visit) {
  const int columns = std::min(kTile, camera.width - x0);
  for (std::size_t k = 0; k < size(s.packets); ++k) {
    const std::size_t first = (size(y0) + k) * size(camera.width) + size(x0);
    for (int j = 0; j < columns; ++j) visit(first + size(j), k, j);
  }
}

void write_colours(const Camera& camera, const Samples& s, int x0, int y0, const Pictures& to) {
  for_each_pixel(camera, s, x0, y0, [&](std::size_t pixel, std::size_t k, int j) {
    to.colour[3 * pixel] = byte(lane(s.red[k], j));
    to.colour[3 * pixel + 1] = byte(lane(s.green[k], j));
    to.colour[3 * pixel + 2] = byte(lane(s.blue[k], j));
  });
}

void write_geometry(const Camera& camera, std::span<const Seen> seen, const Samples& s, int x0, int y0,
                    const Pictures& to) {
  for_each_pixel(camera, s, x0, y0, [&](std::size_t pixel, std::size_t k, int j) {
    const int number = s.seen[k][j];
    if (!to.depth.empty()) to.depth[pixel] = lane(s.depth[k], j);
    if (!to.segmentation.empty()) to.segmentation[pixel] = number < 0 ? -1 : seen[size(number)].link.value();
    if (to.normals.empty()) return;
    to.normals[3 * pixel] = number < 0 ? 0 : lane(s.n[k].x, j);
    to.normals[3 * pixel + 1] = number < 0 ? 0 : lane(s.n[k].y, j);
    to.normals[3 * pixel + 2] = number < 0 ? 0 : lane(s.n[k].z, j);
  });
}

/// Calls visit(j) for the pixels j of a tile's row at (x, y) that differ visibly from one beside them in a colour
/// picture.
template <class Visit>
void for_each_edge(const Camera& camera, std::span<const std::uint8_t> picture, int x, int y, Visit&& visit) {
  constexpr std::uint8_t kVisible = 10;
  using Bytes __attribute__((vector_size(32))) = std::uint8_t;
  const std::size_t columns = size(std::min(kTile, camera.width - x));
  const auto row = [&](int at) { return &picture[3 * (size(at) * size(camera.width) + size(x))]; };
  const auto bytes = [&](const std::uint8_t* from) {
    Bytes all{};
    std::memcpy(&all, from, 3 * columns);
    return all;
  };
  std::array<std::uint8_t, 3 * (kTile + 2)> wide;  // with the pixels to the left and to the right
  std::memcpy(&wide[3], row(y), 3 * columns);
  std::memcpy(wide.data(), row(y) - (x > 0 ? 3 : 0), 3);
  std::memcpy(&wide[3 * (columns + 1)], row(y) + 3 * (columns - (x + kTile < camera.width ? 0 : 1)), 3);
  const Bytes own = bytes(&wide[3]);
  const auto differs = [&](const std::uint8_t* beside) {
    const Bytes other = bytes(beside);
    return (own > other ? own - other : other - own) > kVisible;
  };
  const auto found = std::bit_cast<std::array<std::uint8_t, sizeof(Bytes)>>(
      differs(wide.data()) | differs(&wide[6]) | differs(row(std::max(y - 1, 0))) |
      differs(row(std::min(y + 1, camera.height - 1))));
  for (std::size_t j = 0; j < columns; ++j) {
    if ((found[3 * j] | found[3 * j + 1] | found[3 * j + 2]) != 0) visit(static_cast<int>(j));
  }
}

/// Takes n x n samples of each of some pixels of a tile, and writes their means. A packet holds the same sample of
/// eight pixels.
class EdgeSamples {
 public:
  EdgeSamples(const PictureFrame& frame, const Layers& layers, int x0, int y0, std::span<std::uint8_t> picture)
      : frame_(frame), layers_(layers), n_(layers.scale), picture_(picture) {
    samples_.part = tile_part(x0, y0);
    samples_.per_pixel = n_ * n_;
  }

  [[nodiscard]] const LitPart& lit() const { return samples_.lit; }
  void add(int x, int y) { pixels_[size(count_++)] = {x, y}; }

  void flush() {
    const int packets = (count_ + kRays - 1) / kRays * n_ * n_;
    for (int first = 0; first < packets; first += Samples::kPackets) {
      samples_.packets = std::min(Samples::kPackets, packets - first);
      for (int k = 0; k < samples_.packets; ++k) place(size(k), (first + k) / (n_ * n_), (first + k) % (n_ * n_));
      find_still(frame_, layers_, samples_);
      find(frame_, layers_, false, samples_);
      shade(frame_, layers_, samples_);
      for (int k = 0; k < samples_.packets; ++k) add_colours(size(k), size((first + k) / (n_ * n_)));
    }
    const Rays share(1 / static_cast<float>(n_ * n_));
    for (int p = 0; p < count_; ++p) {
      const Pixel& pixel = pixels_[size(p)];
      std::uint8_t* const to = &picture_[3 * (size(pixel.y) * size(frame_.camera.width) + size(pixel.x))];
      for (std::size_t c = 0; c < 3; ++c) to[c] = byte(lane(share * sums_[size(p / kRays)][c], p % kRays));
    }
  }

 private:
  struct Pixel {
    int x, y;
  };

  /// Sample `number` of the pixels of a group into a packet.
  void place(std::size_t packet, int group, int number) {
    const auto within = [&](int k) { return (static_cast<float>(k) + 0.5f) / static_cast<float>(n_); };
    samples_.number[packet] = number;
    samples_.active[packet] = RayMask(false);
    for (int j = 0; j < kRays; ++j) {
      const int p = std::min(group * kRays + j, count_ - 1);
      samples_.active[packet].bits[j] = group * kRays + j < count_ ? -1 : 0;
      set_lane(samples_.x[packet], j, static_cast<float>(pixels_[size(p)].x) + within(number % n_));
      set_lane(samples_.y[packet], j, static_cast<float>(pixels_[size(p)].y) + within(number / n_));
    }
  }

  void add_colours(std::size_t packet, std::size_t group) {
    sums_[group][0] = sums_[group][0] + samples_.red[packet];
    sums_[group][1] = sums_[group][1] + samples_.green[packet];
    sums_[group][2] = sums_[group][2] + samples_.blue[packet];
  }

  const PictureFrame& frame_;
  const Layers& layers_;
  int n_;
  std::span<std::uint8_t> picture_;
  Samples samples_;
  int count_ = 0;
  std::array<Pixel, kTile * kTile> pixels_{};
  std::array<std::array<Rays, 3>, kTile * kTile / kRays> sums_{};
};

}  // namespace

void draw(const Drawing& drawing, int first, int end, Layers& layers, const Pictures& to) {
  const PictureFrame& frame = drawing.frame;
  const Backdrop* const backdrop = drawing.backdrop;
  const bool has_colour = !to.colour.empty();
  const bool has_geometry = !to.depth.empty() || !to.segmentation.empty() || !to.normals.empty();
  // What a tile's pixels show; `kept` is what the backdrop has of it.
  const auto look_at = [&](const Tile& tile, Found Backdrop::Tile::* kept) {
    Samples samples = grid(frame.camera, tile.x, tile.y);
    if (backdrop == nullptr) {
      find_still(frame, layers, samples);
    } else {
      static_cast<Found&>(samples) = backdrop->tiles[tile.number].*kept;
    }
    if (drawing.into != nullptr) drawing.into->tiles[tile.number].*kept = samples;
    find(frame, layers, false, samples);
    return samples;
  };
  if (has_geometry || drawing.into != nullptr) {
    draw_layers(frame, first, end, 1, true, backdrop == nullptr, layers);
    for_each_tile(frame.camera, first, end, [&](const Tile& tile) {
      const Samples samples = look_at(tile, &Backdrop::Tile::exact);
      if (has_geometry) write_geometry(frame.camera, drawing.seen, samples, tile.x, tile.y, to);
    });
  }
  if (!has_colour) return;
  draw_layers(frame, first, end, 1, false, backdrop == nullptr, layers);
  for_each_tile(frame.camera, first, end, [&](const Tile& tile) {
    if (backdrop != nullptr && !drawing.touched[tile.number]) {
      return copy_colours(frame.camera, tile, backdrop->rough, to.colour);
    }
    Samples samples = look_at(tile, &Backdrop::Tile::shown);
    shade(frame, layers, samples);
    write_colours(frame.camera, samples, tile.x, tile.y, to);
    if (drawing.into != nullptr) drawing.into->tiles[tile.number].lit = samples.lit;
  });
}

void smooth(const Drawing& drawing, std::span<const std::uint8_t> rough, int first, int end, Layers& layers,
            std::span<std::uint8_t> to) {
  const PictureFrame& frame = drawing.frame;
  const Camera& camera = frame.camera;
  draw_layers(frame, first, end, frame.look.antialiasing, false, true, layers);
  for_each_tile(camera, first, end, [&](const Tile& tile) {
    if (drawing.backdrop != nullptr && !is_touched(drawing, tile)) {
      return copy_colours(camera, tile, drawing.backdrop->smooth, to);
    }
    EdgeSamples samples(frame, layers, tile.x, tile.y, to);
    for (int y = tile.y; y < std::min(tile.y + kTile, end); ++y) {
      for_each_edge(camera, rough, tile.x, y, [&](int j) { samples.add(tile.x + j, y); });
    }
    samples.flush();
    if (drawing.into != nullptr) widen(drawing.into->tiles[tile.number].lit, samples.lit());
  });
}

}  // namespace manyhands
