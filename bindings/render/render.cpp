// manyhands._core.render: cameras, looks and marks.
#include "bindings/render/render.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings/bindings.h"
#include "bindings/model/model_values.h"
#include "bindings/pickling.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

template <class Archive, class T>
  requires std::same_as<std::remove_const_t<T>, Camera>
void visit_fields(Archive& archive, T& camera) {
  auto& [width, height, fx, fy, cx, cy, orthographic, near, far, frame, X_FC] = camera;
  archive(width, height, fx, fy, cx, cy, orthographic, near, far, frame, X_FC);
}

namespace {

using bindings::Array;
using bindings::Numbers3;
using bindings::Numbers4;
using bindings::vec3;

Mark mark_of(const std::string& shape, const std::vector<double>& size, const Numbers3& position, const Numbers4& r,
             const std::array<float, 4>& rgba) {
  const std::size_t expected = shape == "box" ? 3 : shape == "sphere" ? 1 : 2;
  Mark mark{.rgba = rgba, .X_WM = bindings::transform("mark", position, r)};
  mark.shape.type = bindings::named<ShapeType, 4>("shape", shape,
                                                  {{{"sphere", ShapeType::kSphere},
                                                    {"capsule", ShapeType::kCapsule},
                                                    {"cylinder", ShapeType::kCylinder},
                                                    {"box", ShapeType::kBox}}});
  if (size.size() != expected) {
    throw std::invalid_argument("a " + shape + " has " + std::to_string(expected) + " sizes; " +
                                std::to_string(size.size()) + " are given");
  }
  double* const to[] = {&mark.shape.size.x, &mark.shape.size.y, &mark.shape.size.z};
  for (std::size_t i = 0; i < size.size(); ++i) *to[i] = size[i];
  (void)item_of(mark.shape);
  return mark;
}

Camera posed(Camera camera, const Transform<double>& X_FC, const std::string& frame) {
  camera.X_FC = X_FC;
  camera.frame = frame;
  return camera;
}

void bind_camera(nb::module_& m) {
  auto bound = nb::class_<Camera>(
      m, "Camera",
      "A camera without distortion; its frame is the optical one: x to the right, y down, z forward. "
      "Immutable: what moves it gives another.");
  copy_as_itself(bound);
  bindings::pickle_by_fields(bound, &require_camera);
  bound
      .def("__repr__",
           [](const Camera& self) {
             return "<Camera of " + std::to_string(self.width) + " x " + std::to_string(self.height) + " pixels" +
                    (self.orthographic ? ", orthographic" : "") +
                    (self.frame.empty() ? "" : ", on '" + self.frame + "'") + ">";
           })
      .def_static("perspective", &perspective_camera, "width"_a, "height"_a, "fov_y"_a,
                  "One that sees `fov_y` [rad] from top to bottom, at the world's origin. Raises ValueError unless 0 < "
                  "fov_y < pi and width and height lie between 1 and 16384.")
      .def_static("intrinsics", &intrinsic_camera, "width"_a, "height"_a, "fx"_a, "fy"_a, "cx"_a, "cy"_a,
                  "One by its focal lengths and principal point [pixels].")
      .def_static("orthographic", &orthographic_camera, "width"_a, "height"_a, "view_height"_a,
                  "One with parallel rays that sees `view_height` [m] from top to bottom.")
      .def_static(
          "from_matrices",
          [](int width, int height, const std::vector<double>& view, const std::vector<double>& projection) {
            return camera_from_matrices(width, height, view, projection);
          },
          "width"_a, "height"_a, "view"_a, "projection"_a,
          "One in the world by OpenGL's matrices, 16 numbers each, column by column, as PyBullet's computeViewMatrix "
          "and computeProjectionMatrix give them. Raises ValueError if they are none of a rigid pose and a projection "
          "without shear.")
      .def(
          "look_at",
          [](const Camera& self, const Numbers3& eye, const Numbers3& target, const Numbers3& up,
             const std::string& frame) { return posed(self, look_at(vec3(eye), vec3(target), vec3(up)), frame); },
          "eye"_a, "target"_a, "up"_a = Numbers3{0, 0, 1}, "frame"_a = "",
          "The same at `eye`, looking at `target` (3) [m], in the world or in a frame or link that it is mounted on.")
      .def(
          "orbit",
          [](const Camera& self, const Numbers3& target, double distance, double yaw, double pitch, double roll) {
            return posed(self, orbit(vec3(target), distance, yaw, pitch, roll), "");
          },
          "target"_a, "distance"_a, "yaw"_a, "pitch"_a, "roll"_a = 0.0,
          "The same `distance` [m] from `target` (3) [m], as PyBullet's computeViewMatrixFromYawPitchRoll with z up; "
          "angles in radians: at yaw 0 it looks along y, and a negative pitch lets it look down.")
      .def(
          "at",
          [](const Camera& self, const Numbers3& position, const Numbers4& quaternion, const std::string& frame) {
            return posed(self, bindings::transform("camera", position, quaternion), frame);
          },
          "position"_a, "quaternion"_a, "frame"_a = "",
          "The same at a position (3) [m] and quaternion (4) of its optical frame, in the world or in a frame or link "
          "that it is mounted on.")
      .def(
          "clipped",
          [](Camera self, double near, double far) {
            self.near = near;
            self.far = far;
            require_camera(self);
            return self;
          },
          "near"_a, "far"_a, "The same that sees what lies between these depths [m]; else 0.01 and 100.")
      .def_ro("width", &Camera::width, "Of the picture [pixels].")
      .def_ro("height", &Camera::height, "Of the picture [pixels].")
      .def_ro("fx", &Camera::fx, "[pixels]; [pixels/m] of an orthographic one.")
      .def_ro("fy", &Camera::fy, "Focal length along y [pixels].")
      .def_ro("cx", &Camera::cx, "Where the optical axis meets the picture [pixels from its left edge].")
      .def_ro("cy", &Camera::cy, "Where the optical axis meets the picture [pixels from its upper edge].")
      .def_ro("near", &Camera::near, "What is nearer is not seen [m].")
      .def_ro("far", &Camera::far, "What is farther is not seen [m].")
      .def_ro("frame", &Camera::frame, "What it is mounted on; empty: the world.")
      .def_prop_ro(
          "position", [](const Camera& self) { return bindings::vector3(self.X_FC.p); },
          nb::sig(bindings::returns_array("position").c_str()), "In its frame (3) [m].")
      .def_prop_ro(
          "quaternion", [](const Camera& self) { return bindings::quaternion(self.X_FC.R); },
          nb::sig(bindings::returns_array("quaternion").c_str()), "In its frame (4).");
}

void bind_look(nb::module_& m) {
  const Look standard;
  auto bound =
      nb::class_<Look>(m, "Look", "How a scene is lit, and what is behind it. Colours are red, green, blue, 0 to 1.");
  copy_as_itself(bound);
  bindings::pickle_by_fields(bound, &require_look);
  bound
      .def("__repr__",
           [](const Look& self) {
             return "<Look: " + std::to_string(self.shadow_rays) +
                    (self.shadows ? " shadow rays" : " shadow rays, off") + ", " + std::to_string(self.antialiasing) +
                    " x " + std::to_string(self.antialiasing) + " samples>";
           })
      .def(
          "__init__",
          [](Look* self, const Numbers3& light, float sun, float ambient, bool shadows, int shadow_rays,
             double sun_size, int antialiasing, const Colour& horizon, const Colour& zenith) {
            const Look look{vec3(light), sun, ambient, shadows, shadow_rays, sun_size, antialiasing, horizon, zenith};
            require_look(look);
            new (self) Look(look);
          },
          nb::kw_only(), "light"_a = Numbers3{standard.light.x, standard.light.y, standard.light.z},
          "sun"_a = standard.sun, "ambient"_a = standard.ambient, "shadows"_a = standard.shadows,
          "shadow_rays"_a = standard.shadow_rays, "sun_size"_a = standard.sun_size,
          "antialiasing"_a = standard.antialiasing, "horizon"_a = standard.horizon, "zenith"_a = standard.zenith,
          "light: the direction to the sun (3). sun, ambient: brightness of what faces it, and without it. "
          "shadow_rays: more than 1 make shadows soft, of a sun that is sun_size [rad] from centre to rim. "
          "antialiasing: n x n "
          "samples where a pixel differs from its neighbours. horizon, zenith: colours of the background. Raises "
          "ValueError on a number out of range.")
      .def_ro("sun", &Look::sun, "Brightness of what faces the light.")
      .def_ro("ambient", &Look::ambient, "Brightness without it, from the whole sky.")
      .def_ro("shadows", &Look::shadows, "Whether the sun casts any.")
      .def_ro("shadow_rays", &Look::shadow_rays, "For each pixel; more than one make shadows soft.")
      .def_ro("sun_size", &Look::sun_size, "[rad], from its centre to its rim.")
      .def_ro("antialiasing", &Look::antialiasing, "n: n x n samples for each pixel.")
      .def_ro("horizon", &Look::horizon, "Colour of the sky at the horizon (3), 0 to 1.")
      .def_ro("zenith", &Look::zenith, "Colour of the sky above (3), 0 to 1.")
      .def_prop_ro(
          "light", [](const Look& self) { return bindings::vector3(self.light); },
          nb::sig(bindings::returns_array("light").c_str()), "(3)");
  auto bound_mark =
      nb::class_<Mark>(m, "Mark", "A shape drawn over a picture that is no part of the world: in colour only.");
  bindings::pickle_by_fields(bound_mark, [](const Mark& self) { (void)item_of(self.shape); });
  bound_mark
      .def("__repr__",
           [](const Mark& self) {
             return std::string("<Mark: ") + bindings::name_of(self.shape.type, bindings::kShapes) + ">";
           })
      .def(
          "__init__",
          [](Mark* self, const std::string& shape, const std::vector<double>& size, const Numbers3& position,
             const Numbers4& quaternion, const std::array<float, 4>& rgba, bool is_die) {
            Mark mark = mark_of(shape, size, position, quaternion, rgba);
            if (is_die) mark.pattern = Pattern::kDie;
            new (self) Mark(mark);
          },
          "shape"_a, "size"_a, "position"_a, "quaternion"_a = Numbers4{0, 0, 0, 1}, "rgba"_a = Mark{}.rgba,
          "is_die"_a = false,
          "shape: 'sphere' (radius), 'capsule' or 'cylinder' (radius, half length), 'box' (half extents) [m]. is_die: "
          "a box shows a colour on each face. Raises ValueError on other shapes and sizes.");
}

}  // namespace

void bind_render(nb::module_& parent) {
  nb::module_ m = parent.def_submodule("render", "Cameras and pictures.");
  bind_camera(m);
  bind_look(m);
  bind_texture(m);
  bind_pictures(m, parent);
}

}  // namespace manyhands
