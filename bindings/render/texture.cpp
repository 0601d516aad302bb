// manyhands._core.render.Texture: images on surfaces.
#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include <cmath>

#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "bindings/pickling.h"
#include "bindings/render/render.h"
#include "bindings/vectors.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using AnyArray = nb::ndarray<nb::ro, nb::device::cpu>;
using Repeat = std::variant<float, std::array<float, 2>>;

std::shared_ptr<const Image> image_of(const AnyArray& array) {
  if (array.dtype() != nb::dtype<std::uint8_t>() || array.ndim() != 3 || array.shape(2) != 3) {
    std::string shape;
    for (std::size_t i = 0; i < array.ndim(); ++i) shape += (i > 0 ? ", " : "") + std::to_string(array.shape(i));
    throw std::invalid_argument("an image of shape (" + shape + ") and " +
                                std::to_string(static_cast<int>(array.dtype().bits)) +
                                " bits a number; expected (height, width, 3) of uint8");
  }
  // Sizes that no int holds are refused as others that are too large.
  const std::size_t height = std::min<std::size_t>(array.shape(0), 65536),
                    width = std::min<std::size_t>(array.shape(1), 65536);
  std::vector<std::uint8_t> rgb;
  const auto* const first = static_cast<const std::uint8_t*>(array.data());
  for (std::int64_t y = 0; y < static_cast<std::int64_t>(array.shape(0)); ++y) {
    for (std::int64_t x = 0; x < static_cast<std::int64_t>(array.shape(1)); ++x) {
      for (std::int64_t c = 0; c < 3; ++c) {
        rgb.push_back(first[y * array.stride(0) + x * array.stride(1) + c * array.stride(2)]);
      }
    }
  }
  return std::make_shared<const Image>(static_cast<int>(width), static_cast<int>(height), rgb);
}

Texture texture_of(std::shared_ptr<const Image> image, const Repeat& repeat) {
  Texture texture{.image = std::move(image)};
  if (const auto* const both = std::get_if<float>(&repeat)) {
    texture.repeat = {*both, *both};
  } else {
    texture.repeat = std::get<std::array<float, 2>>(repeat);
  }
  for (const float times : texture.repeat) {
    if (!(times > 0 && times <= kMostRepeats)) {
      throw std::invalid_argument("a texture is repeated " + std::to_string(times) +
                                  " times; expected more than 0, at most 10000");
    }
  }
  return texture;
}

constexpr const char* kRepeat = "repeat: float | tuple[float, float] = 1) -> Texture";
constexpr const char* kColours = "(first: tuple[float, float, float], second: tuple[float, float, float], ";

}  // namespace

void bind_texture(nb::module_& m) {
  const auto signature = [](const char* name, const char* own) {
    return std::string("def ") + name + kColours + own + kRepeat;
  };
  auto bound = nb::class_<Texture>(
      m, "Texture",
      "An image that surfaces show, multiplied by their colour. It lies upright on each side of a box, from end to end "
      "around spheres, cylinders and capsules, on every metre of a plane, and on meshes as on the box that holds them. "
      "Immutable.");
  copy_as_itself(bound);
  bound
      .def(
          "__init__",
          [](Texture* self, const AnyArray& image, const Repeat& repeat) {
            new (self) Texture(texture_of(image_of(image), repeat));
          },
          "image"_a, "repeat"_a = 1.0f,
          nb::sig("def __init__(self, image: numpy.typing.NDArray[numpy.uint8], repeat: float | tuple[float, float] = "
                  "1) -> None"),
          "image (height, width, 3): red, green, blue, rows from the top; up to 4096 x 4096. repeat: how often it lies "
          "where it else lies once, or along its width and along its height. Raises ValueError on what is no image, "
          "and unless 0 < repeat <= 10000.")
      .def_static(
          "checker",
          [](const Colour& first, const Colour& second, const Repeat& repeat) {
            return texture_of(checker_image(first, second), repeat);
          },
          "first"_a, "second"_a, "repeat"_a = 1.0f, nb::sig(signature("checker", "").c_str()),
          "2 x 2 squares of two colours (3), 0 to 1.")
      .def_static(
          "stripes",
          [](const Colour& first, const Colour& second, const Repeat& repeat) {
            return texture_of(stripe_image(first, second), repeat);
          },
          "first"_a, "second"_a, "repeat"_a = 1.0f, nb::sig(signature("stripes", "").c_str()),
          "Two upright stripes of two colours (3), 0 to 1.")
      .def_static(
          "noise",
          [](const Colour& first, const Colour& second, std::uint64_t seed, const Repeat& repeat) {
            return texture_of(noise_image(first, second, seed), repeat);
          },
          "first"_a, "second"_a, "seed"_a = 0, "repeat"_a = 1.0f,
          nb::sig(signature("noise", "seed: int = 0, ").c_str()), "Clouds between two colours (3), 0 to 1.")
      .def("__getstate__",
           [](const Texture& self) { return nb::make_tuple(bindings::as_bytes(self.image->archived()), self.repeat); })
      .def(
          "__setstate__",
          [](Texture& self, const std::pair<nb::bytes, std::array<float, 2>>& state) {
            new (&self) Texture(texture_of(Image::unarchived(bindings::as_bytes(state.first)), state.second));
          },
          "state"_a)
      .def("__repr__",
           [](const Texture& self) {
             return "<Texture of " + std::to_string(self.image->width()) + " x " +
                    std::to_string(self.image->height()) + " pixels>";
           })
      .def_ro("repeat", &Texture::repeat, "How often, along its width and its height.")
      .def_prop_ro(
          "size", [](const Texture& self) { return std::array{self.image->width(), self.image->height()}; },
          "Width and height of the image [pixels].");
}

}  // namespace manyhands
