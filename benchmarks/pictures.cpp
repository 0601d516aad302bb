// Pictures of the PickAndPlace scene: frames a second of one thread and of two, and where the time of a frame goes.
#include "manyhands/envs/pictures.h"

#include <functional>
#include <numbers>

#include "benchmarks/support.h"
#include "manyhands/envs/make.h"

namespace benchmarks {

namespace {

using namespace manyhands;

constexpr int kWorlds = 256;

std::size_t size(int n) { return static_cast<std::size_t>(n); }

Camera camera_of(int width, int height) {
  Camera camera = perspective_camera(width, height, std::numbers::pi / 3);
  camera.X_FC = orbit({0, 0, 0}, 1.4, std::numbers::pi / 4, -std::numbers::pi / 6);
  return camera;
}

struct Wanted {
  bool colour, geometry;  ///< geometry: depth and segmentation
};
constexpr Wanted kAll{true, true}, kColour{true, false}, kGeometry{false, true};

Look unshaded_look() {
  Look look;
  look.shadows = false;
  return look;
}

/// What `env.render()` shows: envs/cameras.py in the Python package.
Look fine_look() {
  Look look;
  look.antialiasing = 2;
  look.shadow_rays = 6;
  look.sun_size = 0.05;
  return look;
}

/// Pictures of the first n worlds, taken again and again.
struct Job {
  Job(const EnvPictures& pictures, int n, int width, int height, Wanted wanted, const Look& look = {},
      const PictureVariation& variation = {}) {
    for (int i = 0; i < n; ++i)
      shots.push_back(pictures.shot(pictures.view(i), camera_of(width, height), look, variation));
    const std::size_t pixels = size(n) * size(width) * size(height);
    if (wanted.colour) colour.resize(3 * pixels);
    if (!wanted.geometry) return;
    depth.resize(pixels);
    segmentation.resize(pixels);
  }

  void take(Renderer& renderer) { renderer.render(shots, {colour, depth, segmentation, {}}); }

  /// Of all numbers.
  [[nodiscard]] std::uint64_t hash() const {
    Hash hash;
    for (const std::uint8_t c : colour) hash.add(c);
    for (const float d : depth) hash.add(d);
    for (const std::int32_t s : segmentation) hash.add(s);
    return hash.value();
  }

  std::vector<Shot> shots;
  std::vector<std::uint8_t> colour;
  std::vector<float> depth;
  std::vector<std::int32_t> segmentation;
};

void print_rate(const std::string& name, int threads, double seconds, const Timing& timing, const Job& job,
                const std::string& wrong = {}, const std::string& note = {}) {
  const double frames = static_cast<double>(job.shots.size());
  print(
      {name, "lanes8", threads, frames / seconds, "frames/s", timing.wall, timing.variation, job.hash(), wrong, note});
}

void run(const Settings& settings) {
  const auto envs = make_env_batch("PandaPickAndPlace-v3", kWorlds);
  std::vector<std::uint64_t> seeds(kWorlds);
  for (std::size_t i = 0; i < seeds.size(); ++i) seeds[i] = i;
  envs->reset({}, seeds);
  EnvPictures one(*envs, 1), two(*envs, 2);

  // The stages of a small picture, by what is left out of it.
  Job all(one, kWorlds, 84, 84, kAll), colours(one, kWorlds, 84, 84, kColour);
  Job unshaded(one, kWorlds, 84, 84, kColour, unshaded_look()), found(one, kWorlds, 84, 84, kGeometry);
  Job tiny(one, kWorlds, 1, 1, kColour, unshaded_look()), large(one, 1, 640, 480, kAll);
  Job fine(one, 1, 84, 84, kColour, fine_look()), large_fine(one, 1, 720, 480, kColour, fine_look());
  Job moving(one, kWorlds, 84, 84, kColour, {}, {.position = 0.01});  // the camera, so that nothing is kept
  Job textured(one, kWorlds, 84, 84, kAll, {}, {.texture = 1});       // on floor, table and cube, in each world others
  std::vector<std::function<void()>> calls;
  for (Job* job : {&all, &colours, &unshaded, &found, &tiny, &large, &fine, &large_fine, &moving, &textured})
    calls.emplace_back([job, &one] { job->take(one.renderer()); });
  const std::vector<Timing> t = time_in_turns<std::function<void()>>(settings, calls);
  print_rate("84 x 84 colour, depth, segmentation", 1, t[0].cpu, t[0], all);
  print_rate("84 x 84 colour", 1, t[1].cpu, t[1], colours);
  print_rate("84 x 84 without shadows", 1, t[2].cpu, t[2], unshaded);
  print_rate("84 x 84 depth, segmentation", 1, t[3].cpu, t[3], found);
  print_rate("640 x 480 with shadows", 1, t[5].cpu, t[5], large);
  print_rate("84 x 84 of env.render()", 1, t[6].cpu, t[6], fine);
  print_rate("720 x 480 of env.render()", 1, t[7].cpu, t[7], large_fine);
  print_rate("84 x 84 colour, each from elsewhere", 1, t[8].cpu, t[8], moving);
  print_rate("84 x 84 with textures", 1, t[9].cpu, t[9], textured);
  const auto stage = [&](const char* name, double seconds) {
    print({std::string("picture stage: ") + name, "lanes8", 1, 1e6 * seconds / kWorlds, "us/frame", 0, 0, 0, {}});
  };
  stage("place", t[4].cpu);
  stage("find and shade", t[2].cpu - t[4].cpu);
  stage("shadows", t[1].cpu - t[2].cpu);
  stage("depth and segmentation", t[0].cpu - t[1].cpu);

  Job many(one, kWorlds, 128, 128, kAll), same = many;
  std::vector<std::function<void()>> batches{[&] { many.take(one.renderer()); }, [&] { same.take(two.renderer()); }};
  const std::vector<Timing> b = time_in_turns<std::function<void()>>(settings, batches);
  print_rate("128 x 128 of 256 worlds", 1, b[0].cpu, b[0], many);
  print_rate("128 x 128 of 256 worlds", 2, b[1].wall, b[1], same,
             many.hash() == same.hash() ? "" : "not the pictures of one thread", "clock on the wall");
}

}  // namespace

}  // namespace benchmarks

int main(int argc, char** argv) {
  benchmarks::run(benchmarks::parse(argc, argv, "Pictures of the PickAndPlace scene."));
}
