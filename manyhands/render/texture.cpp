#include "manyhands/render/texture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

#include "manyhands/base/bytes.h"
#include "manyhands/math/philox.h"

namespace manyhands {

namespace {

using Light = Vec3<float>;

constexpr int kLargest = 4096;  // width and height [pixels]
constexpr int kSide = 128;      // of images by rule [pixels]

std::size_t size(int n) { return static_cast<std::size_t>(n); }

/// Linear light of an image while it is made smaller.
struct Grid {
  int width, height;
  std::vector<Light> pixels;

  [[nodiscard]] const Light& at(int x, int y) const { return pixels[size(y) * size(width) + size(x)]; }
};

/// Half as wide: each pixel is the mean of what it covers.
Grid half_width(const Grid& grid) {
  const int width = std::max(1, grid.width / 2);
  const float covers = static_cast<float>(grid.width) / static_cast<float>(width);
  Grid half{width, grid.height, {}};
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float left = covers * static_cast<float>(x), right = covers * static_cast<float>(x + 1);
      Light sum = Light::zero();
      for (int i = static_cast<int>(left); i < grid.width && static_cast<float>(i) < right; ++i) {
        const float share = std::min(right, static_cast<float>(i + 1)) - std::max(left, static_cast<float>(i));
        sum = fma(share, grid.at(i, y), sum);
      }
      half.pixels.push_back((1 / covers) * sum);
    }
  }
  return half;
}

Grid transposed(const Grid& grid) {
  Grid turned{grid.height, grid.width, {}};
  for (int x = 0; x < grid.width; ++x) {
    for (int y = 0; y < grid.height; ++y) turned.pixels.push_back(grid.at(x, y));
  }
  return turned;
}

template <class ColourAt>
std::shared_ptr<const Image> image_of(ColourAt&& colour_at) {
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      for (const float c : colour_at(x, y)) {
        rgb.push_back(static_cast<std::uint8_t>(255 * clamp(c, 0.0f, 1.0f) + 0.5f));
      }
    }
  }
  return std::make_shared<const Image>(kSide, kSide, rgb);
}

Colour mix(float f, const Colour& a, const Colour& b) {
  Colour mixed{};
  for (std::size_t c = 0; c < 3; ++c) mixed[c] = fma(f, b[c] - a[c], a[c]);
  return mixed;
}

/// Random numbers on a grid of `cells` x `cells` that repeats, smoothly joined; 0 to 1.
class Waves {
 public:
  Waves(int cells, RandomStream& random) : cells_(cells) {
    for (int i = 0; i < cells * cells; ++i) corners_.push_back(random.unit<float>());
  }

  [[nodiscard]] float at(int x, int y) const {
    const int wide = kSide / cells_, i = x / wide, j = y / wide;
    const float f = smooth(x % wide, wide), g = smooth(y % wide, wide);
    const float low = std::lerp(corner(i, j), corner(i + 1, j), f);
    return std::lerp(low, std::lerp(corner(i, j + 1), corner(i + 1, j + 1), f), g);
  }

 private:
  static float smooth(int part, int whole) {
    const float f = static_cast<float>(part) / static_cast<float>(whole);
    return f * f * (3 - 2 * f);
  }
  [[nodiscard]] float corner(int i, int j) const {
    return corners_[size(j % cells_) * size(cells_) + size(i % cells_)];
  }

  int cells_;
  std::vector<float> corners_;
};

/// x = mantissa 2^exponent, with a mantissa from 1 to 2; x >= 1, finite or not.
int exponent_of(float x) { return static_cast<int>(std::bit_cast<std::uint32_t>(x) >> 23) - 127; }
float mantissa_of(float x) { return std::bit_cast<float>((std::bit_cast<std::uint32_t>(x) & 0x7fffffU) | 0x3f800000U); }

float fraction(float x) {
  const float f = x - std::floor(x);
  return f >= 0 && f < 1 ? f : 0;  // of what is not finite, too
}

}  // namespace

Image::Image(int width, int height, std::span<const std::uint8_t> rgb) {
  if (width < 1 || height < 1 || width > kLargest || height > kLargest) {
    throw std::invalid_argument("an image of " + std::to_string(width) + " x " + std::to_string(height) +
                                " pixels; expected 1 to " + std::to_string(kLargest));
  }
  if (rgb.size() != 3 * size(width) * size(height)) {
    throw std::invalid_argument("an image of " + std::to_string(width) + " x " + std::to_string(height) +
                                " pixels has " + std::to_string(rgb.size()) + " numbers; expected 3 of each pixel");
  }
  std::array<float, 256> light{};
  for (std::size_t i = 0; i < light.size(); ++i) light[i] = linear_light(static_cast<float>(i) / 255);
  Grid grid{width, height, {}};
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    grid.pixels.push_back({light[rgb[i]], light[rgb[i + 1]], light[rgb[i + 2]]});
  }
  while (true) {
    Level& level = levels_.emplace_back(Level{grid.width, grid.height, {}});
    for (const Light& pixel : grid.pixels) level.pixels.push_back({pixel.x, pixel.y, pixel.z, 0});
    if (grid.width == 1 && grid.height == 1) break;
    grid = transposed(half_width(transposed(half_width(grid))));
  }
}

std::vector<std::uint8_t> Image::archived() const {
  ByteWriter out;
  out(levels_.size());
  for (const Level& level : levels_) out(level.width, level.height, level.pixels);
  return out.finish();
}

std::shared_ptr<const Image> Image::unarchived(std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  std::size_t levels = 0;
  in(levels);
  const std::shared_ptr<Image> image(new Image);
  for (; levels > 0; --levels) {
    Level& level = image->levels_.emplace_back();
    in(level.width, level.height, level.pixels);
  }
  return image;
}

Lanes4 Image::mean_at(float u, float v, float pixels) const {
  const float wide = pixels > 1 ? pixels : 1;  // of NaN, too
  const int last = static_cast<int>(levels_.size()) - 1, octave = std::min(exponent_of(wide), last);
  // Along a straight line in place of the logarithm, from one level to the next.
  const float between = octave < last ? mantissa_of(wide) - 1 : 0;
  const float x = fraction(u), y = fraction(v);
  Lanes4 sum(0.0f);
  const auto add = [&](const Level& level, float share) {
    const float a = fma(x, static_cast<float>(level.width), -0.5f), b = fma(y, static_cast<float>(level.height), -0.5f);
    const int i = static_cast<int>(a + 1) - 1, j = static_cast<int>(b + 1) - 1;  // rounded down: neither is below -1/2
    const float f = a - static_cast<float>(i), g = b - static_cast<float>(j);
    const std::size_t left = size(i < 0 ? level.width - 1 : i), right = size(i + 1 < level.width ? i + 1 : 0);
    const auto row = [&](int k, float weight) {
      const std::array<float, 4>* const of_row = &level.pixels[size(k) * size(level.width)];
      sum = fma(Lanes4((1 - f) * weight), load<Lanes4>(of_row[left].data()), sum);
      sum = fma(Lanes4(f * weight), load<Lanes4>(of_row[right].data()), sum);
    };
    row(j < 0 ? level.height - 1 : j, (1 - g) * share);
    row(j + 1 < level.height ? j + 1 : 0, g * share);
  };
  add(levels_[size(octave)], 1 - between);
  if (between > 0) add(levels_[size(octave + 1)], between);
  return sum;
}

std::vector<Texture> own_textures(std::span<const Geom> geoms, const ImageReader& read) {
  std::vector<Texture> textures;
  if (std::ranges::none_of(geoms, [](const Geom& geom) { return geom.texture.has_value(); })) return textures;
  std::map<std::string, std::shared_ptr<const Image>> of_files;
  const auto image_of_file = [&](const std::string& file) {
    const auto [entry, is_new] = of_files.try_emplace(file);
    if (is_new && read) entry->second = read(file);
    return entry->second;
  };
  for (const Geom& geom : geoms) {
    Texture& own = textures.emplace_back();
    if (!geom.texture) continue;
    const auto& [file, rgb, repeat] = *geom.texture;
    own = {file.empty() ? checker_image(rgb[0], rgb[1]) : image_of_file(file), repeat};
  }
  return textures;
}

std::shared_ptr<const Image> checker_image(const Colour& a, const Colour& b) {
  return image_of([&](int x, int y) { return (x < kSide / 2) == (y < kSide / 2) ? a : b; });
}

std::shared_ptr<const Image> stripe_image(const Colour& a, const Colour& b) {
  return image_of([&](int x, int) { return x < kSide / 2 ? a : b; });
}

std::shared_ptr<const Image> noise_image(const Colour& a, const Colour& b, std::uint64_t seed) {
  RandomStream random(seed, 0, 0);
  const std::array<Waves, 4> octaves{Waves(4, random), Waves(8, random), Waves(16, random), Waves(32, random)};
  return image_of([&](int x, int y) {
    float sum = 0, share = 1;
    for (const Waves& waves : octaves) sum += (share *= 0.5f) * (2 * waves.at(x, y) - 1);
    return mix(clamp(0.5f + sum, 0.0f, 1.0f), a, b);
  });
}

std::span<const std::shared_ptr<const Image>> assorted_images() {
  static const std::vector<std::shared_ptr<const Image>> images = [] {
    constexpr int kOfEach = 16;
    RandomStream random(0, 0, 0);
    const auto colour = [&] {
      const float red = random.unit<float>(), green = random.unit<float>(), blue = random.unit<float>();
      return Colour{red, green, blue};
    };
    std::vector<std::shared_ptr<const Image>> made;
    for (int i = 0; i < kOfEach; ++i) {
      const Colour a = colour(), b = colour();
      made.push_back(checker_image(a, b));
      made.push_back(stripe_image(b, a));
      made.push_back(noise_image(a, b, static_cast<std::uint64_t>(i)));
    }
    return made;
  }();
  return images;
}

}  // namespace manyhands
