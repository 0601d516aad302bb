#include "manyhands/render/renderer.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "manyhands/physics/dynamics/kinematics.h"
#include "manyhands/render/drawing.h"
#include "manyhands/render/shadows.h"

namespace manyhands {

namespace {

std::size_t size(int n) { return static_cast<std::size_t>(n); }

void require_size(const char* what, std::size_t found, std::size_t expected) {
  if (found == 0 || found == expected) return;
  throw std::invalid_argument(std::string("the array for ") + what + " has " + std::to_string(found) +
                              " numbers; expected " + std::to_string(expected) + ", or none if it is not wanted");
}

bool smooths(const PictureFrame& frame, const Pictures& to) {
  return frame.look.antialiasing > 1 && !to.colour.empty();
}

/// Rows that are drawn in one go: so few that they stay in the processor's cache, and every thread has some.
int band_of(const Camera& camera, int num_threads) {
  constexpr int kPixels = 1 << 14;
  const int rows = std::min(kPixels / camera.width, (camera.height + num_threads - 1) / num_threads);
  return std::max((rows + kTile - 1) / kTile, 1) * kTile;
}

}  // namespace

Pictures Pictures::of(std::size_t i, std::size_t n) const {
  const auto part = [&](auto all) { return all.subspan(i * (all.size() / n), all.size() / n); };
  return {part(colour), part(depth), part(segmentation), part(normals)};
}

Renderer::Renderer(std::shared_ptr<const Scene> scene, int num_threads, const ImageReader& read)
    : scene_(std::move(scene)),
      textures_(own_textures(scene_->model().geoms(), read)),
      tree_(scene_->model()),
      mocap_(scene_->model().initial_mocap()),
      pool_(choose_num_threads(num_threads)) {
  for (int i = 0; i < pool_.num_threads(); ++i) {
    workers_.emplace_back(Workspace<double>(tree_)).X_WB.resize(size(tree_.nb));
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

void Renderer::prepare(const Shot& shot, PictureFrame& frame, Worker& worker) const {
  place_bodies(shot, worker);
  set_frame(frame, *scene_, shot.camera, shot.look, worker.X_WB, shot.marks, shot.guise, textures_);
  set_suns(frame);
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
  const int n = static_cast<int>(shots.size()), height = shots[0].camera.height;
  if (n >= 4 * pool_.num_threads()) {
    pool_.for_each(n, [&](int shot, int worker) {
      Worker& own = workers_[size(worker)];
      PictureFrame& frame = own.frame;
      prepare(shots[size(shot)], frame, own);
      for (int i = 0; i < static_cast<int>(frame.suns.size()); ++i) draw_sun(frame, i);
      const Pictures to = pictures.of(size(shot), shots.size());
      draw(frame, scene_->seen(), 0, height, own.layers, to);
      if (smooths(frame, to)) {
        own.rough.assign(to.colour.begin(), to.colour.end());
        smooth(frame, own.rough, 0, height, own.layers, to.colour);
      }
    });
    return;
  }
  // Few pictures are cut into bands, so that every thread has work.
  for (std::size_t shot = 0; shot < shots.size(); ++shot) {
    PictureFrame& frame = workers_[0].frame;
    prepare(shots[shot], frame, workers_[0]);
    pool_.for_each(static_cast<int>(frame.suns.size()), [&](int i, int) { draw_sun(frame, i); });
    const Pictures to = pictures.of(shot, shots.size());
    const int band = band_of(frame.camera, pool_.num_threads()), bands = (height + band - 1) / band;
    const auto for_each_band = [&](auto&& body) {
      pool_.for_each(bands, [&](int item, int worker) {
        body(item * band, std::min((item + 1) * band, height), workers_[size(worker)].layers);
      });
    };
    for_each_band([&](int first, int end, Layers& layers) { draw(frame, scene_->seen(), first, end, layers, to); });
    if (!smooths(frame, to)) continue;
    std::vector<std::uint8_t>& rough = workers_[0].rough;
    rough.assign(to.colour.begin(), to.colour.end());
    for_each_band([&](int first, int end, Layers& layers) { smooth(frame, rough, first, end, layers, to.colour); });
  }
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

}  // namespace manyhands
