// What the files that take pictures share.
#pragma once

#include <nanobind/nanobind.h>

#include "manyhands/render/renderer.h"

namespace manyhands::bindings {

struct Outputs {
  bool colour, depth, segmentation, normals;
};

/// What Python gets: arrays, or None for what was not wanted.
struct PythonPicture {
  std::shared_ptr<const Model> model;
  std::vector<Camera> cameras;
  std::vector<Transform<double>> poses;  ///< of the cameras in the world
  bool is_one = false;                   ///< the arrays have no axis for several pictures
  nanobind::object colour = nanobind::none(), depth = nanobind::none(), segmentation = nanobind::none(),
                   normals = nanobind::none();
};

/// Takes pictures without the interpreter's lock. With `is_one`, arrays are those of the first.
[[nodiscard]] nanobind::object take_pictures(Renderer& renderer, std::vector<Shot> shots, const Outputs& wanted,
                                             bool is_one);

}  // namespace manyhands::bindings
