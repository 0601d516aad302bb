// manyhands._core.envs.EnvPictures: cameras of environments.
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>

#include "bindings/bindings.h"
#include "bindings/render/render.h"
#include "manyhands/envs/sight.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

/// Gives planes another colour (3); all else keeps its own.
void paint_floor(Shot& shot, const Model& model, const std::array<float, 3>& colour) {
  std::vector<std::array<float, 4>>& rgba = shot.guise.rgba;
  for (std::size_t i = 0; i < model.geoms().size(); ++i) {
    const Geom& geom = model.geoms()[i];
    if (rgba.size() == i) rgba.push_back(geom.rgba);
    if (geom.shape.type == ShapeType::kPlane) std::ranges::copy(colour, rgba[i].begin());
  }
}

}  // namespace

void bind_env_pictures(nb::module_& parent) {
  using bindings::Cameras;
  using bindings::Looks;
  const auto m = nb::borrow<nb::module_>(parent.attr("envs"));
  nb::class_<PictureVariation>(m, "PictureVariation",
                               "How pictures differ from episode to episode: by how much at most.")
      .def(
          "__init__",
          [](PictureVariation* self, double position, double direction, double zoom, double light, double brightness,
             double colour, double texture, const std::vector<Texture>& textures) {
            for (const double most : {position, direction, zoom, light, brightness, colour}) {
              if (!(most >= 0 && most < 1)) {
                throw std::invalid_argument("what varies is off by " + std::to_string(most) +
                                            "; expected 0 or more, less than 1");
              }
            }
            if (!(texture >= 0 && texture <= 1)) {
              throw std::invalid_argument("textures vary with a chance of " + std::to_string(texture) +
                                          "; expected 0 to 1");
            }
            if (texture == 0 && !textures.empty()) {
              throw std::invalid_argument(
                  "textures vary by what is chosen from, but with no chance; give `texture`, "
                  "the chance of 0 to 1");
            }
            new (self) PictureVariation{position, direction, zoom, light, brightness, colour, texture, textures};
          },
          nb::kw_only(), "position"_a = 0, "direction"_a = 0, "zoom"_a = 0, "light"_a = 0, "brightness"_a = 0,
          "colour"_a = 0, "texture"_a = 0, "textures"_a = std::vector<Texture>{},
          "position: of the camera, along each of its axes [m]. direction: about each [rad]. zoom: of its focal "
          "lengths, as a share. light: of the unit vector to the sun. brightness: of sun and sky, as a share. colour: "
          "of each geom's red, green and blue. texture: the chance that floor, table, an obstacle or an object shows "
          "an image in place of its colour. textures: those to choose from; else checkers, stripes and noise. Raises "
          "ValueError unless all lie in [0, 1), the chance in [0, 1].");
  nb::class_<Eye>(m, "Eye", "A camera through which a policy sees, and how its pictures differ between episodes.")
      .def(
          "__init__",
          [](Eye* self, const Camera& camera, const Look& look, const PictureVariation& variation) {
            new (self) Eye{camera, look, variation};
          },
          "camera"_a, "look"_a = Look{}, "variation"_a = PictureVariation{});
  nb::class_<EnvPictures>(m, "EnvPictures", "Cameras of a batch of environments; goals are drawn over the worlds.")
      .def(nb::init<const EnvBatch&, int>(), "envs"_a, "num_threads"_a = 0, nb::keep_alive<1, 2>(),
           "Shows `envs`. Raises RuntimeError where there is nothing to see.")
      .def_prop_ro(
          "links",
          [](const EnvPictures& self) {
            std::vector<std::string> names;
            for (const Link& link : self.model().links()) names.push_back(link.name);
            return names;
          },
          "Names of the links that the segmentation's numbers mean.")
      .def(
          "take",
          [](EnvPictures& self, const Cameras& camera, const std::optional<std::vector<int>>& worlds, const Looks& look,
             const PictureVariation& variation, std::uint32_t camera_number, bool colour, bool depth, bool segmentation,
             bool normals, const std::optional<std::array<float, 3>>& floor) {
            const std::size_t n = worlds ? worlds->size() : static_cast<std::size_t>(self.envs().num_envs());
            bindings::require_count("camera", camera, n);
            bindings::require_count("look", look, n);
            std::vector<Shot> shots;
            for (std::size_t i = 0; i < n; ++i) {
              const int world = worlds ? (*worlds)[i] : static_cast<int>(i);
              shots.push_back(self.shot(self.view(world), bindings::chosen(camera, i), bindings::chosen(look, i),
                                        variation, camera_number));
              if (floor) paint_floor(shots.back(), self.model(), *floor);
            }
            return bindings::take_pictures(self.renderer(), std::move(shots), {colour, depth, segmentation, normals},
                                           false);
          },
          "camera"_a, nb::kw_only(), "worlds"_a = nb::none(), "look"_a = Look{}, "variation"_a = PictureVariation{},
          "camera_number"_a = 0, "colour"_a = true, "depth"_a = false, "segmentation"_a = false, "normals"_a = false,
          "floor"_a = nb::none(),
          nb::sig("def take(self, camera: manyhands._core.render.Camera | "
                  "collections.abc.Sequence[manyhands._core.render.Camera], *, worlds: collections.abc.Sequence[int] | "
                  "None = None, look: manyhands._core.render.Look | "
                  "collections.abc.Sequence[manyhands._core.render.Look] = ..., variation: PictureVariation = ..., "
                  "camera_number: int = 0, colour: bool = True, depth: bool = "
                  "False, segmentation: bool = False, normals: bool = False, "
                  "floor: collections.abc.Sequence[float] | None = None) -> manyhands._core.render.Picture"),
          "Pictures of all worlds, or of those chosen, with the worlds as first axis: one camera and look for all, or "
          "one each. What varies is drawn for each episode and camera_number. floor: its red, green and blue, 0 to 1, "
          "in place of its own. Raises ValueError on numbers that do not "
          "fit, KeyError on a world or frame that is not there.");
}

}  // namespace manyhands
