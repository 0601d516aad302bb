#include "manyhands/render/drawing.h"

#include <algorithm>
#include <cstdlib>

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

/// Draws the meshes that the rows from `first` to before `end` show.
void draw_layers(const PictureFrame& frame, int first, int end, int scale, bool is_exact, Layers& layers) {
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
  for (std::size_t i = 0; i < frame.solid.size(); ++i) {
    draw_into(i < frame.num_still ? layers.still : layers.moving, frame.solid[i], i);
  }
  for (std::size_t i = 0; i < frame.clear.size(); ++i) {
    layers.clear[i].begin(part, true);
    draw_into(layers.clear[i], frame.clear[i], i);
  }
}

void find_all(const PictureFrame& frame, const Layers& layers, Samples& samples) {
  clear(frame, samples);
  for (const bool still : {true, false}) find(frame, layers, still, samples);
}

Samples grid(const Camera& camera, int x0, int y0) {
  Samples s;
  s.packets = std::min(kTile, camera.height - y0);
  const float left = static_cast<float>(x0), top = static_cast<float>(y0);
  s.part = {left, left + kTile, top, top + kTile};
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

/// Whether a pixel of a colour picture differs visibly from one beside it.
bool is_edge(const Camera& camera, std::span<const std::uint8_t> picture, int x, int y) {
  constexpr int kVisible = 10;
  const std::uint8_t* const own = &picture[3 * (size(y) * size(camera.width) + size(x))];
  const auto differs = [&](int dx, int dy) {
    if (x + dx < 0 || y + dy < 0 || x + dx >= camera.width || y + dy >= camera.height) return false;
    const std::uint8_t* const other = &picture[3 * (size(y + dy) * size(camera.width) + size(x + dx))];
    for (int c = 0; c < 3; ++c) {
      if (std::abs(own[c] - other[c]) > kVisible) return true;
    }
    return false;
  };
  return differs(1, 0) || differs(-1, 0) || differs(0, 1) || differs(0, -1);
}

/// Takes n x n samples of each of some pixels of a tile, and writes their means. A packet holds the same sample of
/// eight pixels.
class EdgeSamples {
 public:
  EdgeSamples(const PictureFrame& frame, const Layers& layers, int x0, int y0, std::span<std::uint8_t> picture)
      : frame_(frame), layers_(layers), n_(layers.scale), picture_(picture) {
    samples_.part = {static_cast<float>(x0), static_cast<float>(x0 + kTile), static_cast<float>(y0),
                     static_cast<float>(y0 + kTile)};
    samples_.per_pixel = n_ * n_;
  }

  void add(int x, int y) { pixels_[size(count_++)] = {x, y}; }

  void flush() {
    const int packets = (count_ + kRays - 1) / kRays * n_ * n_;
    for (int first = 0; first < packets; first += Samples::kPackets) {
      samples_.packets = std::min(Samples::kPackets, packets - first);
      for (int k = 0; k < samples_.packets; ++k) place(size(k), (first + k) / (n_ * n_), (first + k) % (n_ * n_));
      find_all(frame_, layers_, samples_);
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

void draw(const PictureFrame& frame, std::span<const Seen> seen, int first, int end, Layers& layers,
          const Pictures& to) {
  const bool has_geometry = !to.depth.empty() || !to.segmentation.empty() || !to.normals.empty();
  const bool is_exact = std::ranges::all_of(frame.solid, [](const PlacedItem& placed) {
    return placed.item->triangles == nullptr || placed.shown == &placed.item->triangles->exact();
  });
  const auto for_each_tile = [&](auto&& visit) {
    for (int y = first; y < end; y += kTile) {
      for (int x = 0; x < frame.camera.width; x += kTile) {
        Samples samples = grid(frame.camera, x, y);
        find_all(frame, layers, samples);
        visit(samples, x, y);
      }
    }
  };
  const auto paint = [&](Samples& samples, int x, int y) {
    shade(frame, layers, samples);
    write_colours(frame.camera, samples, x, y, to);
  };
  if (has_geometry) {
    draw_layers(frame, first, end, 1, true, layers);
    for_each_tile([&](Samples& samples, int x, int y) {
      write_geometry(frame.camera, seen, samples, x, y, to);
      if (is_exact && !to.colour.empty()) paint(samples, x, y);
    });
  }
  if (to.colour.empty() || (has_geometry && is_exact)) return;
  draw_layers(frame, first, end, 1, false, layers);
  for_each_tile(paint);
}

void smooth(const PictureFrame& frame, std::span<const std::uint8_t> rough, int first, int end, Layers& layers,
            std::span<std::uint8_t> to) {
  draw_layers(frame, first, end, frame.look.antialiasing, false, layers);
  for (int y0 = first; y0 < end; y0 += kTile) {
    for (int x0 = 0; x0 < frame.camera.width; x0 += kTile) {
      EdgeSamples samples(frame, layers, x0, y0, to);
      for (int y = y0; y < std::min(y0 + kTile, end); ++y) {
        for (int x = x0; x < std::min(x0 + kTile, frame.camera.width); ++x) {
          if (is_edge(frame.camera, rough, x, y)) samples.add(x, y);
        }
      }
      samples.flush();
    }
  }
}

}  // namespace manyhands
