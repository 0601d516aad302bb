#include "manyhands/render/renderer.h"

#include <algorithm>
#include <mutex>
#include <stdexcept>
#include <string>

#include "manyhands/base/process_mutex.h"
#include "manyhands/base/thread_pool.h"
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

constexpr std::size_t kMostKept = std::size_t{1} << 21;  // pixels of a picture whose backdrop is kept

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

struct Renderer::Work {
  struct Worker {
    explicit Worker(Workspace<double> of) : bodies(std::move(of)) {}
    Workspace<double> bodies;
    std::vector<Transform<double>> X_WB{};
    PictureFrame frame{};
    Layers layers{};
    std::vector<std::uint8_t> rough{};  // colours before edges are smoothed
  };

  Work(const Scene& of, int num_threads, const ImageReader& read);
  void require_fit(std::span<const Shot> shots, const Pictures& pictures) const;
  void place_bodies(const Shot& shot, Worker& worker) const;

  // for_each(n, body) calls body(i, worker) for i in [0, n), by one thread or by several; bands are of so many rows.
  template <class ForEach>
  void take(const Shot& shot, int band, int worker, const ForEach& for_each, const Pictures& to);
  template <class ForEach>
  void paint(const Drawing& drawing, int band, const ForEach& for_each, const Pictures& to,
             std::vector<std::uint8_t>& rough);
  template <class ForEach>
  [[nodiscard]] std::shared_ptr<const Backdrop> draw_backdrop(const PictureFrame& still, int band,
                                                              const ForEach& for_each);

  const Scene& scene;
  std::vector<Texture> textures;  // the geoms' own
  Tree<double> tree;
  std::vector<double> mocap;  // where the model has these bodies
  ThreadPool pool;
  std::vector<Worker> workers;
  Backdrops backdrops;
  ProcessMutex mutex;
};

Renderer::Work::Work(const Scene& of, int num_threads, const ImageReader& read)
    : scene(of),
      textures(own_textures(scene.model().geoms(), read)),
      tree(scene.model()),
      mocap(scene.model().initial_mocap()),
      pool(choose_num_threads(num_threads)) {
  for (int i = 0; i < pool.num_threads(); ++i) {
    workers.emplace_back(Workspace<double>(tree)).X_WB.resize(size(tree.nb));
  }
}

void Renderer::Work::require_fit(std::span<const Shot> shots, const Pictures& pictures) const {
  for (const Shot& shot : shots) {
    const Model& model = scene.model();
    if (shot.q.size() != size(model.nq())) {
      throw std::invalid_argument("a configuration has " + std::to_string(shot.q.size()) +
                                  " numbers; expected nq = " + std::to_string(model.nq()));
    }
    if (!shot.mocap.empty() && shot.mocap.size() != mocap.size()) {
      throw std::invalid_argument("the poses of mocap bodies have " + std::to_string(shot.mocap.size()) +
                                  " numbers; expected " + std::to_string(mocap.size()) + ", 7 each, or none");
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

void Renderer::Work::place_bodies(const Shot& shot, Worker& worker) const {
  place_mocap(tree, shot.mocap.empty() ? mocap.data() : shot.mocap.data(), worker.bodies);
  forward_kinematics(tree, shot.q.data(), worker.bodies);
  worker.X_WB[0] = Transform<double>::identity();
  for (std::size_t b = 1; b < worker.X_WB.size(); ++b) worker.X_WB[b] = body_pose(b, worker.bodies);
}

template <class ForEach>
void Renderer::Work::take(const Shot& shot, int band, int worker, const ForEach& for_each, const Pictures& to) {
  Worker& own = workers[size(worker)];
  PictureFrame& frame = own.frame;
  place_bodies(shot, own);
  set_frame(frame, scene, shot.camera, shot.look, own.X_WB, shot.marks, shot.guise, textures);
  set_suns(frame);
  Drawing drawing{.frame = frame, .seen = scene.seen()};
  std::shared_ptr<const Backdrop> backdrop;
  if (frame.num_still > 0 && size(frame.camera.width) * size(frame.camera.height) <= kMostKept) {
    const BackdropKey key = backdrop_key(frame);
    bool is_wanted = false;
    backdrop = backdrops.find(key, is_wanted);
    if (is_wanted) {
      backdrop = draw_backdrop(still_part(frame), band, for_each);
      backdrops.keep(key, backdrop);
    }
  }
  if (backdrop != nullptr) {
    drawing.backdrop = backdrop.get();
    drawing.touched = touched_tiles(frame, *backdrop);
  }
  if (!to.colour.empty()) {
    for_each(static_cast<int>(frame.suns.size()), [&](int i, int) { draw_sun(frame, i); });
  }
  paint(drawing, band, for_each, to, own.rough);
}

template <class ForEach>
void Renderer::Work::paint(const Drawing& drawing, int band, const ForEach& for_each, const Pictures& to,
                           std::vector<std::uint8_t>& rough) {
  const int height = drawing.frame.camera.height;
  const auto for_each_band = [&](auto&& body) {
    for_each((height + band - 1) / band, [&](int item, int worker) {
      body(item * band, std::min((item + 1) * band, height), workers[size(worker)].layers);
    });
  };
  for_each_band([&](int first, int end, Layers& layers) { draw(drawing, first, end, layers, to); });
  if (to.colour.empty() || drawing.frame.look.antialiasing < 2) return;
  rough.assign(to.colour.begin(), to.colour.end());
  for_each_band([&](int first, int end, Layers& layers) { smooth(drawing, rough, first, end, layers, to.colour); });
}

template <class ForEach>
std::shared_ptr<const Backdrop> Renderer::Work::draw_backdrop(const PictureFrame& still, int band,
                                                              const ForEach& for_each) {
  const Camera& camera = still.camera;
  const auto tiles = [](int pixels) { return size((pixels + kTile - 1) / kTile); };
  const auto made = std::make_shared<Backdrop>();
  made->tiles.resize(tiles(camera.width) * tiles(camera.height));
  made->smooth.resize(3 * size(camera.width) * size(camera.height));
  Drawing drawing{.frame = still, .seen = scene.seen()};
  drawing.into = made.get();
  paint(drawing, band, for_each, {.colour = made->smooth, .depth = {}, .segmentation = {}, .normals = {}}, made->rough);
  if (made->rough.empty()) made->rough = made->smooth;
  return made;
}

Renderer::Renderer(std::shared_ptr<const Scene> scene, int num_threads, const ImageReader& read)
    : scene_(std::move(scene)), work_(std::make_unique<Work>(*scene_, num_threads, read)) {}

Renderer::~Renderer() = default;

Transform<double> Renderer::camera_pose(const Shot& shot) {
  const Camera& camera = shot.camera;
  if (camera.frame.empty()) return camera.X_FC;
  const std::scoped_lock lock(work_->mutex);
  work_->place_bodies(shot, work_->workers[0]);
  const Frame& mount = scene_->model().frame(scene_->model().frame_id(camera.frame));
  return work_->workers[0].X_WB[mount.body.index()] * mount.X_BF * camera.X_FC;
}

void Renderer::render(std::span<const Shot> shots, const Pictures& pictures) {
  work_->require_fit(shots, pictures);
  if (shots.empty()) return;
  const std::scoped_lock lock(work_->mutex);
  const int n = static_cast<int>(shots.size()), num_threads = work_->pool.num_threads();
  if (n >= 4 * num_threads) {
    work_->pool.for_each(n, [&](int shot, int worker) {
      const auto in_turn = [&](int count, auto&& body) {
        for (int i = 0; i < count; ++i) body(i, worker);
      };
      const int band = band_of(shots[size(shot)].camera, 1);
      work_->take(shots[size(shot)], band, worker, in_turn, pictures.of(size(shot), shots.size()));
    });
    return;
  }
  // Few pictures are cut into bands, so that every thread has work.
  const auto by_all = [&](int count, auto&& body) { work_->pool.for_each(count, body); };
  for (std::size_t shot = 0; shot < shots.size(); ++shot) {
    const int band = band_of(shots[shot].camera, num_threads);
    work_->take(shots[shot], band, 0, by_all, pictures.of(shot, shots.size()));
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
