// Scenes to take pictures of, and what rays in double precision say of them.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "manyhands/math/quaternion.h"
#include "manyhands/model/model_builder.h"
#include "manyhands/physics/world/world.h"
#include "manyhands/render/renderer.h"

namespace manyhands::testing {

inline std::size_t pixels_of(const Camera& camera) {
  return static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
}

struct Picture {
  std::vector<std::uint8_t> colour;
  std::vector<float> depth;
  std::vector<std::int32_t> segmentation;
  std::vector<float> normals;
};

inline Picture take(Renderer& renderer, std::span<const Shot> shots) {
  const std::size_t n = shots.size() * pixels_of(shots[0].camera);
  Picture picture{std::vector<std::uint8_t>(3 * n), std::vector<float>(n), std::vector<std::int32_t>(n),
                  std::vector<float>(3 * n)};
  renderer.render(shots, {picture.colour, picture.depth, picture.segmentation, picture.normals});
  return picture;
}

inline Picture take(Renderer& renderer, const Shot& shot) { return take(renderer, std::span(&shot, 1)); }

/// A closed mesh of the ball with radius r: 2 n meridians and n circles. It is off by r (1 - cos(pi / n)) at most.
inline Mesh ball_mesh(double r, int n) {
  Mesh mesh;
  const auto add = [&](double theta, double phi) {
    mesh.vertices.push_back(broadcast<float>(
        Vec3<double>{r * std::sin(theta) * std::cos(phi), r * std::sin(theta) * std::sin(phi), r * std::cos(theta)}));
  };
  const double step = std::numbers::pi / n;
  add(0, 0);
  for (int i = 1; i < n; ++i) {
    for (int j = 0; j < 2 * n; ++j) add(i * step, j * step);
  }
  add(std::numbers::pi, 0);
  const int last = static_cast<int>(mesh.vertices.size()) - 1;
  const auto at = [&](int i, int j) { return i == 0 ? 0 : i == n ? last : 1 + (i - 1) * 2 * n + j % (2 * n); };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      if (i + 1 < n) mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      if (i > 0) mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

/// A closed mesh of the box with these half extents.
inline Mesh box_mesh(const Vec3<float>& half) {
  Mesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.vertices.push_back({k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// A ground plane and 14 free bodies in the air: two of each simple shape, a hull, a mesh and a height field beside.
inline std::shared_ptr<const Model> zoo(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  ModelBuilder builder("zoo");
  const auto add_fixed = [&](const char* name, const Shape& shape, const Transform<double>& X) {
    builder.add_link(name);
    builder.place_root(LinkId(builder.links().size() - 1), X);
    builder.add_geom({.name = name, .link = LinkId(builder.links().size() - 1), .shape = shape});
  };
  add_fixed("ground", {.type = ShapeType::kPlane}, Transform<double>::identity());
  const auto pose = [&] {
    const Quat<double> r = normalized(Quat<double>{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)});
    return Transform<double>{to_matrix(r), {uniform(-1, 1), uniform(-1, 1), uniform(0.2, 1.2)}};
  };
  int number = 0;
  for (const ShapeType type : {ShapeType::kSphere, ShapeType::kCapsule, ShapeType::kCylinder, ShapeType::kBox}) {
    for (int i = 0; i < 3; ++i) {
      add_fixed(("shape" + std::to_string(number++)).c_str(),
                {.type = type, .size = {uniform(0.05, 0.3), uniform(0.05, 0.3), uniform(0.05, 0.3)}}, pose());
    }
  }
  Mesh cloud;
  for (int i = 0; i < 30; ++i) {
    cloud.vertices.push_back(
        broadcast<float>(Vec3<double>{uniform(-0.3, 0.3), uniform(-0.3, 0.3), uniform(-0.3, 0.3)}));
  }
  for (int i = 0; i + 2 < 30; ++i) cloud.triangles.push_back({i, i + 1, i + 2});
  const MeshId mesh = builder.add_mesh(cloud);
  add_fixed("hull", {.type = ShapeType::kConvex, .mesh = mesh}, pose());
  add_fixed("mesh", {.type = ShapeType::kMesh, .mesh = mesh}, pose());
  HeightField hills{.columns = 12, .rows = 9, .dx = 0.1, .dy = 0.12};
  for (int i = 0; i < 12 * 9; ++i) hills.height.push_back(uniform(0.05, 0.3));
  add_fixed("hills", {.type = ShapeType::kHeightField, .height_field = builder.add_height_field(hills)},
            Transform<double>::identity());
  return std::make_shared<const Model>(builder.build());
}

}  // namespace manyhands::testing
