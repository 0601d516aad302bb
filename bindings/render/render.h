// What the files that take pictures share.
#pragma once

#include <nanobind/nanobind.h>

#include <variant>

#include "manyhands/render/renderer.h"

namespace manyhands {

void bind_texture(nanobind::module_& m);
void bind_pictures(nanobind::module_& m, nanobind::module_& parent);  // parent has World and Batch

namespace bindings {

struct Outputs {
  bool colour, depth, segmentation, normals;
};

/// One for all pictures, or one each.
using Cameras = std::variant<Camera, std::vector<Camera>>;
using Looks = std::variant<Look, std::vector<Look>>;

template <class One>
const One& chosen(const std::variant<One, std::vector<One>>& given, std::size_t i) {
  const One* const all = std::get_if<One>(&given);
  return all ? *all : std::get<std::vector<One>>(given)[i];
}

template <class One>
void require_count(const char* what, const std::variant<One, std::vector<One>>& given, std::size_t n) {
  const auto* const list = std::get_if<std::vector<One>>(&given);
  if (list == nullptr || list->size() == n) return;
  throw std::invalid_argument(std::string(what) + ": " + std::to_string(list->size()) + " are given for " +
                              std::to_string(n) + " pictures; expected one for all, or one each");
}

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

}  // namespace bindings
}  // namespace manyhands
