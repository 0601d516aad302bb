// manyhands._core.render: pictures; World.render and Batch.render.
#include <nanobind/nanobind.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "bindings/bindings.h"
#include "bindings/model/python_model.h"
#include "bindings/render/render.h"
#include "bindings/world/poses.h"
#include "manyhands/physics/world/batch.h"
#include "manyhands/physics/world/world.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

template <class T>
nb::object array_of(std::vector<T>&& values, std::initializer_list<std::size_t> shape) {
  // NOLINTBEGIN(cppcoreguidelines-owning-memory): the array's capsule owns it
  auto* const owned = new std::vector<T>(std::move(values));
  const nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  // NOLINTEND(cppcoreguidelines-owning-memory)
  return nb::cast(nb::ndarray<nb::numpy, T>(owned->data(), shape.size(), shape.begin(), owner));
}

/// An array of one picture or more: of one alone, without the axis for several.
template <class T>
nb::object pictures_of(std::vector<T>&& values, std::initializer_list<std::size_t> shape, bool is_one) {
  const nb::object array = array_of(std::move(values), shape);
  return is_one ? nb::object(array[nb::int_(0)]) : array;
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
      picture.poses.push_back(renderer.camera_pose(shot));
      picture.cameras.push_back(std::move(shot.camera));
    }
  }
  picture.is_one = is_one;
  if (wanted.colour) picture.colour = pictures_of(std::move(colour), {n, height, width, 3}, is_one);
  if (wanted.depth) picture.depth = pictures_of(std::move(depth), {n, height, width}, is_one);
  if (wanted.segmentation) picture.segmentation = pictures_of(std::move(segmentation), {n, height, width}, is_one);
  if (wanted.normals) picture.normals = pictures_of(std::move(normals), {n, height, width, 3}, is_one);
  return nb::cast(std::move(picture));
}

namespace {

using bindings::Cameras;
using bindings::chosen;
using bindings::Looks;
using bindings::PythonPicture;
using bindings::require_count;
using Marks = std::vector<Mark>;
/// By name of geoms or links; one for all pictures, or one each.
using NamedTextures = std::map<std::string, Texture>;
using Textures = std::variant<NamedTextures, std::vector<NamedTextures>>;
using Tints = std::optional<nb::ndarray<const float, nb::ndim<3>, nb::c_contig, nb::device::cpu>>;

/// Of each geom of the model. Throws std::out_of_range on a name that neither a geom nor a link has.
std::vector<Texture> textures_of(const Model& model, const NamedTextures& named) {
  std::vector<Texture> textures;
  if (named.empty()) return textures;
  textures.resize(model.geoms().size());
  for (const auto& [name, texture] : named) {
    bool is_there = false;
    for (std::size_t i = 0; i < textures.size(); ++i) {
      const Geom& geom = model.geoms()[i];
      if (geom.name != name && model.link(geom.link).name != name) continue;
      textures[i] = texture;
      is_there = true;
    }
    if (is_there) continue;
    std::string message = "textures: no geom or link with a geom is named '" + name + "'; there are";
    for (const Geom& geom : model.geoms()) {
      const std::string& known = geom.name.empty() ? model.link(geom.link).name : geom.name;
      message += " '" + known + "'";
    }
    throw std::out_of_range(message);
  }
  return textures;
}

/// Of the files that the model's geoms show: through the Python package, which reads images.
std::shared_ptr<const Image> read_image(const std::string& file) {
  const nb::object texture = nb::module_::import_("manyhands.textures").attr("texture_or_warning")(file);
  return texture.is_none() ? nullptr : nb::cast<const Texture&>(texture).image;
}

/// `q_of(i)` is the configuration that picture i shows.
template <class QOf>
std::vector<Shot> shots_of(const Model& model, std::size_t n, const Cameras& cameras, const Looks& looks,
                           const Marks& marks, const Textures& textures, const Tints& rgba, QOf&& q_of) {
  require_count("camera", cameras, n);
  require_count("look", looks, n);
  require_count("textures", textures, n);
  if (rgba && (rgba->shape(0) != n || rgba->shape(2) != 4)) {
    throw std::invalid_argument("rgba must have the shape (pictures, geoms, 4)");
  }
  std::vector<Shot> shots;
  for (std::size_t i = 0; i < n; ++i) {
    Shot shot{.camera = chosen(cameras, i), .look = chosen(looks, i), .q = q_of(i), .marks = marks};
    shot.guise.textures = textures_of(model, chosen(textures, i));
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

/// A property that gives an array, or None where it was not wanted.
void bind_array(nb::class_<PythonPicture>& picture, const std::string& name, nb::object PythonPicture::* array,
                const char* number_type, const char* doc) {
  const std::string signature = "def " + name + "(self) -> numpy.typing.NDArray[numpy." + number_type + "]";
  picture.def_ro(name.c_str(), array, nb::for_getter(nb::sig(signature.c_str())), doc);
}

void bind_picture(nb::module_& m) {
  nb::class_<PythonPicture> picture(m, "Picture",
                                    "What cameras saw. Rows are from the top; of several pictures, the first axis.");
  bind_array(picture, "colour", &PythonPicture::colour, "uint8", "(height, width, 3) red, green, blue.");
  bind_array(picture, "depth", &PythonPicture::depth, "float32",
             "(height, width) along the optical axis [m]; the camera's `far` where nothing is.");
  bind_array(picture, "segmentation", &PythonPicture::segmentation, "int32",
             "(height, width) index of the link in the model; -1 where nothing is.");
  bind_array(picture, "normals", &PythonPicture::normals, "float32",
             "(height, width, 3) unit, in the world; 0 where nothing is.");
  picture
      .def("__repr__",
           [](const PythonPicture& self) {
             const Camera& camera = self.cameras.front();
             std::string text = self.is_one ? "<Picture" : "<" + std::to_string(self.cameras.size()) + " pictures";
             text += " of " + std::to_string(camera.width) + " x " + std::to_string(camera.height) + " pixels:";
             if (!self.colour.is_none()) text += " colour";
             if (!self.depth.is_none()) text += " depth";
             if (!self.segmentation.is_none()) text += " segmentation";
             if (!self.normals.is_none()) text += " normals";
             return text + ">";
           })
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
    patterns.push_back(is_die ? Pattern::kDie : usual_pattern(geom));
  }
  return patterns;
}

constexpr const char* kWanted =
    "marks are drawn over it. textures: by names of geoms or links, else those of the model's files. colour, depth, "
    "segmentation, normals: what is "
    "wanted. Raises ValueError on numbers that do not fit, KeyError on a camera's frame, a geom or a link that is not "
    "there.";

/// The signature of a `render` whose own arguments come first. `several`: looks and textures may be one each.
std::string signature_of(const std::string& own, bool several) {
  const auto or_list = [&](const std::string& one) {
    return several ? one + " | collections.abc.Sequence[" + one + "]" : one;
  };
  return "def render(self, " + own + ", look: " + or_list("manyhands._core.render.Look") +
         " = ..., marks: collections.abc.Sequence[manyhands._core.render.Mark] = [], textures: " +
         or_list("collections.abc.Mapping[str, manyhands._core.render.Texture]") +
         " = {}, colour: bool = True, depth: bool = True, segmentation: bool = True, normals: bool = False) -> "
         "manyhands._core.render.Picture";
}

constexpr const char* kCameras =
    "camera: manyhands._core.render.Camera | collections.abc.Sequence[manyhands._core.render.Camera], *, ";
constexpr const char* kTints = "rgba: numpy.typing.NDArray[numpy.float32] | None = None";

void bind_renderer(nb::module_& m) {
  nb::class_<Renderer>(m, "Renderer", "Takes pictures of a model at given configurations, with threads of its own.")
      .def(
          "__init__",
          [](Renderer* self, const PythonModel& model, int num_threads) {
            new (self) Renderer(model.model, num_threads, read_image);
          },
          "model"_a, "num_threads"_a = 0,
          "num_threads: 0 takes the variable MANYHANDS_THREADS, or as many as the machine has cores.")
      .def("__repr__", [](const Renderer& self) { return "<Renderer of '" + self.scene().model().name() + "'>"; })
      .def(
          "render",
          [](Renderer& self, const bindings::Numbers& q, const Cameras& camera,
             const std::optional<bindings::Numbers>& mocap, const Looks& look, const Marks& marks,
             const Textures& textures, const Tints& rgba, bool colour, bool depth, bool segmentation, bool normals) {
            const Model& model = self.scene().model();
            const std::size_t nq = static_cast<std::size_t>(model.nq());
            const std::size_t n = nq > 0 ? bindings::rows_of("q", q, nq) : 1;
            auto shots = shots_of(model, n, camera, look, marks, textures, rgba, [&](std::size_t i) {
              return std::vector<double>(q.data() + i * nq, q.data() + (i + 1) * nq);
            });
            for (Shot& shot : shots) {
              if (mocap) shot.mocap.assign(mocap->data(), mocap->data() + mocap->size());
            }
            return bindings::take_pictures(self, std::move(shots), {colour, depth, segmentation, normals},
                                           q.ndim() == 1);
          },
          "q"_a, "camera"_a, nb::kw_only(), "mocap"_a = nb::none(), "look"_a = Look{}, "marks"_a = Marks{},
          "textures"_a = NamedTextures{}, "rgba"_a = nb::none(), "colour"_a = true, "depth"_a = true,
          "segmentation"_a = true, "normals"_a = false,
          nb::sig(signature_of(std::string("q: numpy.typing.NDArray[numpy.floating], ") + kCameras + kTints +
                                   ", mocap: numpy.typing.NDArray[numpy.float64] | None = None",
                               true)
                      .c_str()),
          (std::string("One picture at q (nq), or n at rows (n, nq): one camera, look and dict of textures for all, or "
                       "one each. mocap (mocap bodies, 7): where these are, by default where the model has them. rgba "
                       "(n, geoms, 4): other colours for the model's geoms. ") +
           kWanted)
              .c_str());
}

void bind_world_render(nb::module_& m) {
  auto world = nb::borrow<nb::class_<World>>(m.attr("World"));
  world.def(
      "render",
      [](World& self, const Camera& camera, const Look& look, const Marks& marks, const NamedTextures& textures,
         const std::vector<std::string>& dice, bool colour, bool depth, bool segmentation, bool normals) {
        const std::shared_ptr<Renderer> renderer = renderer_of(self.shared_model(), read_image);
        auto shots = shots_of(self.model(), 1, camera, look, marks, textures, {},
                              [&](std::size_t) { return std::vector<double>(self.q().begin(), self.q().end()); });
        shots[0].mocap.assign(self.mocap().begin(), self.mocap().end());
        shots[0].guise.patterns = with_dice(self.model(), dice);
        return bindings::take_pictures(*renderer, std::move(shots), {colour, depth, segmentation, normals}, true);
      },
      "camera"_a, nb::kw_only(), "look"_a = Look{}, "marks"_a = Marks{}, "textures"_a = NamedTextures{},
      "dice"_a = std::vector<std::string>{}, "colour"_a = true, "depth"_a = true, "segmentation"_a = true,
      "normals"_a = false,
      nb::sig(signature_of("camera: manyhands._core.render.Camera, *, dice: collections.abc.Sequence[str] = []", false)
                  .c_str()),
      (std::string("A picture of the world as it is. dice: names of boxes that show a colour on each face; ") + kWanted)
          .c_str());
  auto batch = nb::borrow<nb::class_<Batch>>(m.attr("Batch"));
  batch.def(
      "render",
      [](Batch& self, const Cameras& camera, const std::optional<std::vector<std::size_t>>& worlds, const Looks& look,
         const Marks& marks, const Textures& textures, const Tints& rgba, bool colour, bool depth, bool segmentation,
         bool normals) {
        const std::vector<float> q = self.q(), mocap = self.mocap();
        const std::size_t nq = static_cast<std::size_t>(self.model().nq()),
                          poses = 7 * self.model().mocap_bodies().size(),
                          all = static_cast<std::size_t>(self.num_worlds()), n = worlds ? worlds->size() : all;
        auto shots = shots_of(self.model(), n, camera, look, marks, textures, rgba, [&](std::size_t i) {
          const std::size_t row = worlds ? (*worlds)[i] : i;
          if (row >= all) throw std::out_of_range("there is no world " + std::to_string(row));
          return std::vector<double>(q.data() + row * nq, q.data() + (row + 1) * nq);
        });
        for (std::size_t i = 0; i < n; ++i) {
          const float* const first = mocap.data() + poses * (worlds ? (*worlds)[i] : i);
          shots[i].mocap.assign(first, first + poses);
        }
        return bindings::take_pictures(*renderer_of(self.shared_model(), read_image), std::move(shots),
                                       {colour, depth, segmentation, normals}, false);
      },
      "camera"_a, nb::kw_only(), "worlds"_a = nb::none(), "look"_a = Look{}, "marks"_a = Marks{},
      "textures"_a = NamedTextures{}, "rgba"_a = nb::none(), "colour"_a = true, "depth"_a = true,
      "segmentation"_a = true, "normals"_a = false,
      nb::sig(
          signature_of(std::string(kCameras) + "worlds: collections.abc.Sequence[int] | None = None, " + kTints, true)
              .c_str()),
      (std::string("Pictures of all worlds, or of those chosen, with the worlds as first axis: one camera, look and "
                   "dict of textures for all, or one each. rgba (pictures, geoms, 4): other colours for the model's "
                   "geoms. ") +
       kWanted)
          .c_str());
}

}  // namespace

void bind_pictures(nb::module_& m, nb::module_& parent) {
  bind_picture(m);
  bind_renderer(m);
  bind_world_render(parent);
}

}  // namespace manyhands
