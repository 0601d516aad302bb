// Pictures of scenes: colour, depth, segmentation and normals, on the CPU.
#pragma once

#include "manyhands/render/camera.h"
#include "manyhands/render/look.h"
#include "manyhands/render/scene.h"

namespace manyhands {

/// One picture to take of the model at the configuration q.
struct Shot {
  Camera camera;
  Look look{};
  std::vector<double> q;        ///< (nq)
  std::vector<Mark> marks{};    ///< drawn over it
  Guise guise{};                ///< what differs from the model
  std::vector<double> mocap{};  ///< poses of mocap bodies, as in a Keyframe; empty: where the model has them
};

/// Where n pictures of (height, width) pixels go; rows from the top. Spans that are empty are not wanted.
struct Pictures {
  std::span<std::uint8_t> colour;        ///< (n, height, width, 3) red, green, blue
  std::span<float> depth;                ///< (n, height, width) along the optical axis [m]; `far` where nothing is
  std::span<std::int32_t> segmentation;  ///< (n, height, width) index of the link; -1 where nothing is
  std::span<float> normals;              ///< (n, height, width, 3) unit, in the world; 0 where nothing is

  /// Number i of n.
  [[nodiscard]] Pictures of(std::size_t i, std::size_t n) const;
};

/// Takes pictures with threads of its own. What is see-through (alpha below 1) and marks are in the colour picture
/// only. The same picture whatever the number of threads and the other pictures of a call. Calls from several threads
/// take turns.
class Renderer {
 public:
  /// Threads: 0 takes the variable MANYHANDS_THREADS, else as many as the machine has cores. read: of the files that
  /// geoms show; without it they show their colour.
  explicit Renderer(std::shared_ptr<const Scene> scene, int num_threads = 0, const ImageReader& read = {});
  explicit Renderer(std::shared_ptr<const Model> model, int num_threads = 0, const ImageReader& read = {})
      : Renderer(std::make_shared<const Scene>(std::move(model)), num_threads, read) {}

  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  [[nodiscard]] const Scene& scene() const { return *scene_; }

  /// Throws std::invalid_argument if cameras differ in size, a configuration, a camera, a look or a span has numbers
  /// that do not fit; std::out_of_range on a camera's frame that the model does not have.
  void render(std::span<const Shot> shots, const Pictures& pictures);
  /// X_WC of the shot's camera.
  [[nodiscard]] Transform<double> camera_pose(const Shot& shot);

 private:
  struct Work;
  std::shared_ptr<const Scene> scene_;
  std::unique_ptr<Work> work_;
};

/// A renderer of the model, for whoever has none of his own: those of the last few models are kept.
[[nodiscard]] std::shared_ptr<Renderer> renderer_of(const std::shared_ptr<const Model>& model,
                                                    const ImageReader& read = {});

}  // namespace manyhands
