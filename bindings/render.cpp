// manyhands._core.render: cameras, looks and pictures; World.render and Batch.render.
#include "bindings/render.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "bindings/bindings.h"
#include "bindings/model_values.h"
#include "bindings/poses.h"
#include "bindings/python_model.h"
#include "manyhands/physics/step/batch.h"
#include "manyhands/physics/step/world.h"
#include "manyhands/render/renderer.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

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
  nb::class_<Camera>(m, "Camera",
                     "A camera without distortion; its frame is the optical one: x to the right, y down, z forward. "
                     "Immutable: what moves it gives another.")
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
      .def_ro("width", &Camera::width)
      .def_ro("height", &Camera::height)
      .def_ro("fx", &Camera::fx, "[pixels]; [pixels/m] of an orthographic one.")
      .def_ro("fy", &Camera::fy)
      .def_ro("cx", &Camera::cx)
      .def_ro("cy", &Camera::cy)
      .def_ro("near", &Camera::near)
      .def_ro("far", &Camera::far)
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
  nb::class_<Look>(m, "Look", "How a scene is lit, and what is behind it. Colours are red, green, blue, 0 to 1.")
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
          "shadow_rays: "
          "more than 1 make shadows soft, of a sun that is sun_size [rad] from centre to rim. antialiasing: n x n "
          "samples where a pixel differs from its neighbours. horizon, zenith: colours of the background. Raises "
          "ValueError on a number out of range.")
      .def_ro("sun", &Look::sun)
      .def_ro("ambient", &Look::ambient)
      .def_ro("shadows", &Look::shadows)
      .def_ro("shadow_rays", &Look::shadow_rays)
      .def_ro("sun_size", &Look::sun_size)
      .def_ro("antialiasing", &Look::antialiasing)
      .def_ro("horizon", &Look::horizon)
      .def_ro("zenith", &Look::zenith)
      .def_prop_ro(
          "light", [](const Look& self) { return bindings::vector3(self.light); },
          nb::sig(bindings::returns_array("light").c_str()), "(3)");
  nb::class_<Mark>(m, "Mark", "A shape drawn over a picture that is no part of the world: in colour only.")
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
          "a box shows a colour on each face. Raises "
          "ValueError on other shapes and sizes.");
}

template <class T>
nb::object array_of(std::vector<T>&& values, std::initializer_list<std::size_t> shape) {
  auto* const owned = new std::vector<T>(std::move(values));
  const nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, T>(owned->data(), shape.size(), shape.begin(), owner));
}

nb::object squeezed(const nb::object& array, bool is_one) {
  return is_one && !array.is_none() ? nb::object(array[nb::int_(0)]) : array;
}

}  // namespace

nb::object bindings::take_pictures(Renderer& renderer, std::vector<Shot> shots, const Outputs& wanted, bool is_one) {
  if (shots.empty()) throw std::invalid_argument("no picture was asked for; name one world or more");
  const std::size_t n = shots.size(), height = static_cast<std::size_t>(shots[0].camera.height),
                    width = static_cast<std::size_t>(shots[0].camera.width), pixels = n * height * width;
  require_camera(shots[0].camera);
  std::vector<std::uint8_t> colour(wanted.colour ? 3 * pixels : 0);
  std::vector<float> depth(wanted.depth ? pixels : 0), normals(wanted.normals ? 3 * pixels : 0);
  std::vector<std::int32_t> segmentation(wanted.segmentation ? pixels : 0);
  PythonPicture picture{.model = renderer.scene().shared_model(), .cameras = {}, .poses = {}};
  {
    const nb::gil_scoped_release release;
    renderer.render(shots, {colour, depth, segmentation, normals});
    for (Shot& shot : shots) {
      picture.poses.push_back(renderer.camera_pose(shot.camera, shot.q));
      picture.cameras.push_back(std::move(shot.camera));
    }
  }
  picture.is_one = is_one;
  if (wanted.colour) picture.colour = squeezed(array_of(std::move(colour), {n, height, width, 3}), is_one);
  if (wanted.depth) picture.depth = squeezed(array_of(std::move(depth), {n, height, width}), is_one);
  if (wanted.segmentation) {
    picture.segmentation = squeezed(array_of(std::move(segmentation), {n, height, width}), is_one);
  }
  if (wanted.normals) picture.normals = squeezed(array_of(std::move(normals), {n, height, width, 3}), is_one);
  return nb::cast(std::move(picture));
}

namespace {

using bindings::Cameras;
using bindings::chosen;
using bindings::Looks;
using bindings::Outputs;
using bindings::PythonPicture;
using bindings::require_count;
using Marks = std::vector<Mark>;
using Tints = std::optional<nb::ndarray<const float, nb::ndim<3>, nb::c_contig, nb::device::cpu>>;

/// `q_of(i)` is the configuration that picture i shows.
template <class QOf>
std::vector<Shot> shots_of(std::size_t n, const Cameras& cameras, const Looks& looks, const Marks& marks,
                           const Tints& rgba, QOf&& q_of) {
  require_count("camera", cameras, n);
  require_count("look", looks, n);
  if (rgba && (rgba->shape(0) != n || rgba->shape(2) != 4)) {
    throw std::invalid_argument("rgba must have the shape (pictures, geoms, 4)");
  }
  std::vector<Shot> shots;
  for (std::size_t i = 0; i < n; ++i) {
    Shot shot{.camera = chosen(cameras, i), .look = chosen(looks, i), .q = q_of(i), .marks = marks};
    if (rgba) {
      const std::size_t geoms = rgba->shape(1);
      for (std::size_t g = 0; g < geoms; ++g) {
        const float* const c = rgba->data() + 4 * (i * geoms + g);
        shot.guise.rgba.push_back({c[0], c[1], c[2], c[3]});
      }
    }
    shots.push_back(std::move(shot));
  }
  return shots;
}

nb::object bodies_of(const PythonPicture& self) {
  if (self.segmentation.is_none()) return nb::none();
  std::vector<std::int32_t> root{-1};
  for (std::size_t i = 0; i < self.model->links().size(); ++i) root.push_back(self.model->root_link(LinkId(i)).value());
  const nb::object table = bindings::copied(root.data(), {root.size()});
  return table[self.segmentation + nb::int_(1)];
}

nb::object points_of(const PythonPicture& self, std::size_t picture) {
  if (self.depth.is_none()) throw std::runtime_error("point_cloud: the picture was taken without depth");
  if (picture >= self.cameras.size()) throw std::out_of_range("point_cloud: there is no such picture");
  const auto depth = nb::cast<nb::ndarray<const float, nb::c_contig, nb::device::cpu>>(
      self.is_one ? self.depth : nb::object(self.depth[nb::int_(picture)]));
  std::vector<Vec3<float>> points =
      point_cloud(self.cameras[picture], self.poses[picture], {depth.data(), depth.size()});
  return bindings::copied(points.empty() ? nullptr : &points[0].x, {points.size(), 3});
}

void bind_picture(nb::module_& m) {
  nb::class_<PythonPicture>(m, "Picture",
                            "What cameras saw. Rows are from the top; of several pictures, the first axis.")
      .def_ro("colour", &PythonPicture::colour,
              nb::for_getter(nb::sig("def colour(self) -> numpy.typing.NDArray[numpy.uint8]")),
              "(height, width, 3) red, green, blue.")
      .def_ro("depth", &PythonPicture::depth,
              nb::for_getter(nb::sig("def depth(self) -> numpy.typing.NDArray[numpy.float32]")),
              "(height, width) along the optical axis [m]; the camera's `far` where nothing is.")
      .def_ro("segmentation", &PythonPicture::segmentation,
              nb::for_getter(nb::sig("def segmentation(self) -> numpy.typing.NDArray[numpy.int32]")),
              "(height, width) index of the link in the model; -1 where nothing is.")
      .def_ro("normals", &PythonPicture::normals,
              nb::for_getter(nb::sig("def normals(self) -> numpy.typing.NDArray[numpy.float32]")),
              "(height, width, 3) unit, in the world; 0 where nothing is.")
      .def_prop_ro("bodies", &bodies_of, nb::sig("def bodies(self) -> numpy.typing.NDArray[numpy.int32]"),
                   "(height, width) index of the link by which the robot or thing stands in the world: alike for all "
                   "links of one robot; -1 where nothing is.")
      .def("point_cloud", &points_of, "picture"_a = 0,
           nb::sig("def point_cloud(self, picture: int = 0) -> numpy.typing.NDArray[numpy.float32]"),
           "Points in the world (k, 3) [m], of all pixels that show something. Raises RuntimeError without depth.");
}

/// Patterns of the geoms with the faces of some of them coloured as a die's.
std::vector<Pattern> with_dice(const Model& model, const std::vector<std::string>& dice) {
  std::vector<Pattern> patterns;
  if (dice.empty()) return patterns;
  for (const Geom& geom : model.geoms()) {
    const bool is_die = std::ranges::find(dice, geom.name) != dice.end();
    patterns.push_back(is_die                                 ? Pattern::kDie
                       : geom.shape.type == ShapeType::kPlane ? Pattern::kChecks
                                                              : Pattern::kPlain);
  }
  return patterns;
}

constexpr const char* kWanted =
    "marks are drawn over it. colour, depth, segmentation, normals: what is wanted. Raises ValueError on numbers that "
    "do not fit, KeyError on a camera's frame that is not there.";

void bind_renderer(nb::module_& m) {
  nb::class_<Renderer>(m, "Renderer", "Takes pictures of a model at given configurations, with threads of its own.")
      .def(
          "__init__",
          [](Renderer* self, const PythonModel& model, int num_threads) {
            new (self) Renderer(model.model, num_threads);
          },
          "model"_a, "num_threads"_a = 0,
          "num_threads: 0 takes the variable MANYHANDS_THREADS, or as many as the machine has cores.")
      .def(
          "render",
          [](Renderer& self, const bindings::Numbers& q, const Cameras& camera, const Looks& look, const Marks& marks,
             const Tints& rgba, bool colour, bool depth, bool segmentation, bool normals) {
            const std::size_t nq = static_cast<std::size_t>(self.scene().model().nq());
            const std::size_t n = nq > 0 ? bindings::rows_of("q", q, nq) : 1;
            auto shots = shots_of(n, camera, look, marks, rgba, [&](std::size_t i) {
              return std::vector<double>(q.data() + i * nq, q.data() + (i + 1) * nq);
            });
            return bindings::take_pictures(self, std::move(shots), {colour, depth, segmentation, normals},
                                           q.ndim() == 1);
          },
          "q"_a, "camera"_a, nb::kw_only(), "look"_a = Look{}, "marks"_a = Marks{}, "rgba"_a = nb::none(),
          "colour"_a = true, "depth"_a = true, "segmentation"_a = true, "normals"_a = false,
          nb::sig("def render(self, q: numpy.typing.NDArray[numpy.floating], camera: Camera | "
                  "collections.abc.Sequence[Camera], *, look: Look | collections.abc.Sequence[Look] = ..., marks: "
                  "collections.abc.Sequence[Mark] = [], rgba: numpy.typing.NDArray[numpy.float32] | None = None, "
                  "colour: bool = True, depth: bool = True, segmentation: bool = True, normals: bool = False) -> "
                  "Picture"),
          (std::string("One picture at q (nq), or n at rows (n, nq): one camera and look for all, or one each. rgba "
                       "(n, geoms, 4): other colours for the model's geoms. ") +
           kWanted)
              .c_str());
}

void bind_world_render(nb::module_& m) {
  auto world = nb::borrow<nb::class_<World>>(m.attr("World"));
  world.def(
      "render",
      [](World& self, const Camera& camera, const Look& look, const Marks& marks, const std::vector<std::string>& dice,
         bool colour, bool depth, bool segmentation, bool normals) {
        const std::shared_ptr<Renderer> renderer = renderer_of(self.shared_model());
        auto shots = shots_of(1, camera, look, marks, {},
                              [&](std::size_t) { return std::vector<double>(self.q().begin(), self.q().end()); });
        shots[0].guise.patterns = with_dice(self.model(), dice);
        return bindings::take_pictures(*renderer, std::move(shots), {colour, depth, segmentation, normals}, true);
      },
      "camera"_a, nb::kw_only(), "look"_a = Look{}, "marks"_a = Marks{}, "dice"_a = std::vector<std::string>{},
      "colour"_a = true, "depth"_a = true, "segmentation"_a = true, "normals"_a = false,
      nb::sig("def render(self, camera: manyhands._core.render.Camera, *, look: manyhands._core.render.Look = ..., "
              "marks: collections.abc.Sequence[manyhands._core.render.Mark] = [], dice: "
              "collections.abc.Sequence[str] = [], colour: bool = True, depth: bool = True, segmentation: bool = True, "
              "normals: bool = False) -> manyhands._core.render.Picture"),
      (std::string("A picture of the world as it is. dice: names of boxes that show a colour on each face; ") + kWanted)
          .c_str());
  auto batch = nb::borrow<nb::class_<Batch>>(m.attr("Batch"));
  batch.def(
      "render",
      [](Batch& self, const Cameras& camera, const std::optional<std::vector<std::size_t>>& worlds, const Looks& look,
         const Marks& marks, const Tints& rgba, bool colour, bool depth, bool segmentation, bool normals) {
        const std::vector<float> q = self.q();
        const std::size_t nq = static_cast<std::size_t>(self.model().nq()),
                          all = static_cast<std::size_t>(self.num_worlds());
        auto shots = shots_of(worlds ? worlds->size() : all, camera, look, marks, rgba, [&](std::size_t i) {
          const std::size_t row = worlds ? (*worlds)[i] : i;
          if (row >= all) throw std::out_of_range("there is no world " + std::to_string(row));
          return std::vector<double>(q.data() + row * nq, q.data() + (row + 1) * nq);
        });
        return bindings::take_pictures(*renderer_of(self.shared_model()), std::move(shots),
                                       {colour, depth, segmentation, normals}, false);
      },
      "camera"_a, nb::kw_only(), "worlds"_a = nb::none(), "look"_a = Look{}, "marks"_a = Marks{}, "rgba"_a = nb::none(),
      "colour"_a = true, "depth"_a = true, "segmentation"_a = true, "normals"_a = false,
      nb::sig(
          "def render(self, camera: manyhands._core.render.Camera | "
          "collections.abc.Sequence[manyhands._core.render.Camera], *, worlds: collections.abc.Sequence[int] | None "
          "= None, look: manyhands._core.render.Look | collections.abc.Sequence[manyhands._core.render.Look] = ..., "
          "marks: collections.abc.Sequence[manyhands._core.render.Mark] = [], rgba: "
          "numpy.typing.NDArray[numpy.float32] | None = None, colour: bool = True, depth: bool = True, "
          "segmentation: bool = True, normals: bool = False) -> manyhands._core.render.Picture"),
      (std::string("Pictures of all worlds, or of those chosen, with the worlds as first axis: one camera and look for "
                   "all, or one each. rgba (pictures, geoms, 4): other colours for the model's geoms. ") +
       kWanted)
          .c_str());
}

}  // namespace

void bind_render(nb::module_& parent) {
  nb::module_ m = parent.def_submodule("render", "Cameras and pictures.");
  bind_camera(m);
  bind_look(m);
  bind_picture(m);
  bind_renderer(m);
  bind_world_render(parent);
}

}  // namespace manyhands
