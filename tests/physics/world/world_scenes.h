// Small scenes for tests of worlds and batches.
#pragma once

#include <memory>

#include "manyhands/base/assets.h"
#include "manyhands/model/compose.h"
#include "manyhands/model/io/urdf/urdf.h"
#include "manyhands/model/model_builder.h"
#include "manyhands/physics/world/world.h"

namespace manyhands::testing {

/// A box that floats, 4 cm wide.
inline void add_cube(ModelBuilder& builder, const std::string& name, const Vec3<double>& p, double mass = 0.1,
                     double half = 0.02) {
  const double I = mass / 12 * 2 * (2 * half) * (2 * half);
  const LinkId link = builder.add_link(name, {.mass = mass, .inertia = {I, I, I, 0, 0, 0}});
  builder.add_joint({.name = name + "_free",
                     .type = JointType::kFloating,
                     .parent = builder.world(),
                     .child = link,
                     .initial = {p.x, p.y, p.z, 0, 0, 0, 1}});
  builder.add_geom({.name = name, .link = link, .shape = {.type = ShapeType::kBox, .size = {half, half, half}}});
}

inline void add_floor(ModelBuilder& builder) {
  builder.add_geom({.name = "floor", .link = builder.world(), .shape = {.type = ShapeType::kPlane}});
}

/// Cubes that fall a little way onto each other, slightly askew, and onto the floor.
inline std::shared_ptr<const Model> stack(int cubes) {
  ModelBuilder builder("stack");
  add_floor(builder);
  for (int i = 0; i < cubes; ++i) {
    add_cube(builder, "cube" + std::to_string(i), {0.002 * i, -0.001 * i, 0.021 + 0.042 * i});
  }
  return std::make_shared<const Model>(builder.build());
}

/// The Panda and a cube that drops onto the floor before it.
inline std::shared_ptr<const Model> panda_and_cube() {
  const LoadedModel panda = load_urdf(asset_path("panda/panda.urdf"));
  ModelBuilder builder = builder_of(panda.model);
  add_floor(builder);
  add_cube(builder, "cube", {0.5, 0, 0.04});
  return std::make_shared<const Model>(builder.build());
}

inline World world_of(std::shared_ptr<const Model> model, double time_step = 0.002) {
  return World(std::move(model), time_step);
}

}  // namespace manyhands::testing
