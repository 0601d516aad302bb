// What of a model can be seen, as rays meet it.
#pragma once

#include <memory>
#include <vector>

#include "manyhands/model/model.h"
#include "manyhands/render/texture.h"

namespace manyhands {

class Triangles;

enum class Pattern : std::uint8_t {
  kPlain,
  kChecks,  ///< on planes: squares of 0.5 m
  kDie,     ///< on boxes: a colour for each face
};

/// What a geom wears unless it is told otherwise.
[[nodiscard]] Pattern usual_pattern(const Geom& geom);

/// One geom as it is seen.
struct Seen {
  LinkId link{};  ///< invalid for marks
  GeomId geom{};
  std::array<float, 4> rgba{};
  Pattern pattern = Pattern::kPlain;
  Vec3<float> low{}, high{};  ///< of a box that holds it, in the axes of its item [m]; not for planes
};

/// What rays are tried against in one go: a simple shape, or triangles that move together.
struct Item {
  BodyId body{};
  Transform<float> X_BI = Transform<float>::identity();
  ShapeType type = ShapeType::kSphere;  ///< kMesh: `triangles`
  Vec3<float> size{};                   ///< see Shape [m]
  std::shared_ptr<const Triangles> triangles{};
  Vec3<float> low{}, high{};  ///< of a box that holds it, in I [m]; not for planes
  int first_seen = 0;         ///< what it shows: for triangles, that of part 0
  int num_seen = 1;           ///< for triangles, one of each part
  bool is_clear = false;      ///< one sees through it: alpha below 1
};

/// A shape that is drawn over a picture, but is not part of the world: in colour only, without shadow.
struct Mark {
  Shape shape{};  ///< of a kind without mesh or heights
  std::array<float, 4> rgba{0.1f, 0.9f, 0.1f, 0.4f};
  Transform<double> X_WM = Transform<double>::identity();
  Pattern pattern = Pattern::kPlain;
};

/// How a picture's geoms differ from the model's. Each list has one entry for every geom of the model, or none at all.
struct Guise {
  std::vector<std::array<float, 4>> rgba{};
  std::vector<Pattern> patterns{};
  std::vector<Vec3<double>> sizes{};  ///< of simple shapes, see Shape [m]; x = 0: the model's
  std::vector<Texture> textures{};    ///< take the place of the model's, of floors' checks and of dice
};

/// Immutable, shared by renderers and threads. Visual geoms are seen, and those that collide on links without visual
/// ones; geoms whose alpha is 0 are not.
class Scene {
 public:
  explicit Scene(std::shared_ptr<const Model> model);

  [[nodiscard]] const Model& model() const { return *model_; }
  [[nodiscard]] std::shared_ptr<const Model> shared_model() const { return model_; }
  [[nodiscard]] std::span<const Item> items() const { return items_; }
  [[nodiscard]] std::span<const Seen> seen() const { return seen_; }

 private:
  std::shared_ptr<const Model> model_;
  std::vector<Item> items_;
  std::vector<Seen> seen_;
};

/// The item of a simple shape. Throws std::invalid_argument on meshes and height fields, or a size that is not above 0.
[[nodiscard]] Item item_of(const Shape& shape);

}  // namespace manyhands
