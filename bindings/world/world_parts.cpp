// manyhands._core.World: parts that come and go, and the parameters of one world.
#include "bindings/world/world_parts.h"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "bindings/model/inertia_matrix.h"
#include "bindings/model/load_warning.h"
#include "bindings/model/model_values.h"
#include "bindings/model/python_model.h"
#include "manyhands/model/io/loaded_model.h"
#include "manyhands/model/io/mesh/mesh_file.h"
#include "manyhands/model/part_checks.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::Numbers3;
using bindings::Numbers4;
using bindings::transform;
using bindings::vec3;
using Vertices = nb::ndarray<const float, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

using Colour = std::vector<double>;

/// The part of a body's arguments that all shapes share.
struct Common {
  std::string name;
  double mass;
  Numbers3 position;
  Numbers4 quaternion;
  double friction, restitution, spinning_friction, rolling_friction;
  bool fixed;
  std::optional<Colour> colour;
};

/// Of bodies without a colour, in turn: light enough to show their shape, and told apart by most eyes.
constexpr std::array<std::array<float, 3>, 8> kPalette{{{0.90f, 0.56f, 0.27f},
                                                        {0.22f, 0.62f, 0.62f},
                                                        {0.93f, 0.76f, 0.35f},
                                                        {0.44f, 0.53f, 0.78f},
                                                        {0.84f, 0.42f, 0.42f},
                                                        {0.55f, 0.72f, 0.40f},
                                                        {0.68f, 0.50f, 0.72f},
                                                        {0.62f, 0.47f, 0.37f}}};
constexpr std::array<float, 3> kGround{0.70f, 0.72f, 0.74f};

std::array<float, 4> rgba_of(const World& world, const Shape& shape, const Common& c) {
  if (!c.colour) {
    const std::size_t turn = world.parts().links().size() % kPalette.size();
    const std::array<float, 3>& rgb = shape.type == ShapeType::kPlane ? kGround : kPalette[turn];
    return {rgb[0], rgb[1], rgb[2], 1};
  }
  const Colour& colour = *c.colour;
  const bool is_one = colour.size() == 3 || colour.size() == 4;
  if (!is_one || !std::ranges::all_of(colour, [](double x) { return x >= 0 && x <= 1; })) {
    throw std::invalid_argument("body '" + c.name +
                                "': a colour is red, green, blue and, if you like, opacity, each from 0 to 1");
  }
  std::array<float, 4> rgba{0, 0, 0, 1};
  std::ranges::transform(colour, rgba.begin(), [](double x) { return static_cast<float>(x); });
  return rgba;
}

void add_shape(World& world, const Shape& shape, const Common& c, Mesh mesh = {}) {
  world.add_body({.name = c.name,
                  .shape = shape,
                  .mesh = std::move(mesh),
                  .mass = c.mass,
                  .X_WB = transform("body '" + c.name + "'", c.position, c.quaternion),
                  .surface = {.lateral_friction = c.friction,
                              .spinning_friction = c.spinning_friction,
                              .rolling_friction = c.rolling_friction,
                              .restitution = c.restitution},
                  .rgba = rgba_of(world, shape, c),
                  .fixed = c.fixed});
}

/// The signature of a method that adds a body of the given size arguments.
std::string adds(const std::string& method, const std::string& size) {
  return "def " + method + "(self, name: str, " + size +
         ", mass: float = 1.0, position: numpy.typing.ArrayLike = (0, 0, 0), "
         "quaternion: numpy.typing.ArrayLike = (0, 0, 0, 1), *, friction: float = 0.5, restitution: float = 0.0, "
         "spinning_friction: float = 0.0, rolling_friction: float = 0.0, fixed: bool = False, "
         "colour: collections.abc.Sequence[float] | None = None) -> None";
}

constexpr const char* kAdds =
    " mass [kg] is spread evenly over the shape. position (3) [m], quaternion xyzw (4): the middle of the shape in the "
    "world. friction: lateral; spinning and rolling friction are moments per normal force [m]. fixed: welded to the "
    "world. colour: red, green, blue and, if given, opacity, 0 to 1; without, one of a palette. The link, and the "
    "geom, have the body's name. Raises ValueError on a taken name, or a mass or size that is "
    "not above 0.";

/// Binds a method whose size arguments `Sizes` become a Shape by `shape_of`; Common's follow.
template <class... Sizes, class ShapeOf, class... Names>
void bind_adder(nb::class_<World>& world, const char* method, const std::string& signature, const std::string& what,
                ShapeOf shape_of, Names... names) {
  static const std::string text = what + kAdds;
  world.def(
      method,
      [shape_of](World& self, const std::string& name, const Sizes&... sizes, double mass, const Numbers3& position,
                 const Numbers4& quaternion, double friction, double restitution, double spinning, double rolling,
                 bool fixed, const std::optional<Colour>& colour) {
        add_shape(self, shape_of(sizes...),
                  {name, mass, position, quaternion, friction, restitution, spinning, rolling, fixed, colour});
      },
      "name"_a, names..., "mass"_a = 1.0, "position"_a = Numbers3{}, "quaternion"_a = Numbers4{0, 0, 0, 1},
      nb::kw_only(), "friction"_a = 0.5, "restitution"_a = 0.0, "spinning_friction"_a = 0.0, "rolling_friction"_a = 0.0,
      "fixed"_a = false, "colour"_a = nb::none(), nb::sig(signature.c_str()), text.c_str());
}

void bind_shapes(nb::class_<World>& world) {
  using enum ShapeType;
  bind_adder<Numbers3>(
      world, "add_box", adds("add_box", "size: numpy.typing.ArrayLike"), "Adds a box of half extents `size` (3) [m].",
      [](const Numbers3& size) { return Shape{.type = kBox, .size = vec3(size)}; }, "size"_a);
  bind_adder<double>(
      world, "add_sphere", adds("add_sphere", "radius: float"), "Adds a ball of that radius [m].",
      [](double radius) { return Shape{.type = kSphere, .size = {radius, 0, 0}}; }, "radius"_a);
  bind_adder<double, double>(
      world, "add_cylinder", adds("add_cylinder", "radius: float, half_length: float"),
      "Adds a cylinder along z: radius and half of its length [m].",
      [](double radius, double half) { return Shape{.type = kCylinder, .size = {radius, half, 0}}; }, "radius"_a,
      "half_length"_a);
  bind_adder<double, double>(
      world, "add_capsule", adds("add_capsule", "radius: float, half_length: float"),
      "Adds a capsule along z: radius, and half of the length between the caps' centres [m].",
      [](double radius, double half) { return Shape{.type = kCapsule, .size = {radius, half, 0}}; }, "radius"_a,
      "half_length"_a);
}

void add_mesh(World& self, const std::string& name, const std::variant<Vertices, std::filesystem::path>& mesh,
              double mass, const Numbers3& position, const Numbers4& quaternion, const Numbers3& scale, double friction,
              double restitution, double spinning, double rolling, bool fixed, const std::optional<Colour>& colour) {
  Mesh parts;
  if (const auto* path = std::get_if<std::filesystem::path>(&mesh)) {
    if (!std::filesystem::exists(*path)) throw FileNotFound(*path);
    parts = load_mesh(*path, vec3(scale));
  } else {
    const Vertices& points = std::get<Vertices>(mesh);
    for (std::size_t i = 0; i < points.shape(0); ++i) {
      const float* p = points.data() + 3 * i;
      parts.vertices.push_back({p[0] * static_cast<float>(scale[0]), p[1] * static_cast<float>(scale[1]),
                                p[2] * static_cast<float>(scale[2])});
    }
    parts.source = "points";
  }
  const Shape shape{.type = fixed && !parts.triangles.empty() ? ShapeType::kMesh : ShapeType::kConvex};
  add_shape(self, shape, {name, mass, position, quaternion, friction, restitution, spinning, rolling, fixed, colour},
            std::move(parts));
}

void bind_surfaces(nb::class_<World>& world) {
  static const std::string mesh = adds("add_mesh", "mesh: str | os.PathLike | numpy.typing.NDArray[numpy.floating]");
  static const std::string mesh_text =
      "Adds a mesh file (STL, OBJ, DAE) or points (n, 3) [m], times `scale` (3). A body that moves is the convex hull "
      "of "
      "the vertices; a fixed one is the surface of its triangles." +
      std::string(kAdds);
  std::string signature = mesh;
  signature.insert(signature.find("*, friction"), "scale: numpy.typing.ArrayLike = (1, 1, 1), ");
  static const std::string mesh_signature = signature;
  world
      .def("add_mesh", &add_mesh, "name"_a, "mesh"_a, "mass"_a = 1.0, "position"_a = Numbers3{},
           "quaternion"_a = Numbers4{0, 0, 0, 1}, "scale"_a = Numbers3{1, 1, 1}, nb::kw_only(), "friction"_a = 0.5,
           "restitution"_a = 0.0, "spinning_friction"_a = 0.0, "rolling_friction"_a = 0.0, "fixed"_a = false,
           "colour"_a = nb::none(), nb::sig(mesh_signature.c_str()), mesh_text.c_str())
      .def(
          "add_plane",
          [](World& self, const std::string& name, const Numbers3& position, const Numbers4& quaternion,
             double friction, double restitution, const std::optional<Colour>& colour) {
            add_shape(self, {.type = ShapeType::kPlane},
                      {name, 0, position, quaternion, friction, restitution, 0, 0, true, colour});
          },
          "name"_a = "plane", "position"_a = Numbers3{}, "quaternion"_a = Numbers4{0, 0, 0, 1}, nb::kw_only(),
          "friction"_a = 0.5, "restitution"_a = 0.0, "colour"_a = nb::none(),
          nb::sig("def add_plane(self, name: str = 'plane', position: numpy.typing.ArrayLike = (0, 0, 0), "
                  "quaternion: numpy.typing.ArrayLike = (0, 0, 0, 1), *, friction: float = 0.5, "
                  "restitution: float = 0.0, colour: collections.abc.Sequence[float] | None = None) -> None"),
          "Adds ground: all below the plane through `position` (3) [m] whose normal is the z axis of `quaternion`. "
          "colour: red, green, blue and, if given, opacity, 0 to 1.");
}

void bind_editing(nb::class_<World>& world) {
  using What = std::variant<const PythonModel*, const ModelBuilder*, std::filesystem::path>;
  world
      .def(
          "add",
          [](World& self, const What& what, const Numbers3& position, const Numbers4& quaternion,
             const std::string& name, bool allow_outside_package) {
            const Transform<double> X_WM = transform("the model's place", position, quaternion);
            if (const auto* model = std::get_if<const PythonModel*>(&what)) {
              self.add(*(*model)->model, X_WM, name);
            } else if (const auto* builder = std::get_if<const ModelBuilder*>(&what)) {
              self.add((*builder)->build(), X_WM, name);
            } else {
              const std::size_t before = self.report().notes.size();
              self.add_file(std::get<std::filesystem::path>(what), X_WM, name, allow_outside_package);
              bindings::warn_of(std::span(self.report().notes).subspan(before), "the world's `report`");
            }
          },
          "model"_a, "position"_a = Numbers3{}, "quaternion"_a = Numbers4{0, 0, 0, 1}, "name"_a = "", nb::kw_only(),
          "allow_outside_package"_a = false,
          nb::sig("def add(self, model: Model | ModelBuilder | str | os.PathLike, "
                  "position: numpy.typing.ArrayLike = (0, 0, 0), quaternion: numpy.typing.ArrayLike = (0, 0, 0, 1), "
                  "name: str = '', *, allow_outside_package: bool = False) -> None"),
          "Adds a model, or a URDF, MJCF or SDF file, whose world frame comes to lie at position (3) [m] and "
          "quaternion "
          "xyzw "
          "(4). With a name, its parts are called 'name/part'. What is there keeps its motion. "
          "allow_outside_package: whether the files that a file names may lie outside its package. Raises ValueError "
          "if "
          "a name is taken.")
      .def("remove", &World::remove, "name"_a,
           "Removes what was added by that name, or the link and all that hangs on it. Raises KeyError, which lists "
           "the names there are.")
      .def(
          "set_collision", &World::set_collision, "link_a"_a, "link_b"_a, "enabled"_a,
          "Whether two links may touch; or all links of two models, by the names they were added by. Joint neighbours, "
          "filters and links of one body have their say besides. Raises KeyError for a name that is not there.")
      .def(
          "weld",
          [](World& self, const std::string& a, const std::optional<std::string>& b) {
            return self.weld(a, b.value_or(""));
          },
          "link_a"_a, "link_b"_a = nb::none(),
          "Holds two links as they are to each other now, until `unweld`; None is the world. Returns the weld's name. "
          "Raises KeyError for a link that is not there, ValueError for one link twice or a weld that there is.")
      .def(
          "unweld", [](World& self, const std::string& name) { self.unweld(name); }, "name"_a,
          "Ends a weld. Raises KeyError if there is none of that name.")
      .def_prop_ro("names", &World::names, "What `remove` takes as a whole: models, and links on the world.");
}

using GetNumber = double (World::*)(std::string_view) const;
using SetNumber = void (World::*)(std::string_view, double);

void bind_parameter(nb::class_<World>& world, const char* name, const char* of, GetNumber get, SetNumber set,
                    const char* doc) {
  if (get != nullptr) {
    world.def(name, [get](const World& self, const std::string& part) { return (self.*get)(part); }, nb::arg(of), doc);
  }
  const std::string setter = std::string("set_") + name;
  world.def(
      setter.c_str(), [set](World& self, const std::string& part, double value) { (self.*set)(part, value); },
      nb::arg(of), "value"_a, doc);
}

void bind_parameters(nb::class_<World>& world) {
  bind_parameter(world, "mass", "link", &World::mass, &World::set_mass,
                 "Of a link [kg]; setting it scales the inertia.");
  world.def(
      "set_inertial",
      [](World& self, const std::string& link, double mass, const Numbers3& com, const bindings::Matrix3& inertia) {
        const std::string what = "link '" + link + "'";
        const Inertial inertial{.mass = mass, .com = vec3(com), .inertia = bindings::symmetric(what, inertia)};
        check_inertial(link, inertial);
        self.set_link_inertial(self.model().link_id(link), inertial);
      },
      "link"_a, nb::kw_only(), "mass"_a, "com"_a = Numbers3{}, "inertia"_a,
      nb::sig("def set_inertial(self, link: str, *, mass: float, com: numpy.typing.ArrayLike = (0, 0, 0), "
              "inertia: numpy.typing.ArrayLike) -> None"),
      "Of a link, as of a hollow body: mass [kg]; com: centre of mass in its frame (3) [m]; inertia about it, in the "
      "frame's axes (3, 3) [kg m^2]. Raises KeyError for an unknown link, ValueError for a mass that is not above 0 "
      "and a matrix that is no inertia.");
  bind_parameter(world, "friction", "name", &World::friction, &World::set_friction,
                 "Lateral friction of a geom, or of all colliding geoms of a link.");
  bind_parameter(world, "spinning_friction", "name", nullptr, &World::set_spinning_friction,
                 "Of a geom, or of all colliding geoms of a link [m].");
  bind_parameter(world, "rolling_friction", "name", nullptr, &World::set_rolling_friction,
                 "Of a geom, or of all colliding geoms of a link [m].");
  bind_parameter(world, "restitution", "name", &World::restitution, &World::set_restitution,
                 "Of a geom, or of all colliding geoms of a link.");
  bind_parameter(world, "damping", "joint", &World::damping, &World::set_damping, "Of a joint [N m s/rad or N s/m].");
  bind_parameter(world, "stiffness", "joint", &World::stiffness, &World::set_stiffness,
                 "Of a joint's spring [N m/rad or N/m].");
  bind_parameter(world, "joint_friction", "joint", nullptr, &World::set_joint_friction,
                 "Dry friction of a joint [N m or N].");
  bind_parameter(world, "armature", "joint", nullptr, &World::set_armature,
                 "Rotor inertia seen at a joint [kg m^2 or kg].");
  world
      .def_prop_rw(
          "gravity", [](const World& self) { return bindings::vector3(self.gravity()); },
          [](World& self, const Numbers3& gravity) { self.set_gravity(vec3(gravity)); },
          nb::for_getter(nb::sig("def gravity(self) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def gravity(self, arg: numpy.typing.ArrayLike, /) -> None")),
          "In the world frame (3) [m/s^2].")
      .def(
          "geom_size",
          [](const World& self, const std::string& geom) { return bindings::vector3(self.geom_size(geom)); }, "geom"_a,
          nb::sig("def geom_size(self, geom: str) -> numpy.typing.NDArray[numpy.float64]"),
          "Sphere: radius; capsule, cylinder: radius, half length; box: half extents (3) [m].")
      .def(
          "set_geom_size",
          [](World& self, const std::string& geom, const std::vector<double>& size) {
            if (size.empty() || size.size() > 3) throw std::invalid_argument("size has 1 to 3 numbers");
            Vec3<double> numbers = Vec3<double>::zero();
            std::copy(size.begin(), size.end(), &numbers.x);
            self.set_geom_size(geom, numbers);
          },
          "geom"_a, "size"_a, "As `geom_size`; the mass stays. Raises ValueError unless the numbers are above 0.")
      .def(
          "gains", [](const World& self, const std::string& actuator) { return self.gains(actuator); }, "actuator"_a,
          "(kp, kd) of an actuator.")
      .def(
          "set_gains",
          [](World& self, const std::string& actuator, double kp, double kd) { self.set_gains(actuator, kp, kd); },
          "actuator"_a, "kp"_a, "kd"_a, "Of a position or velocity actuator.");
}

}  // namespace

void bind_world_parts(nb::class_<World>& world) {
  bind_shapes(world);
  bind_surfaces(world);
  bind_editing(world);
  bind_parameters(world);
}

}  // namespace manyhands
