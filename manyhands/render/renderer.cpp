#include "manyhands/render/renderer.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "manyhands/physics/dynamics/kinematics.h"
#include "manyhands/render/samples.h"

namespace manyhands {

namespace {

constexpr int kTile = 8;  // pixels: a packet is a row of one

std::size_t size(int n) { return static_cast<std::size_t>(n); }

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

/// Writes a tile that `find` and `shade` have filled, at (x0, y0) of picture `shot`.
void write(const PictureFrame& frame, std::span<const Seen> seen, const Samples& s, std::size_t shot, int x0, int y0,
           const Pictures& to) {
  const Camera& camera = frame.camera;
  const int columns = std::min(kTile, camera.width - x0);
  for (std::size_t k = 0; k < size(s.packets); ++k) {
    const std::size_t at = (shot * size(camera.height) + size(y0) + k) * size(camera.width) + size(x0);
    for (int j = 0; j < columns; ++j) {
      const std::size_t pixel = at + size(j);
      const int number = s.seen[k][j];
      if (!to.colour.empty()) {
        to.colour[3 * pixel] = byte(lane(s.red[k], j));
        to.colour[3 * pixel + 1] = byte(lane(s.green[k], j));
        to.colour[3 * pixel + 2] = byte(lane(s.blue[k], j));
      }
      if (!to.depth.empty()) to.depth[pixel] = lane(s.depth[k], j);
      if (!to.segmentation.empty()) to.segmentation[pixel] = number < 0 ? -1 : seen[size(number)].link.value();
      if (!to.normals.empty()) {
        to.normals[3 * pixel] = number < 0 ? 0 : lane(s.n[k].x, j);
        to.normals[3 * pixel + 1] = number < 0 ? 0 : lane(s.n[k].y, j);
        to.normals[3 * pixel + 2] = number < 0 ? 0 : lane(s.n[k].z, j);
      }
    }
  }
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
  EdgeSamples(const PictureFrame& frame, int x0, int y0, std::span<std::uint8_t> picture)
      : frame_(frame), n_(frame.look.antialiasing), picture_(picture) {
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
      find(frame_, samples_);
      shade(frame_, samples_);
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
  int n_;
  std::span<std::uint8_t> picture_;
  Samples samples_;
  int count_ = 0;
  std::array<Pixel, kTile * kTile> pixels_{};
  std::array<std::array<Rays, 3>, kTile * kTile / kRays> sums_{};
};

void require_size(const char* what, std::size_t found, std::size_t expected) {
  if (found == 0 || found == expected) return;
  throw std::invalid_argument(std::string("the array for ") + what + " has " + std::to_string(found) +
                              " numbers; expected " + std::to_string(expected) + ", or none if it is not wanted");
}

}  // namespace

Renderer::Renderer(std::shared_ptr<const Scene> scene, int num_threads, const ImageReader& read)
    : scene_(std::move(scene)),
      textures_(own_textures(scene_->model().geoms(), read)),
      tree_(scene_->model()),
      mocap_(scene_->model().initial_mocap()),
      pool_(choose_num_threads(num_threads)) {
  for (int i = 0; i < pool_.num_threads(); ++i) {
    workers_.push_back({Workspace<double>(tree_), std::vector<Transform<double>>(size(tree_.nb))});
  }
}

void Renderer::require_fit(std::span<const Shot> shots, const Pictures& pictures) const {
  for (const Shot& shot : shots) {
    const Model& model = scene_->model();
    if (shot.q.size() != size(model.nq())) {
      throw std::invalid_argument("a configuration has " + std::to_string(shot.q.size()) +
                                  " numbers; expected nq = " + std::to_string(model.nq()));
    }
    if (!shot.mocap.empty() && shot.mocap.size() != mocap_.size()) {
      throw std::invalid_argument("the poses of mocap bodies have " + std::to_string(shot.mocap.size()) +
                                  " numbers; expected " + std::to_string(mocap_.size()) + ", 7 each, or none");
    }
    const Guise& guise = shot.guise;
    for (const std::size_t given :
         {guise.rgba.size(), guise.patterns.size(), guise.sizes.size(), guise.textures.size()}) {
      if (given == 0 || given == model.geoms().size()) continue;
      throw std::invalid_argument("there are colours, patterns, sizes or textures of " + std::to_string(given) +
                                  " geoms; expected one for each of " + std::to_string(model.geoms().size()) +
                                  ", or none");
    }
    if (shot.camera.width != shots[0].camera.width || shot.camera.height != shots[0].camera.height) {
      throw std::invalid_argument("the pictures of one call must all have the same width and height");
    }
    if (!shot.camera.frame.empty()) (void)model.frame_id(shot.camera.frame);
    require_camera(shot.camera);
    require_look(shot.look);
  }
  if (shots.empty()) return;
  const std::size_t pixels = shots.size() * size(shots[0].camera.width) * size(shots[0].camera.height);
  require_size("colours", pictures.colour.size(), 3 * pixels);
  require_size("depths", pictures.depth.size(), pixels);
  require_size("the segmentation", pictures.segmentation.size(), pixels);
  require_size("normals", pictures.normals.size(), 3 * pixels);
}

void Renderer::place_bodies(const Shot& shot, Worker& worker) const {
  place_mocap(tree_, shot.mocap.empty() ? mocap_.data() : shot.mocap.data(), worker.bodies);
  forward_kinematics(tree_, shot.q.data(), worker.bodies);
  worker.X_WB[0] = Transform<double>::identity();
  for (std::size_t b = 1; b < worker.X_WB.size(); ++b) {
    worker.X_WB[b] = {worker.bodies.R_WB[b], worker.bodies.p_OB[b] + worker.bodies.p_WO[b]};
  }
}

Transform<double> Renderer::camera_pose(const Shot& shot) {
  const Camera& camera = shot.camera;
  if (camera.frame.empty()) return camera.X_FC;
  const std::scoped_lock lock(mutex_);
  place_bodies(shot, workers_[0]);
  const Frame& mount = scene_->model().frame(scene_->model().frame_id(camera.frame));
  return workers_[0].X_WB[mount.body.index()] * mount.X_BF * camera.X_FC;
}

void Renderer::render(std::span<const Shot> shots, const Pictures& pictures) {
  require_fit(shots, pictures);
  if (shots.empty()) return;
  const std::scoped_lock lock(mutex_);
  frames_.resize(std::max(frames_.size(), shots.size()));
  const int n = static_cast<int>(shots.size()), height = shots[0].camera.height;
  pool_.for_each(n, [&](int shot, int worker) {
    Worker& own = workers_[size(worker)];
    const Shot& of = shots[size(shot)];
    place_bodies(of, own);
    set_frame(frames_[size(shot)], *scene_, of.camera, of.look, own.X_WB, of.marks, of.guise, textures_);
  });

  // Few pictures are cut into bands, so that every thread has work; many are not.
  const int band = n >= 4 * pool_.num_threads() ? height : 2 * kTile, bands = (height + band - 1) / band;
  const auto for_each_band = [&](auto&& body) {
    pool_.for_each(n * bands, [&](int item, int) {
      const int first = item % bands * band;
      body(size(item / bands), first, std::min(first + band, height));
    });
  };
  const bool smooths = !pictures.colour.empty() &&
                       std::ranges::any_of(shots, [](const Shot& shot) { return shot.look.antialiasing > 1; });
  Pictures rough = pictures;
  if (smooths) {
    rough_.resize(pictures.colour.size());
    rough.colour = rough_;
  }
  for_each_band([&](std::size_t shot, int first, int end) { draw(shot, first, end, rough); });
  if (!smooths) return;
  const std::size_t one = pictures.colour.size() / shots.size();
  for_each_band([&](std::size_t shot, int first, int end) {
    smooth(shot, first, end, std::span(rough_).subspan(shot * one, one), pictures.colour.subspan(shot * one, one));
  });
}

std::shared_ptr<Renderer> renderer_of(const std::shared_ptr<const Model>& model, const ImageReader& read) {
  constexpr std::size_t kKept = 8;
  static ProcessMutex mutex;
  static std::vector<std::shared_ptr<Renderer>> kept;  // the last one used stands last
  {
    const std::scoped_lock lock(mutex);
    const auto found = std::ranges::find(kept, model, [](const auto& one) { return one->scene().shared_model(); });
    if (found != kept.end()) {
      std::rotate(found, found + 1, kept.end());
      return kept.back();
    }
  }
  // Without the lock: what reads files may have to wait for who waits for it.
  const auto renderer = std::make_shared<Renderer>(model, 0, read);
  const std::scoped_lock lock(mutex);
  kept.push_back(renderer);
  if (kept.size() > kKept) kept.erase(kept.begin());
  return renderer;
}

void Renderer::draw(std::size_t shot, int first_row, int end_row, const Pictures& pictures) const {
  const PictureFrame& frame = frames_[shot];
  for (int y = first_row; y < end_row; y += kTile) {
    for (int x = 0; x < frame.camera.width; x += kTile) {
      Samples samples = grid(frame.camera, x, y);
      find(frame, samples);
      if (!pictures.colour.empty()) shade(frame, samples);
      write(frame, scene_->seen(), samples, shot, x, y, pictures);
    }
  }
}

void Renderer::smooth(std::size_t shot, int first_row, int end_row, std::span<const std::uint8_t> from,
                      std::span<std::uint8_t> to) const {
  const PictureFrame& frame = frames_[shot];
  const std::size_t row = 3 * size(frame.camera.width);
  std::copy_n(&from[size(first_row) * row], size(end_row - first_row) * row, &to[size(first_row) * row]);
  if (frame.look.antialiasing < 2) return;
  for (int y0 = first_row; y0 < end_row; y0 += kTile) {
    for (int x0 = 0; x0 < frame.camera.width; x0 += kTile) {
      EdgeSamples samples(frame, x0, y0, to);
      for (int y = y0; y < std::min(y0 + kTile, end_row); ++y) {
        for (int x = x0; x < std::min(x0 + kTile, frame.camera.width); ++x) {
          if (is_edge(frame.camera, from, x, y)) samples.add(x, y);
        }
      }
      samples.flush();
    }
  }
}

}  // namespace manyhands
