// manyhands._core: how models are built in Python.
#include "manyhands/model/model_builder.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <map>
#include <tuple>

#include "bindings/bindings.h"
#include "bindings/model/builder_names.h"
#include "bindings/model/inertia_matrix.h"
#include "bindings/model/mesh_arrays.h"
#include "bindings/model/model_values.h"
#include "bindings/model/python_model.h"
#include "manyhands/model/convex_parts.h"
#include "manyhands/model/io/mesh/mesh_file.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::joint_of;
using bindings::kInfinity;
using bindings::link_of;
using bindings::Matrix3;
using bindings::mesh_of;
using bindings::named;
using bindings::NumberOrNumbers;
using bindings::Numbers3;
using bindings::Numbers4;
using bindings::Rows3;
using bindings::size_of;
using bindings::symmetric;
using bindings::tendon_of;
using bindings::transform;
using bindings::vec3;

constexpr std::array<std::pair<const char*, JointType>, 8> kJointTypes{{{"fixed", JointType::kFixed},
                                                                        {"revolute", JointType::kRevolute},
                                                                        {"continuous", JointType::kContinuous},
                                                                        {"prismatic", JointType::kPrismatic},
                                                                        {"spherical", JointType::kSpherical},
                                                                        {"planar", JointType::kPlanar},
                                                                        {"floating", JointType::kFloating},
                                                                        {"mocap", JointType::kMocap}}};

nb::class_<ModelBuilder> bind_tree(nb::module_& m) {
  return nb::class_<ModelBuilder>(m, "ModelBuilder",
                                  "Collects links, joints, geoms and what couples them, and makes a Model. The link "
                                  "'world' is there from the start; a link without a "
                                  "joint to a parent is welded to it, a free body is joined to it by a floating joint. "
                                  "Raises ValueError on what "
                                  "cannot be part of a model, KeyError on unknown links.")
      .def(nb::init<std::string>(), "name"_a = "model")
      .def("__repr__",
           [](const ModelBuilder& self) {
             return "<ModelBuilder: " + std::to_string(self.links().size() - 1) + " links, " +
                    std::to_string(self.joints().size()) + " joints>";
           })
      .def(
          "add_link",
          [](ModelBuilder& self, const std::string& name, double mass, const Numbers3& com, const Matrix3& inertia,
             double gravity_compensation) {
            const SymMat3<double> I = symmetric("link '" + name + "'", inertia);
            const LinkId id = self.add_link(name, {.mass = mass, .com = vec3(com), .inertia = I});
            self.link(id).gravity_compensation = gravity_compensation;
          },
          "name"_a, nb::kw_only(), "mass"_a = 0.0, "com"_a = Numbers3{}, "inertia"_a = Matrix3{},
          "gravity_compensation"_a = 0.0,
          nb::sig("def add_link(self, name: str, *, mass: float = 0.0, com: numpy.typing.ArrayLike = (0, 0, 0), "
                  "inertia: numpy.typing.ArrayLike = ((0, 0, 0), (0, 0, 0), (0, 0, 0)), "
                  "gravity_compensation: float = 0.0) -> None"),
          "mass [kg]; com: centre of mass in the link's frame (3) [m]; inertia about it in the frame's axes (3, 3) "
          "[kg m^2]; gravity_compensation: share of its weight that is carried for it.")
      .def(
          "add_joint",
          [](ModelBuilder& self, const std::string& name, const std::string& type, const std::string& parent,
             const std::string& child, const Numbers3& position, const Numbers4& orientation, const Numbers3& axis,
             double lower, double upper, double effort, double velocity, double damping, double friction,
             double armature, const std::vector<double>& initial, double stiffness,
             const std::vector<double>& spring_reference, const std::optional<Compliance>& compliance) {
            self.add_joint(
                {.name = name,
                 .type = named("joint type", type, kJointTypes),
                 .parent = link_of(self, parent),
                 .child = link_of(self, child),
                 .X_PF = transform("joint '" + name + "'", position, orientation),
                 .axis = vec3(axis),
                 .limits =
                     {.lower = lower, .upper = upper, .effort = effort, .velocity = velocity, .compliance = compliance},
                 .damping = damping,
                 .friction = friction,
                 .armature = armature,
                 .stiffness = stiffness,
                 .initial = initial,
                 .spring_reference = spring_reference});
          },
          "name"_a, "type"_a, "parent"_a, "child"_a, nb::kw_only(), "position"_a = Numbers3{},
          "quaternion"_a = Numbers4{0, 0, 0, 1}, "axis"_a = Numbers3{0, 0, 1}, "lower"_a = -kInfinity,
          "upper"_a = kInfinity, "effort"_a = kInfinity, "velocity"_a = kInfinity, "damping"_a = 0.0,
          "friction"_a = 0.0, "armature"_a = 0.0, "initial"_a = std::vector<double>{}, "stiffness"_a = 0.0,
          "spring_reference"_a = std::vector<double>{}, "compliance"_a = nb::none(),
          nb::sig("def add_joint(self, name: str, type: str, parent: str, child: str, *, "
                  "position: numpy.typing.ArrayLike = (0, 0, 0), quaternion: numpy.typing.ArrayLike = (0, 0, 0, 1), "
                  "axis: numpy.typing.ArrayLike = (0, 0, 1), lower: float = ..., upper: float = ..., "
                  "effort: float = ..., velocity: float = ..., damping: float = 0.0, friction: float = 0.0, "
                  "armature: float = 0.0, initial: numpy.typing.ArrayLike = (), stiffness: float = 0.0, "
                  "spring_reference: numpy.typing.ArrayLike = (), compliance: Compliance | None = None) -> None"),
          "Joins two links. type: as `Joint.type`; position (3) [m] and quaternion xyzw (4): the joint frame F in the "
          "parent; axis in F (3); initial: where it starts, in q; spring_reference: where its spring is at rest; "
          "compliance: of "
          "its limits, which else hold exactly.");
}

void bind_shapes(nb::class_<ModelBuilder>& builder) {
  builder
      .def(
          "add_geom",
          [](ModelBuilder& self, const std::string& link, const std::string& shape, const NumberOrNumbers& size,
             const std::string& name, const Numbers3& position, const Numbers4& orientation, int mesh, int height_field,
             double friction, double restitution, double rolling_friction, double spinning_friction,
             std::uint32_t group, std::uint32_t mask, double margin, bool visual, const std::array<float, 4>& rgba,
             const std::optional<Compliance>& compliance) {
            const ShapeType type = named("shape", shape, bindings::kShapes);
            return self
                .add_geom({.name = name,
                           .role = visual ? GeomRole::kVisual : GeomRole::kCollision,
                           .link = link_of(self, link),
                           .X_LG = transform("geom '" + name + "'", position, orientation),
                           .shape = {.type = type,
                                     .size = size_of(shape, type, size),
                                     .mesh = MeshId(mesh),
                                     .height_field = HeightFieldId(height_field)},
                           .rgba = rgba,
                           .surface = {.lateral_friction = friction,
                                       .spinning_friction = spinning_friction,
                                       .rolling_friction = rolling_friction,
                                       .restitution = restitution,
                                       .compliance = compliance},
                           .filter = {.group = group, .mask = mask},
                           .margin = margin})
                .value();
          },
          "link"_a, "shape"_a, "size"_a = std::vector<double>{}, nb::kw_only(), "name"_a = "",
          "position"_a = Numbers3{}, "quaternion"_a = Numbers4{0, 0, 0, 1}, "mesh"_a = -1, "height_field"_a = -1,
          "friction"_a = 0.5, "restitution"_a = 0.0, "rolling_friction"_a = 0.0, "spinning_friction"_a = 0.0,
          "group"_a = 1u, "mask"_a = 0xffffffffu, "margin"_a = 0.0, "visual"_a = false,
          "rgba"_a = std::array<float, 4>{0.7f, 0.7f, 0.7f, 1.0f}, "compliance"_a = nb::none(),
          nb::sig(
              "def add_geom(self, link: str, shape: typing.Literal['sphere', 'capsule', 'cylinder', 'box', 'plane', "
              "'mesh', 'convex', 'height_field'], size: float | numpy.typing.ArrayLike = (), *, name: str = '', "
              "position: numpy.typing.ArrayLike = (0, 0, 0), quaternion: numpy.typing.ArrayLike = (0, 0, 0, 1), "
              "mesh: int = -1, height_field: int = -1, friction: float = 0.5, restitution: float = 0.0, "
              "rolling_friction: float = 0.0, spinning_friction: float = 0.0, group: int = 1, "
              "mask: int = 0xffffffff, margin: float = 0.0, visual: bool = False, "
              "rgba: numpy.typing.ArrayLike = (0.7, 0.7, 0.7, 1), compliance: Compliance | None = None) -> int"),
          "Adds a shape to a link and returns its index. size, position, quaternion, mesh, height_field, the "
          "frictions, "
          "group, mask and margin: as in `Geom`. Planes, height fields and meshes that are touched belong to links "
          "that "
          "do not move. visual: seen, but touches nothing. compliance: of the surface, which else is hard; of "
          "two that touch, the mean counts, where a hard one has the default.")
      .def(
          "add_mesh",
          [](ModelBuilder& self, const std::filesystem::path& path, const Numbers3& scale) {
            return self.add_mesh(load_mesh(path, vec3(scale))).value();
          },
          "path"_a, nb::kw_only(), "scale"_a = Numbers3{1, 1, 1},
          nb::sig("def add_mesh(self, path: str | os.PathLike, *, scale: numpy.typing.ArrayLike = (1, 1, 1)) -> int"),
          "Reads an STL, OBJ, DAE or glTF file and returns the mesh's index, for `add_geom`. Raises RuntimeError if it "
          "cannot.")
      .def(
          "add_mesh_arrays",
          [](ModelBuilder& self, const Rows3<float>& vertices, const Rows3<int>& triangles) {
            return self.add_mesh(mesh_of(vertices, triangles)).value();
          },
          "vertices"_a, "triangles"_a,
          nb::sig("def add_mesh_arrays(self, vertices: numpy.typing.NDArray[numpy.floating], "
                  "triangles: numpy.typing.NDArray[numpy.integer]) -> int"),
          "vertices (n, 3) [m]; triangles (m, 3), indices counter-clockwise seen from outside. Returns the mesh's "
          "index.")
      .def(
          "add_height_field",
          [](ModelBuilder& self, const bindings::Array<double, 2>& heights, double dx, double dy) {
            HeightField field{.columns = static_cast<int>(heights.shape(1)),
                              .rows = static_cast<int>(heights.shape(0)),
                              .dx = dx,
                              .dy = dy};
            field.height.assign(heights.data(), heights.data() + heights.size());
            return self.add_height_field(std::move(field)).value();
          },
          "heights"_a, nb::kw_only(), "dx"_a, "dy"_a,
          nb::sig("def add_height_field(self, heights: numpy.typing.NDArray[numpy.floating], *, dx: float, "
                  "dy: float) -> int"),
          "heights (rows along y, columns along x) [m], centred on the geom's origin; dx, dy: spacing [m]. Returns its "
          "index, for `add_geom`.");
}

void bind_couplings(nb::class_<ModelBuilder>& builder) {
  builder
      .def(
          "add_equality",
          [](ModelBuilder& self, const std::string& name, const std::string& type, const std::string& a,
             const std::string& b, const Numbers3& position_a, const Numbers4& quaternion_a, const Numbers3& position_b,
             const Numbers4& quaternion_b, double ratio, double offset, const std::array<double, 5>& polynomial,
             const std::pair<double, double>& references, double max_force, const std::optional<Compliance>& compliance,
             double torque_scale) {
            EqualityConstraint equality{.name = name, .type = named("equality type", type, bindings::kEqualities)};
            if (equality.type == EqualityType::kJoint || equality.type == EqualityType::kGear) {
              equality.joint_a = joint_of(self, a);
              equality.joint_b = joint_of(self, b);
            } else if (equality.type == EqualityType::kTendon) {
              if (!a.empty()) equality.tendon_a = tendon_of(self, a);
              equality.tendon_b = tendon_of(self, b);
              equality.polynomial = polynomial;
              std::tie(equality.reference_a, equality.reference_b) = references;
            } else {
              equality.link_a = link_of(self, a);
              equality.link_b = link_of(self, b);
            }
            equality.X_LA = transform("equality '" + name + "'", position_a, quaternion_a);
            equality.X_LB = transform("equality '" + name + "'", position_b, quaternion_b);
            equality.ratio = ratio;
            equality.offset = offset;
            equality.max_force = max_force;
            equality.compliance = compliance;
            equality.torque_scale = torque_scale;
            self.add_equality(std::move(equality));
          },
          "name"_a, "type"_a, "a"_a, "b"_a, nb::kw_only(), "position_a"_a = Numbers3{},
          "quaternion_a"_a = Numbers4{0, 0, 0, 1}, "position_b"_a = Numbers3{}, "quaternion_b"_a = Numbers4{0, 0, 0, 1},
          "ratio"_a = 1.0, "offset"_a = 0.0, "polynomial"_a = std::array<double, 5>{0, 1, 0, 0, 0},
          "references"_a = std::pair{0.0, 0.0}, "max_force"_a = kInfinity, "compliance"_a = nb::none(),
          "torque_scale"_a = 1.0,
          nb::sig(
              "def add_equality(self, name: str, type: typing.Literal['point', 'hinge', 'fixed', 'prismatic', "
              "'slider', 'joint', 'gear', 'tendon'], a: str, b: str, *, position_a: numpy.typing.ArrayLike = (0, 0, "
              "0), "
              "quaternion_a: numpy.typing.ArrayLike = (0, 0, 0, 1), position_b: numpy.typing.ArrayLike = (0, 0, 0), "
              "quaternion_b: numpy.typing.ArrayLike = (0, 0, 0, 1), ratio: float = 1.0, offset: float = 0.0, "
              "polynomial: collections.abc.Sequence[float] = (0, 1, 0, 0, 0), references: tuple[float, float] = (0, "
              "0), "
              "max_force: float = ..., compliance: Compliance | None = None, torque_scale: float = 1.0) -> None"),
          "Holds two parts together: frame B on link b coincides with frame A on link a ('point': in its origin; "
          "'hinge': may turn about z; 'fixed'; 'prismatic': may slide along z; 'slider': both); or joints a and b move "
          "as q_b = ratio q_a + offset ('joint') or v_b = ratio v_a ('gear'); or the lengths of tendons a and b, less "
          "their references, as length_b = polynomial(length_a), of powers 0 to 4 ('tendon'; without a, '', its length "
          "counts as 0). compliance: how it gives way, where it does not hold exactly; half of torque_scale [m/rad] is "
          "how its rotation counts beside its displacement.")
      .def(
          "add_tendon",
          [](ModelBuilder& self, const std::string& name, const std::map<std::string, double>& joints,
             const std::vector<std::pair<double, std::vector<std::pair<std::string, Numbers3>>>>& branches,
             const std::pair<double, double>& limits, double damping, double friction, double armature,
             double stiffness, const std::pair<double, double>& rest, const std::optional<Compliance>& compliance) {
            Tendon tendon{.name = name};
            for (const auto& [joint, coefficient] : joints)
              tendon.joints.push_back({joint_of(self, joint), coefficient});
            for (const auto& [divisor, points] : branches) {
              TendonBranch& branch = tendon.branches.emplace_back(TendonBranch{.divisor = divisor});
              for (const auto& [link, p] : points) branch.points.push_back({link_of(self, link), {p[0], p[1], p[2]}});
            }
            std::tie(tendon.lower, tendon.upper) = limits;
            tendon.damping = damping;
            tendon.friction = friction;
            tendon.armature = armature;
            tendon.stiffness = stiffness;
            std::tie(tendon.spring_lower, tendon.spring_upper) = rest;
            tendon.compliance = compliance;
            self.add_tendon(std::move(tendon));
          },
          "name"_a, nb::kw_only(), "joints"_a = std::map<std::string, double>(),
          "branches"_a = std::vector<std::pair<double, std::vector<std::pair<std::string, Numbers3>>>>(),
          "limits"_a = std::pair{-kInfinity, kInfinity}, "damping"_a = 0.0, "friction"_a = 0.0, "armature"_a = 0.0,
          "stiffness"_a = 0.0, "rest"_a = std::pair{0.0, 0.0}, "compliance"_a = nb::none(),
          nb::sig("def add_tendon(self, name: str, *, joints: dict[str, float] = ..., branches: "
                  "list[tuple[float, list[tuple[str, numpy.typing.ArrayLike]]]] = ..., limits: tuple[float, float] = "
                  "..., damping: float = 0.0, friction: float = 0.0, armature: float = 0.0, stiffness: float = 0.0, "
                  "rest: tuple[float, float] = (0, 0), compliance: Compliance | None = None) -> None"),
          "A length, and the forces along it; `Tendon` says what its numbers mean. Either a fixed tendon, the sum of "
          "coefficient q over joints of one degree of freedom, or a spatial one, which runs from point to point: "
          "branches of (divisor, [(link, point in its frame [m])]). Its spring pulls outside of `rest`. compliance: of "
          "its "
          "limits, which else hold exactly.")
      .def(
          "exclude_contact",
          [](ModelBuilder& self, const std::string& a, const std::string& b) {
            self.exclude_contact(link_of(self, a), link_of(self, b));
          },
          "link_a"_a, "link_b"_a, "Geoms of the two links never touch.")
      .def(
          "add_contact_pair",
          [](ModelBuilder& self, int a, int b, std::optional<double> friction, double restitution,
             double rolling_friction, double spinning_friction) {
            ContactPair pair{.a = GeomId(a), .b = GeomId(b)};
            if (friction) {
              pair.surface = SurfaceMaterial{.lateral_friction = *friction,
                                             .spinning_friction = spinning_friction,
                                             .rolling_friction = rolling_friction,
                                             .restitution = restitution};
            } else if (restitution != 0 || rolling_friction != 0 || spinning_friction != 0) {
              throw std::invalid_argument("the contact pair has a surface of its own only with friction; give it, too");
            }
            self.add_contact_pair(pair);
          },
          "geom_a"_a, "geom_b"_a, nb::kw_only(), "friction"_a = nb::none(), "restitution"_a = 0.0,
          "rolling_friction"_a = 0.0, "spinning_friction"_a = 0.0,
          "Two geoms, by their indices, may touch whatever their groups and links say. friction: if given, it and the "
          "other numbers replace what the geoms' own combine to.")
      .def(
          "set_contact_rules",
          [](ModelBuilder& self, const std::string& friction, const std::string& restitution, bool self_collision) {
            self.set_contact_rules({.friction = named("rule", friction, bindings::kCombineRules),
                                    .restitution = named("rule", restitution, bindings::kCombineRules),
                                    .self_collision = self_collision});
          },
          nb::kw_only(), "friction"_a = "geometric_mean", "restitution"_a = "maximum", "self_collision"_a = true,
          nb::sig("def set_contact_rules(self, *, friction: typing.Literal['product', 'geometric_mean', 'maximum', "
                  "'minimum'] = 'geometric_mean', restitution: typing.Literal['product', 'geometric_mean', 'maximum', "
                  "'minimum'] = 'maximum', self_collision: bool = True) -> None"),
          "How the numbers of two surfaces become one, and whether links of one tree touch each other.");
}

void bind_whole(nb::class_<ModelBuilder>& builder) {
  builder
      .def(
          "add_frame",
          [](ModelBuilder& self, const std::string& name, const std::string& link, const Numbers3& position,
             const Numbers4& orientation) {
            self.add_frame(name, link_of(self, link), transform("frame '" + name + "'", position, orientation));
          },
          "name"_a, "link"_a, nb::kw_only(), "position"_a = Numbers3{}, "quaternion"_a = Numbers4{0, 0, 0, 1},
          nb::sig("def add_frame(self, name: str, link: str, *, position: numpy.typing.ArrayLike = (0, 0, 0), "
                  "quaternion: numpy.typing.ArrayLike = (0, 0, 0, 1)) -> None"),
          "Names a pose on a link: position (3) [m] and quaternion xyzw (4) in its frame.")
      .def(
          "set_gravity", [](ModelBuilder& self, const Numbers3& gravity) { self.set_gravity(vec3(gravity)); },
          "gravity"_a, nb::sig("def set_gravity(self, gravity: numpy.typing.ArrayLike) -> None"),
          "(3) [m/s^2] in the world frame; (0, 0, -9.81) if never set.")
      .def(
          "set_medium",
          [](ModelBuilder& self, double density, double viscosity, const Numbers3& wind) {
            self.set_medium({.density = density, .viscosity = viscosity, .wind = vec3(wind)});
          },
          nb::kw_only(), "density"_a = 0.0, "viscosity"_a = 0.0, "wind"_a = Numbers3{},
          nb::sig("def set_medium(self, *, density: float = 0.0, viscosity: float = 0.0, "
                  "wind: numpy.typing.ArrayLike = (0, 0, 0)) -> None"),
          "What links move through: it drags on each as on the box of its inertia. Density [kg/m^3], viscosity [Pa s], "
          "wind (3) [m/s] in world axes. Air: 1.2 and 1.8e-5; water: 1000 and 1e-3.")
      .def("set_time_step", &ModelBuilder::set_time_step, "time_step"_a, "[s], for worlds that are not told another.")
      .def(
          "add_keyframe",
          [](ModelBuilder& self, const std::string& name, std::vector<double> q, std::vector<double> v,
             std::vector<double> ctrl, std::vector<double> act, double time) {
            self.add_keyframe({.name = name,
                               .time = time,
                               .q = std::move(q),
                               .v = std::move(v),
                               .ctrl = std::move(ctrl),
                               .act = std::move(act)});
          },
          "name"_a, nb::kw_only(), "q"_a = std::vector<double>{}, "v"_a = std::vector<double>{},
          "ctrl"_a = std::vector<double>{}, "act"_a = std::vector<double>{}, "time"_a = 0.0,
          nb::sig(
              "def add_keyframe(self, name: str, *, q: numpy.typing.ArrayLike = (), v: numpy.typing.ArrayLike = (), "
              "ctrl: numpy.typing.ArrayLike = (), act: numpy.typing.ArrayLike = (), time: float = 0.0) -> None"),
          "Names a state: q (nq), by default the initial one; v (nv), ctrl (nu), act (na), by default 0; time [s].")
      .def(
          "build", [](const ModelBuilder& self) { return std::make_unique<PythonModel>(self.build()); },
          "Checks the whole and makes the model. Raises ValueError, naming the part, on a cycle or on a joint that "
          "moves "
          "no inertia.");
}

}  // namespace

void bind_model_builder(nb::module_& m) {
  auto builder = bind_tree(m);
  bind_shapes(builder);
  bind_couplings(builder);
  bind_builder_actuators(builder);
  bind_builder_composition(builder);
  bind_whole(builder);
  m.def(
      "with_convex_parts",
      [](const PythonModel& model, const std::map<int, std::vector<std::pair<Rows3<float>, Rows3<int>>>>& parts) {
        std::map<MeshId, std::vector<Mesh>> meshes;
        for (const auto& [index, arrays] : parts) {
          if (index < 0 || index >= static_cast<int>(model.model->meshes().size())) {
            throw ModelError("there is no mesh " + std::to_string(index));
          }
          for (const auto& [vertices, triangles] : arrays) {
            meshes[MeshId(index)].push_back(mesh_of(vertices, triangles));
          }
        }
        return std::make_unique<PythonModel>(with_convex_parts(*model.model, meshes));
      },
      "model"_a, "parts"_a,
      nb::sig("def with_convex_parts(model: Model, parts: dict[int, list[tuple[numpy.typing.NDArray[numpy.float32], "
              "numpy.typing.NDArray[numpy.int32]]]]) -> Model"),
      "The model with the parts of some meshes, by their indices, in the place of these where they collide on a body "
      "that moves; see `manyhands.decompose_model`.");
}

}  // namespace manyhands
