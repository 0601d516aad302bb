// Images on surfaces, in place of one colour.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "manyhands/math/instantiate.h"
#include "manyhands/model/description.h"
#include "manyhands/render/look.h"

namespace manyhands {

/// An image that is repeated without end in both directions. Immutable, shared by scenes and threads.
class Image {
 public:
  /// rgb: (height, width, 3) as screens take it (sRGB), rows from the top. Throws std::invalid_argument unless width
  /// and height lie between 1 and 4096 and `rgb` has as many numbers.
  Image(int width, int height, std::span<const std::uint8_t> rgb);

  /// For another process of the same build.
  [[nodiscard]] std::vector<std::uint8_t> archived() const;
  /// Throws std::invalid_argument on damaged bytes.
  [[nodiscard]] static std::shared_ptr<const Image> unarchived(std::span<const std::uint8_t> bytes);

  [[nodiscard]] int width() const { return levels_[0].width; }
  [[nodiscard]] int height() const { return levels_[0].height; }

  /// The mean linear light (red, green, blue, 0) about a point, over a width of so many pixels of the image: from 0 at
  /// its left edge to 1 at its right edge, and from its upper edge to the lower one.
  [[nodiscard]] Lanes4 mean_at(float u, float v, float pixels) const;

 private:
  Image() = default;

  /// The image at half the size of the one before.
  struct Level {
    int width, height;
    std::vector<std::array<float, 4>> pixels;  // linear light; the fourth number fills the lanes
  };
  std::vector<Level> levels_;
};

/// What a surface shows, multiplied by its colour. Where the image comes to lie follows from the surface's shape:
/// upright on the sides of boxes and of meshes (seen from that side of the box that holds them), around spheres,
/// cylinders and capsules from their lower end to the upper one, and on every metre of a plane.
struct Texture {
  std::shared_ptr<const Image> image{};     ///< none: the surface's own colour
  std::array<float, 2> repeat{1.0f, 1.0f};  ///< how often the image lies there, along its width and its height

  [[nodiscard]] bool operator==(const Texture&) const = default;
};

/// Gives the image of a file, or none where it cannot be shown: this library has no decoder.
using ImageReader = std::function<std::shared_ptr<const Image>(const std::string& file)>;

/// What the geoms show by themselves, one for each; nothing at all if none has a texture. Each file is read once;
/// without `read`, none is shown.
[[nodiscard]] std::vector<Texture> own_textures(std::span<const Geom> geoms, const ImageReader& read);

// ---- images of 128 x 128 pixels by rule; each fits together with itself ------------------------------------------

[[nodiscard]] std::shared_ptr<const Image> checker_image(const Colour& a, const Colour& b);  ///< 2 x 2 squares
[[nodiscard]] std::shared_ptr<const Image> stripe_image(const Colour& a,
                                                        const Colour& b);  ///< upright: a left, b right
/// Clouds between two colours: value noise of four octaves.
[[nodiscard]] std::shared_ptr<const Image> noise_image(const Colour& a, const Colour& b, std::uint64_t seed);

/// Checkers, stripes and noise in many colours, always the same: what randomised pictures choose from.
[[nodiscard]] std::span<const std::shared_ptr<const Image>> assorted_images();

}  // namespace manyhands
