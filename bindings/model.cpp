// manyhands._core: models, how they are built and loaded, and where assets lie.
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <array>

#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "bindings/python_model.h"
#include "manyhands/base/assets.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/model/io/urdf.h"
#include "manyhands/model/model_builder.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::copied;
using Numbers3 = std::array<double, 3>;
using Numbers4 = std::array<double, 4>;
using Matrix3 = std::array<Numbers3, 3>;

constexpr const char* kArraySignature = "def {}(self) -> numpy.typing.NDArray[numpy.float64]";

std::string returns_array(const std::string& name) {
  std::string text = kArraySignature;
  return text.replace(text.find("{}"), 2, name);
}

nb::object vector3(const Vec3<double>& a) { return copied(&a.x, {3}); }

nb::object quaternion(const Mat3<double>& R) {
  const Quat<double> r = to_quat(R);
  return copied(&r.x, {4});
}

nb::object matrix(const SymMat3<double>& m) {
  const std::array rows{m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz};
  return copied(rows.data(), {3, 3});
}

Vec3<double> vec3(const Numbers3& a) { return {a[0], a[1], a[2]}; }

Transform<double> transform(const std::string& what, const Numbers3& position, const Numbers4& r) {
  const double length2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3];
  if (!(abs(length2 - 1) < 1e-6)) throw ModelError(what + ": the quaternion (x, y, z, w) must have length 1");
  return {to_matrix(normalized(Quat<double>{r[0], r[1], r[2], r[3]})), vec3(position)};
}

SymMat3<double> symmetric(const std::string& what, const Matrix3& m) {
  for (const auto& [i, j] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
    const auto r = static_cast<std::size_t>(i), c = static_cast<std::size_t>(j);
    if (m[r][c] != m[c][r]) throw ModelError(what + ": the inertia matrix must be symmetric");
  }
  return {m[0][0], m[1][1], m[2][2], m[0][1], m[0][2], m[1][2]};
}

JointType joint_type(const std::string& name) {
  std::string known;
  for (const JointType type : {JointType::kFixed, JointType::kRevolute, JointType::kContinuous, JointType::kPrismatic,
                               JointType::kSpherical, JointType::kPlanar, JointType::kFloating}) {
    if (name == to_string(type)) return type;
    known += std::string(" '") + to_string(type) + "'";
  }
  throw ModelError("there is no joint type '" + name + "'; there are" + known);
}

LinkId link_of(const ModelBuilder& builder, const std::string& name) {
  for (std::size_t i = 0; i < builder.links().size(); ++i) {
    if (builder.links()[i].name == name) return LinkId(i);
  }
  throw std::out_of_range("link '" + name + "' has not been added to the builder");
}

template <class Part>
std::vector<Part> copy_of(std::span<const Part> parts) {
  return {parts.begin(), parts.end()};
}

void bind_errors(nb::module_& m) {
  nb::register_exception_translator([](const std::exception_ptr& error, void*) {
    try {
      std::rethrow_exception(error);
    } catch (const std::out_of_range& e) {
      PyErr_SetString(PyExc_KeyError, e.what());
    } catch (const FileNotFound& e) {
      PyErr_SetString(PyExc_FileNotFoundError, e.what());
    }
  });
  nb::exception<UrdfError>(m, "UrdfError", PyExc_ValueError).doc() =
      "A URDF file is not a robot that can be loaded; the message says 'file:line: what was wrong'.";
}

void bind_report(nb::module_& m) {
  nb::class_<LoadNote>(m, "LoadNote", "One thing that a loader defaulted, repaired or ignored.")
      .def_prop_ro(
          "action", [](const LoadNote& note) { return to_string(note.action); },
          nb::sig("def action(self) -> typing.Literal['defaulted', 'repaired', 'ignored']"),
          "'defaulted': the file did not say; 'repaired': it said what cannot be simulated; 'ignored': it said what is "
          "not used.")
      .def_ro("file", &LoadNote::file)
      .def_ro("line", &LoadNote::line, "1-based; 0 if unknown.")
      .def_ro("element", &LoadNote::element, "What it is about, for example \"link 'panda_hand'\".")
      .def_ro("message", &LoadNote::message, "What was done, with the value taken.");
  nb::class_<LoadReport>(m, "LoadReport", "What a loader did with a file beyond reading it. str() gives a line a note.")
      .def_ro("notes", &LoadReport::notes, "In the order of the file.")
      .def("__len__", [](const LoadReport& report) { return report.notes.size(); })
      .def("__str__", &LoadReport::to_string)
      .def("__repr__", &LoadReport::to_string);
}

void bind_parts(nb::module_& m) {
  nb::class_<Link>(m, "Link", "A named rigid part. Its frame L is the frame of the joint that moves it, at q = 0.")
      .def_ro("name", &Link::name)
      .def("__repr__", [](const Link& link) { return "<Link '" + link.name + "'>"; })
      .def_prop_ro(
          "mass", [](const Link& link) { return link.inertial.mass; }, "[kg]")
      .def_prop_ro(
          "com", [](const Link& link) { return vector3(link.inertial.com); }, nb::sig(returns_array("com").c_str()),
          "Centre of mass in L, (3) [m].")
      .def_prop_ro(
          "inertia", [](const Link& link) { return matrix(link.inertial.inertia); },
          nb::sig(returns_array("inertia").c_str()), "About the centre of mass in L's axes, (3, 3) [kg m^2].")
      .def_prop_ro(
          "parent", [](const Link& link) { return link.parent.value(); }, "Index of the parent link; -1 for the world.")
      .def_prop_ro(
          "joint", [](const Link& link) { return link.joint.value(); }, "Index of the joint to it; -1 without one.")
      .def_prop_ro(
          "body", [](const Link& link) { return link.body.value(); },
          "The moving body that carries the link; links joined by fixed joints share one, 0 is the world.");

  nb::class_<Joint>(m, "Joint",
                    "Joins a child link to its parent P. Frame F is fixed in P; at q = 0 the child's frame "
                    "is F.")
      .def_ro("name", &Joint::name)
      .def("__repr__", [](const Joint& joint) { return "<Joint '" + joint.name + "': " + to_string(joint.type) + ">"; })
      .def_prop_ro(
          "type", [](const Joint& joint) { return to_string(joint.type); },
          "'fixed', 'revolute', 'continuous', 'prismatic', 'spherical', 'planar' or 'floating'.")
      .def_prop_ro(
          "parent", [](const Joint& joint) { return joint.parent.value(); }, "Index of the parent link.")
      .def_prop_ro(
          "child", [](const Joint& joint) { return joint.child.value(); }, "Index of the child link.")
      .def_prop_ro(
          "position", [](const Joint& joint) { return vector3(joint.X_PF.p); },
          nb::sig(returns_array("position").c_str()), "Of F in P, (3) [m].")
      .def_prop_ro(
          "quaternion", [](const Joint& joint) { return quaternion(joint.X_PF.R); },
          nb::sig(returns_array("quaternion").c_str()), "Of F in P, xyzw (4).")
      .def_prop_ro(
          "axis", [](const Joint& joint) { return vector3(joint.axis); }, nb::sig(returns_array("axis").c_str()),
          "Unit axis in F (3); of a planar joint, the normal.")
      .def_prop_ro(
          "lower", [](const Joint& joint) { return joint.limits.lower; }, "[rad or m]; -inf without a limit.")
      .def_prop_ro(
          "upper", [](const Joint& joint) { return joint.limits.upper; }, "[rad or m]; inf without a limit.")
      .def_prop_ro(
          "effort", [](const Joint& joint) { return joint.limits.effort; }, "[N m or N]; inf without a limit.")
      .def_prop_ro(
          "velocity", [](const Joint& joint) { return joint.limits.velocity; }, "[rad/s or m/s]; inf without a limit.")
      .def_ro("damping", &Joint::damping, "[N m s/rad or N s/m]")
      .def_ro("friction", &Joint::friction, "Dry friction [N m or N].")
      .def_ro("armature", &Joint::armature, "Rotor inertia seen at the joint [kg m^2 or kg].")
      .def_prop_ro(
          "nq", [](const Joint& joint) { return configuration_size(joint.type); }, "Coordinates in q.")
      .def_prop_ro(
          "nv", [](const Joint& joint) { return velocity_size(joint.type); }, "Coordinates in v.")
      .def_ro("iq", &Joint::iq, "Where they start in q; -1 for fixed joints.")
      .def_ro("iv", &Joint::iv, "Where they start in v; -1 for fixed joints.");

  nb::class_<Frame>(m, "Frame", "A named pose on a body. Every link is one, by the same name and index.")
      .def_ro("name", &Frame::name)
      .def("__repr__", [](const Frame& frame) { return "<Frame '" + frame.name + "'>"; })
      .def_prop_ro(
          "body", [](const Frame& frame) { return frame.body.value(); }, "The body that carries it; 0 is the world.");
}

void bind_model_class(nb::module_& m) {
  nb::class_<PythonModel>(
      m, "Model",
      "A robot or scene that never changes, made by `load_urdf` or `ModelBuilder.build`.\n\n"
      "Coordinates, depth first over the joints (see `Joint.iq`, `Joint.iv`): revolute, continuous: angle [rad]; "
      "prismatic: shift [m]; planar: x, y [m] across the axis and the angle [rad]; spherical: q is a quaternion xyzw, "
      "v "
      "the angular velocity in the joint frame F; floating: q is position [m] and quaternion xyzw, v is angular "
      "velocity, then velocity of the origin, both in F.")
      .def_prop_ro("name", [](const PythonModel& self) { return self.model->name(); })
      .def_prop_ro(
          "nq", [](const PythonModel& self) { return self.model->nq(); }, "Length of q.")
      .def_prop_ro(
          "nv", [](const PythonModel& self) { return self.model->nv(); }, "Length of v, a and tau.")
      .def_prop_ro(
          "num_bodies", [](const PythonModel& self) { return self.model->num_bodies(); },
          "Bodies that move on their own, and the world.")
      .def_prop_ro("links", [](const PythonModel& self) { return copy_of(self.model->links()); })
      .def_prop_ro("joints", [](const PythonModel& self) { return copy_of(self.model->joints()); })
      .def_prop_ro("frames", [](const PythonModel& self) { return copy_of(self.model->frames()); })
      .def(
          "link",
          [](const PythonModel& self, const std::string& name) { return self.model->link(self.model->link_id(name)); },
          "name"_a, "The link of that name. Raises KeyError, which lists the names there are.")
      .def(
          "joint",
          [](const PythonModel& self, const std::string& name) {
            return self.model->joint(self.model->joint_id(name));
          },
          "name"_a, "The joint of that name. Raises KeyError, which lists the names there are.")
      .def_prop_ro(
          "gravity", [](const PythonModel& self) { return vector3(self.model->gravity()); },
          nb::sig(returns_array("gravity").c_str()), "In the world frame, (3) [m/s^2].")
      .def(
          "neutral_configuration",
          [](const PythonModel& self) {
            const std::vector<double> q = self.model->neutral_configuration();
            return copied(q.data(), {q.size()});
          },
          nb::sig(returns_array("neutral_configuration").c_str()),
          "q (nq) with all joints at 0 and quaternions at identity.")
      .def("__repr__", [](const PythonModel& self) {
        return "<Model '" + self.model->name() + "': " + std::to_string(self.model->links().size()) + " links, nq " +
               std::to_string(self.model->nq()) + ", nv " + std::to_string(self.model->nv()) + ">";
      });
}

void add_joint(ModelBuilder& builder, const std::string& name, const std::string& type, const std::string& parent,
               const std::string& child, const Numbers3& position, const Numbers4& orientation, const Numbers3& axis,
               const JointLimits& limits, double damping, double friction, double armature) {
  builder.add_joint({.name = name,
                     .type = joint_type(type),
                     .parent = link_of(builder, parent),
                     .child = link_of(builder, child),
                     .X_PF = transform("joint '" + name + "'", position, orientation),
                     .axis = vec3(axis),
                     .limits = limits,
                     .damping = damping,
                     .friction = friction,
                     .armature = armature});
}

void bind_builder(nb::module_& m) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  nb::class_<ModelBuilder>(
      m, "ModelBuilder",
      "Collects links and joints and makes a Model of them. The link 'world' is there from the start; a link without a "
      "joint to a parent is welded to it, a free body is joined to it by a floating joint. Raises ValueError on what "
      "cannot be part of a model, KeyError on unknown links.")
      .def(nb::init<std::string>(), "name"_a = "model")
      .def(
          "add_link",
          [](ModelBuilder& self, const std::string& name, double mass, const Numbers3& com, const Matrix3& inertia) {
            self.add_link(name, {.mass = mass, .com = vec3(com), .inertia = symmetric("link '" + name + "'", inertia)});
          },
          "name"_a, nb::kw_only(), "mass"_a = 0.0, "com"_a = Numbers3{}, "inertia"_a = Matrix3{},
          nb::sig("def add_link(self, name: str, *, mass: float = 0.0, com: numpy.typing.ArrayLike = (0, 0, 0), "
                  "inertia: numpy.typing.ArrayLike = ((0, 0, 0), (0, 0, 0), (0, 0, 0))) -> None"),
          "mass [kg]; com: centre of mass in the link's frame (3) [m]; inertia about it in the frame's axes (3, 3) "
          "[kg m^2].")
      .def(
          "add_joint",
          [](ModelBuilder& self, const std::string& name, const std::string& type, const std::string& parent,
             const std::string& child, const Numbers3& position, const Numbers4& orientation, const Numbers3& axis,
             double lower, double upper, double effort, double velocity, double damping, double friction,
             double armature) {
            add_joint(self, name, type, parent, child, position, orientation, axis,
                      {.lower = lower, .upper = upper, .effort = effort, .velocity = velocity}, damping, friction,
                      armature);
          },
          "name"_a, "type"_a, "parent"_a, "child"_a, nb::kw_only(), "position"_a = Numbers3{},
          "quaternion"_a = Numbers4{0, 0, 0, 1}, "axis"_a = Numbers3{0, 0, 1}, "lower"_a = -kInfinity,
          "upper"_a = kInfinity, "effort"_a = kInfinity, "velocity"_a = kInfinity, "damping"_a = 0.0,
          "friction"_a = 0.0, "armature"_a = 0.0,
          nb::sig("def add_joint(self, name: str, type: str, parent: str, child: str, *, "
                  "position: numpy.typing.ArrayLike = (0, 0, 0), quaternion: numpy.typing.ArrayLike = (0, 0, 0, 1), "
                  "axis: numpy.typing.ArrayLike = (0, 0, 1), lower: float = ..., upper: float = ..., "
                  "effort: float = ..., velocity: float = ..., damping: float = 0.0, friction: float = 0.0, "
                  "armature: float = 0.0) -> None"),
          "Joins two links. type: as `Joint.type`; position (3) [m] and quaternion xyzw (4): the joint frame F in the "
          "parent; axis in F (3).")
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
          "build", [](const ModelBuilder& self) { return std::make_unique<PythonModel>(self.build()); },
          "Checks the whole and makes the model. Raises ValueError, naming the part, on a cycle or on a joint that "
          "moves "
          "no inertia.");
}

void bind_loading(nb::module_& m) {
  m.def(
      "load_urdf",
      [](const std::filesystem::path& path, bool fixed_base, std::vector<std::filesystem::path> package_paths,
         bool allow_outside_package, bool load_meshes) {
        LoadedModel loaded = [&] {
          const nb::gil_scoped_release release;
          return load_urdf(path, {.fixed_base = fixed_base,
                                  .package_paths = std::move(package_paths),
                                  .allow_outside_package = allow_outside_package,
                                  .load_meshes = load_meshes});
        }();
        return std::pair{std::make_unique<PythonModel>(std::move(loaded.model)), std::move(loaded.report)};
      },
      "path"_a, nb::kw_only(), "fixed_base"_a = true, "package_paths"_a = std::vector<std::filesystem::path>{},
      "allow_outside_package"_a = false, "load_meshes"_a = true,
      "Loads a robot from a URDF file, and what was defaulted, repaired or ignored in it.\n\n"
      "fixed_base: False lets the root link float by a joint 'root_joint', first in q and v. package_paths: where "
      "packages lie, searched before ROS_PACKAGE_PATH, AMENT_PREFIX_PATH and the folders above the file. "
      "allow_outside_package: whether meshes may lie outside their package. load_meshes: False leaves out shapes that "
      "need a mesh file. Raises FileNotFoundError, and UrdfError (a ValueError) for malformed files.");
  m.def("set_asset_root", &set_asset_root, "root"_a, "Where the robots that ship with the library lie.");
  m.def("asset_path", &asset_path, "relative"_a,
        "The path of an asset, for example 'panda/panda.urdf'. Raises RuntimeError if it is not there.");
}

}  // namespace

void bind_model(nb::module_& m) {
  bind_errors(m);
  bind_report(m);
  bind_parts(m);
  bind_model_class(m);
  bind_builder(m);
  bind_loading(m);
}

}  // namespace manyhands
