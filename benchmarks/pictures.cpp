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

/// Pictures of the first n worlds, taken again and again.
struct Job {
  Job(const EnvPictures& pictures, int n, int width, int height, bool with_colour, bool shadows,
      const PictureVariation& variation = {}) {
    Look look;
    look.shadows = shadows;
    for (int i = 0; i < n; ++i)
      shots.push_back(pictures.shot(pictures.view(i), camera_of(width, height), look, variation));
    const std::size_t pixels = size(n) * size(width) * size(height);
    if (with_colour) colour.resize(3 * pixels);
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

/// What a rasteriser in lanes would have to do at the least, before it fills a pixel: project every vertex of the
/// scene's meshes, and find out of every triangle whether it faces the camera and covers the centre of a pixel.
class Rasteriser {
 public:
  explicit Rasteriser(const Model& model) {
    for (const Mesh& mesh : model.meshes()) {
      const int first = static_cast<int>(x_.size());
      for (const Vec3<float>& v : mesh.vertices) {
        x_.push_back(v.x);
        y_.push_back(v.y);
        z_.push_back(v.z);
      }
      for (const auto& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) corner_[k].push_back(first + t[k]);
      }
    }
    const auto round_up = [](auto& numbers) { numbers.resize((numbers.size() + kRays - 1) / kRays * kRays); };
    for (auto* numbers : {&x_, &y_, &z_}) round_up(*numbers);
    for (auto& numbers : corner_) round_up(numbers);
    column_.resize(x_.size());
    row_.resize(x_.size());
  }

  /// The triangles that are left.
  [[nodiscard]] int set_up(const Camera& camera) {
    const Transform<Rays> X = broadcast<Rays>(inverse(camera.X_FC));
    const Rays fx(static_cast<float>(camera.fx)), fy(static_cast<float>(camera.fy));
    const Rays cx(static_cast<float>(camera.cx)), cy(static_cast<float>(camera.cy));
    for (std::size_t i = 0; i < x_.size(); i += kRays) {
      const Vec3<Rays> p = X * Vec3<Rays>{load<Rays>(&x_[i]), load<Rays>(&y_[i]), load<Rays>(&z_[i])};
      const Rays scale = Rays(1.0f) / p.z;
      store(&column_[i], fma(fx * p.x, scale, cx));
      store(&row_[i], fma(fy * p.y, scale, cy));
    }
    int left = 0;
    for (std::size_t i = 0; i < corner_[0].size(); i += kRays) {
      std::array<Rays, 3> u, v;
      for (std::size_t k = 0; k < 3; ++k) {
        u[k] = gather<Rays>(column_.data(), &corner_[k][i]);
        v[k] = gather<Rays>(row_.data(), &corner_[k][i]);
      }
      const Rays area = (u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0]), half(0.5f);
      const auto covers = [&](const std::array<Rays, 3>& a) {
        const Rays low = min(a[0], min(a[1], a[2])), high = max(a[0], max(a[1], a[2]));
        return floor(low + half) < floor(high + half);
      };
      const RayMask seen = (area < Rays(0.0f)) & covers(u) & covers(v);
      for (int k = 0; k < kRays; ++k) left += lane(seen, k) ? 1 : 0;
    }
    return left;
  }

  [[nodiscard]] std::size_t triangles() const { return corner_[0].size(); }

 private:
  std::vector<float> x_, y_, z_, column_, row_;
  std::array<std::vector<std::int32_t>, 3> corner_;
};

void run(const Settings& settings) {
  const auto envs = make_env_batch("PandaPickAndPlace-v3", kWorlds);
  std::vector<std::uint64_t> seeds(kWorlds);
  for (std::size_t i = 0; i < seeds.size(); ++i) seeds[i] = i;
  envs->reset({}, seeds);
  EnvPictures one(*envs, 1), two(*envs, 2);

  // The stages of a small picture, by what is left out of it.
  Job all(one, 1, 84, 84, true, true), unshaded(one, 1, 84, 84, true, false), found(one, 1, 84, 84, false, false);
  Job tiny(one, 1, 1, 1, true, true), large(one, 1, 640, 480, true, true);
  Job textured(one, kWorlds, 84, 84, true, true, {.texture = 1});  // on floor, table and cube, in each world others
  Rasteriser rasteriser(one.model());
  int left = 0;
  std::vector<std::function<void()>> calls;
  for (Job* job : {&all, &unshaded, &found, &tiny, &large, &textured})
    calls.emplace_back([job, &one] { job->take(one.renderer()); });
  calls.emplace_back([&] { left = rasteriser.set_up(camera_of(84, 84)); });
  const std::vector<Timing> t = time_in_turns<std::function<void()>>(settings, calls);
  print_rate("84 x 84 colour, depth, segmentation", 1, t[0].cpu, t[0], all);
  print_rate("84 x 84 without shadows", 1, t[1].cpu, t[1], unshaded);
  print_rate("84 x 84 depth, segmentation", 1, t[2].cpu, t[2], found);
  print_rate("640 x 480 with shadows", 1, t[4].cpu, t[4], large);
  print_rate("84 x 84 with textures", 1, t[5].cpu, t[5], textured);
  const auto stage = [&](const char* name, double seconds) {
    print({std::string("picture stage: ") + name, "lanes8", 1, 1e6 * seconds, "us/frame", 0, 0, 0, {}});
  };
  stage("place", t[3].cpu);
  stage("find", t[2].cpu - t[3].cpu);
  stage("shade", t[1].cpu - t[2].cpu);
  stage("shadows", t[0].cpu - t[1].cpu);
  print({"picture prototype: a rasteriser before it fills pixels",
         "lanes8",
         1,
         1e6 * t[6].cpu,
         "us/frame",
         0,
         0,
         0,
         {},
         std::to_string(rasteriser.triangles()) + " triangles, of which " + std::to_string(left) + " may be seen"});

  Job many(one, kWorlds, 128, 128, true, true), same = many;
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
