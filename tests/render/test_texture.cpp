#include <gtest/gtest.h>

#include "tests/render/render_testing.h"

namespace manyhands {
namespace {

using testing::Picture;
using testing::take;
using Point = Vec3<double>;

constexpr std::array<std::uint8_t, 3> kRed{255, 0, 0}, kGreen{0, 255, 0}, kBlue{0, 0, 255}, kWhite{255, 255, 255};

std::shared_ptr<const Image> image_of(int width, int height, std::span<const std::array<std::uint8_t, 3>> pixels) {
  return std::make_shared<const Image>(
      width, height,
      std::span(pixels[0].data(), 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)));
}

/// Red and green above, blue and white below: sharp squares of 32 pixels.
Texture quarters() {
  std::vector<std::array<std::uint8_t, 3>> pixels;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) pixels.push_back(y < 32 ? (x < 32 ? kRed : kGreen) : (x < 32 ? kBlue : kWhite));
  }
  return {image_of(64, 64, pixels)};
}

Texture plain_white() { return {image_of(1, 1, std::span(&kWhite, 1))}; }

struct Thing {
  std::shared_ptr<const Model> model;
  Shot shot;

  Thing(const Shape& shape, const Texture& texture, const Mesh& mesh = {}) {
    ModelBuilder builder("thing");
    Geom geom{.name = "thing", .link = builder.world(), .shape = shape, .rgba = {1, 1, 1, 1}};
    if (!mesh.vertices.empty()) geom.shape.mesh = builder.add_mesh(mesh);
    builder.add_geom(geom);
    model = std::make_shared<const Model>(builder.build());
    shot = {.camera = orthographic_camera(64, 64, 2.2), .q = {}};
    shot.look.shadows = false;
    shot.look.sun = 0;
    shot.look.ambient = 1;
    shot.guise.textures = {texture};
  }

  Picture from(const Point& eye, const Point& up = {0, 0, 1}) {
    shot.camera.X_FC = look_at(eye, {0, 0, 0}, up);
    Renderer renderer(model, 1);
    return take(renderer, shot);
  }
};

/// "r", "g", "b" or "w", or what else a pixel is.
std::string colour_at(const Picture& picture, int x, int y) {
  const std::uint8_t* const c = &picture.colour[3 * static_cast<std::size_t>(64 * y + x)];
  const bool red = c[0] > 130, green = c[1] > 130, blue = c[2] > 130;
  if (red && green && blue) return "w";
  if (red + green + blue != 1) return std::to_string(c[0]) + "," + std::to_string(c[1]) + "," + std::to_string(c[2]);
  return red ? "r" : green ? "g" : "b";
}

/// The colours of the quarters of the picture, row by row.
std::string quarters_of(const Picture& picture) {
  return colour_at(picture, 22, 22) + colour_at(picture, 42, 22) + colour_at(picture, 22, 42) +
         colour_at(picture, 42, 42);
}

TEST(Image, GivesItsPixelsBetweenThemAndAsFarAsAsked) {
  const std::array<std::array<std::uint8_t, 3>, 6> pixels{{kRed, kGreen, kBlue, kWhite, {0, 0, 0}, {188, 0, 0}}};
  const auto image = image_of(3, 2, pixels);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / 3, v = (static_cast<float>(y) + 0.5f) / 2;
      for (const float turns : {0.0f, -2.0f, 7.0f}) {
        const Lanes4 at = image->mean_at(u + turns, v - turns, 0.1f);
        for (std::size_t c = 0; c < 3; ++c) {
          const auto byte = static_cast<float>(pixels[static_cast<std::size_t>(3 * y + x)][c]);
          EXPECT_NEAR(lane(at, static_cast<int>(c)), linear_light(byte / 255), 1e-5f) << x << ", " << y;
        }
      }
    }
  }
  EXPECT_NEAR(lane(image->mean_at(1 / 3.0f, 0.25f, 1), 0), 0.5f, 1e-5f);  // between red and green
  EXPECT_NEAR(lane(image->mean_at(0, 0.25f, 1), 2), 0.5f, 1e-5f);         // red, and blue on the other side
  const Lanes4 all = image->mean_at(0.3f, 0.9f, 100);
  EXPECT_NEAR(lane(all, 0), (2 + linear_light(188.0f / 255)) / 6, 1e-5f);
  EXPECT_NEAR(lane(all, 1), 2 / 6.0f, 1e-5f);
  for (const float odd : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    EXPECT_TRUE(std::isfinite(lane(image->mean_at(odd, odd, odd), 0)));
  }
}

TEST(Image, RefusesWhatItCannotBe) {
  const std::vector<std::uint8_t> few(12);
  EXPECT_THROW(Image(2, 3, few), std::invalid_argument);
  EXPECT_THROW(Image(0, 3, few), std::invalid_argument);
  EXPECT_THROW(Image(4097, 1, few), std::invalid_argument);
  EXPECT_NO_THROW(Image(2, 2, few));
}

TEST(Texture, IsUprightOnEverySideOfABox) {
  Thing box({.type = ShapeType::kBox, .size = {1, 0.9, 0.8}}, quarters());
  for (const Point& eye : {Point{3, 0, 0}, Point{-3, 0, 0}, Point{0, 3, 0}, Point{0, -3, 0}}) {
    EXPECT_EQ(quarters_of(box.from(eye)), "rgbw") << eye.x << ", " << eye.y;
  }
  EXPECT_EQ(quarters_of(box.from({0, 0, 3}, {0, 1, 0})), "rgbw");
  EXPECT_EQ(quarters_of(box.from({0, 0, -3}, {0, 1, 0})), "rgbw");
}

TEST(Texture, LiesOnAMeshAsOnTheBoxThatHoldsIt) {
  Mesh cube;
  for (int k = 0; k < 8; ++k) {
    cube.vertices.push_back({k & 1 ? 1.0f : -1.0f, k & 2 ? 0.9f : -0.9f, k & 4 ? 0.8f : -0.8f});
  }
  cube.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  Thing box({.type = ShapeType::kBox, .size = {1, 0.9, 0.8}}, quarters()),
      mesh({.type = ShapeType::kMesh}, quarters(), cube);
  box.shot.guise.textures[0].repeat = mesh.shot.guise.textures[0].repeat = {3, 2};
  const Picture expected = box.from({3, -2, 1.5}), found = mesh.from({3, -2, 1.5});
  int far = 0;
  for (std::size_t i = 0; i < expected.colour.size(); ++i) far += std::abs(expected.colour[i] - found.colour[i]) > 4;
  EXPECT_LT(far, 30);  // of 12288: edges
}

TEST(Texture, GoesAroundWhatIsRound) {
  for (const ShapeType type : {ShapeType::kSphere, ShapeType::kCylinder, ShapeType::kCapsule}) {
    const Shape shape{.type = type, .size = {1, type == ShapeType::kCapsule ? 0.1 : 1, 0}};
    Thing round(shape, quarters());
    // Along y the image's left half is seen, along -y the right one; where x points it begins, where -x points its
    // halves meet.
    EXPECT_EQ(quarters_of(round.from({0, 3, 0})), "rrbb");
    EXPECT_EQ(quarters_of(round.from({0, -3, 0})), "ggww");
    EXPECT_EQ(quarters_of(round.from({3, 0, 0})), "grwb");
    EXPECT_EQ(quarters_of(round.from({-3, 0, 0})), "rgbw");
    round.shot.guise.textures[0].repeat = {2, 1};
    EXPECT_EQ(quarters_of(round.from({0, 3, 0})), "rgbw");
    round.shot.guise.textures[0].repeat = {1, 2};
    EXPECT_EQ(colour_at(round.from({0, 3, 0}), 32, 24), "b");
    EXPECT_EQ(colour_at(round.from({0, 3, 0}), 32, 40), "r");
  }
  Thing can({.type = ShapeType::kCylinder, .size = {1, 1, 0}}, quarters());
  EXPECT_EQ(quarters_of(can.from({0, 0, 3}, {0, 1, 0})), "rgbw");
}

TEST(Texture, LiesOnEveryMetreOfAPlane) {
  Thing plane({.type = ShapeType::kPlane}, quarters());
  plane.shot.camera = orthographic_camera(64, 64, 3.2);  // 5 cm a pixel
  plane.shot.guise.textures[0].repeat = {1, 2};
  const Picture picture = plane.from({0, 0, 1}, {0, 1, 0});
  for (int j = 0; j < 64; ++j) {
    for (int i = 0; i < 64; ++i) {
      const double x = 0.05 * (i - 31.5), y = -0.05 * (j - 31.5);
      const double u = x - std::floor(x), v = -2 * y - std::floor(-2 * y);
      if (std::abs(u - 0.5) < 0.06 || std::abs(v - 0.5) < 0.11 || std::abs(u - 0.5) > 0.44 ||
          std::abs(v - 0.5) > 0.39) {
        continue;
      }
      ASSERT_EQ(colour_at(picture, i, j), v < 0.5 ? (u < 0.5 ? "r" : "g") : (u < 0.5 ? "b" : "w")) << i << ", " << j;
    }
  }
}

/// Means of the linear light of 8 x 8 pixels of a picture (512, 512), as bytes of screens.
std::vector<double> means_of(const Picture& fine) {
  std::vector<double> means;
  for (std::size_t j = 0; j < 64; ++j) {
    for (std::size_t i = 0; i < 64; ++i) {
      double sum = 0;
      for (std::size_t k = 0; k < 64; ++k) {
        const std::uint8_t byte = fine.colour[3 * (512 * (8 * j + k / 8) + 8 * i + k % 8)];
        sum += static_cast<double>(linear_light(static_cast<float>(byte) / 255)) / 64;
      }
      means.push_back(255 * (sum <= 0.0031308 ? 12.92 * sum : 1.055 * std::pow(sum, 1 / 2.4) - 0.055));
    }
  }
  return means;
}

/// Squares from some pixels wide down to a hundredth of one: compared with 64 samples of each pixel.
TEST(Texture, HasNoMoireWhereItIsFine) {
  for (const float repeat : {7.0f, 23.0f, 61.0f, 313.0f, 5000.0f}) {
    Thing plane({.type = ShapeType::kPlane}, {checker_image({1, 1, 1}, {0, 0, 0}), {repeat, repeat}});
    plane.shot.camera = perspective_camera(64, 64, 0.4);
    const Picture picture = plane.from({0, -1.4, 0.5});
    plane.shot.camera = perspective_camera(512, 512, 0.4);
    const std::vector<double> truth = means_of(plane.from({0, -1.4, 0.5}));
    double squares = 0, most = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const double error = picture.colour[3 * i] - truth[i];
      squares += error * error / static_cast<double>(truth.size());
      most = std::max(most, std::abs(error));
    }
    EXPECT_LT(std::sqrt(squares), 13) << repeat;  // of 255, most of it at the edges of squares
    EXPECT_LT(most, repeat < 60 ? 90 : repeat < 300 ? 16 : 4) << repeat;
  }
}

TEST(Texture, MultipliesTheColourAndChangesNothingElse) {
  const auto model = testing::zoo(3);
  Renderer renderer(model, 1);
  Shot shot{.camera = perspective_camera(80, 60, 1), .q = model->initial_configuration()};
  shot.camera.X_FC = orbit({0, 0, 0.4}, 3.2, 0.7, -0.45);
  shot.guise.patterns.resize(model->geoms().size(), Pattern::kPlain);
  const Picture without = take(renderer, shot);
  shot.guise.textures.resize(model->geoms().size(), plain_white());
  const Picture white = take(renderer, shot);
  for (std::size_t i = 0; i < white.colour.size(); ++i) ASSERT_NEAR(white.colour[i], without.colour[i], 1);
  shot.guise.textures[4] = quarters();
  const Picture one = take(renderer, shot);
  EXPECT_NE(one.colour, white.colour);
  EXPECT_EQ(one.depth, without.depth);
  EXPECT_EQ(one.segmentation, without.segmentation);
  EXPECT_EQ(one.normals, without.normals);
  const int link = model->geoms()[4].link.value();
  for (std::size_t i = 0; i < one.segmentation.size(); ++i) {
    if (one.segmentation[i] == link) continue;
    for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(one.colour[3 * i + c], white.colour[3 * i + c]);
  }
}

TEST(Texture, IsTheSameWhateverTheThreadsAndTheOthersOfTheCall) {
  const auto model = testing::zoo(5);
  Renderer one(model, 1), three(model, 3);
  Shot shot{.camera = perspective_camera(75, 61, 1), .q = model->initial_configuration()};
  shot.camera.X_FC = orbit({0, 0, 0.4}, 3, 0.3, -0.4);
  shot.look.antialiasing = 2;
  shot.guise.textures.resize(model->geoms().size(), {noise_image({1, 0, 0}, {0, 0, 1}, 7), {3, 2}});
  const Picture alone = take(one, shot);
  EXPECT_EQ(alone.colour, take(three, shot).colour);
  std::vector<Shot> many(9, shot);
  for (std::size_t i = 0; i < many.size(); i += 2) many[i].guise.textures.clear();
  const Picture batch = take(three, many);
  EXPECT_TRUE(std::equal(alone.colour.begin(), alone.colour.end(),
                         batch.colour.begin() + static_cast<std::ptrdiff_t>(alone.colour.size())));
}

TEST(Texture, GrowsWithItsGeom) {
  Thing small({.type = ShapeType::kBox, .size = {0.5, 0.5, 0.5}}, quarters()),
      large({.type = ShapeType::kBox, .size = {1, 0.9, 0.8}}, quarters());
  small.shot.guise.sizes = {{1, 0.9, 0.8}};
  EXPECT_EQ(small.from({3, -2, 1.5}).colour, large.from({3, -2, 1.5}).colour);
}

TEST(Texture, IsSeenOnWhatIsSeeThroughToo) {
  Thing box({.type = ShapeType::kBox, .size = {1, 0.9, 0.8}}, quarters());
  const Picture solid = box.from({0, -3, 0});
  Thing glass = box;
  ModelBuilder builder("glass");
  builder.add_geom(
      {.name = "glass", .link = builder.world(), .shape = box.model->geoms()[0].shape, .rgba = {1, 1, 1, 0.95f}});
  glass.model = std::make_shared<const Model>(builder.build());
  const Picture clear = glass.from({0, -3, 0});
  EXPECT_EQ(quarters_of(clear), "rgbw");
  EXPECT_NE(clear.colour, solid.colour);
}

/// A box and a plane of which files say what they show.
std::shared_ptr<const Model> textured_model() {
  ModelBuilder builder("textured");
  const Shape box{.type = ShapeType::kBox, .size = {1, 1, 1}};
  builder.add_geom({.name = "box",
                    .link = builder.world(),
                    .shape = box,
                    .rgba = {1, 1, 1, 1},
                    .texture = GeomTexture{.file = "quarters"}});
  builder.add_geom({.name = "floor",
                    .link = builder.world(),
                    .X_LG = {Mat3<double>::identity(), {0, 0, -1}},
                    .shape = {.type = ShapeType::kPlane},
                    .texture = GeomTexture{.rgb = {{{1, 0, 0}, {0, 0, 1}}}, .repeat = {0.5f, 2.0f}}});
  return std::make_shared<const Model>(builder.build());
}

TEST(Texture, OfModelsIsReadOnceAndLaidOn) {
  const std::shared_ptr<const Model> model = textured_model();
  std::vector<Geom> geoms(model->geoms().begin(), model->geoms().end());
  geoms.push_back(geoms[0]);
  geoms.emplace_back();
  int reads = 0;
  const std::vector<Texture> own = own_textures(geoms, [&](const std::string& file) {
    EXPECT_EQ(file, "quarters");
    ++reads;
    return quarters().image;
  });
  EXPECT_EQ(reads, 1);
  ASSERT_EQ(own.size(), 4u);
  EXPECT_EQ(own[0], own[2]);
  EXPECT_EQ(own[3].image, nullptr);
  EXPECT_EQ(own[1].repeat, (std::array{0.5f, 2.0f}));
  EXPECT_TRUE(own_textures(std::span(&geoms[3], 1), {}).empty());
}

TEST(Texture, OfModelsIsShownUnlessAShotHasAnother) {
  const std::shared_ptr<const Model> model = textured_model();
  Shot shot{.camera = orthographic_camera(64, 64, 1.9), .q = {}};
  shot.camera.X_FC = look_at(Point{0, -3, 0}, Point{0, 0, 0}, Point{0, 0, 1});
  shot.look.shadows = false;
  shot.look.sun = 0;
  shot.look.ambient = 1;
  Renderer renderer(model, 1, [](const std::string&) { return quarters().image; });
  EXPECT_EQ(quarters_of(take(renderer, shot)), "rgbw");
  shot.guise.textures.resize(2);
  EXPECT_EQ(quarters_of(take(renderer, shot)), "rgbw");
  shot.guise.textures[0] = plain_white();
  EXPECT_EQ(quarters_of(take(renderer, shot)), "wwww");
  shot.guise.textures.clear();
  Renderer without(model, 1);  // files are not read, checks need none
  EXPECT_EQ(quarters_of(take(without, shot)), "wwww");
  shot.camera = orthographic_camera(64, 64, 0.8);  // the image is 2 m wide there and 0.5 m high
  shot.camera.X_FC = look_at(Point{10.5, 0, 0}, Point{10.5, 0, -1}, Point{0, 1, 0});
  const Picture floor = take(without, shot);
  EXPECT_EQ(colour_at(floor, 32, 26) + colour_at(floor, 32, 38) + colour_at(floor, 32, 60), "brb");
}

TEST(Texture, OneForEachGeomIsAskedFor) {
  Thing box({.type = ShapeType::kBox, .size = {1, 1, 1}}, quarters());
  box.shot.guise.textures.resize(2);
  EXPECT_THROW((void)box.from({3, 0, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
