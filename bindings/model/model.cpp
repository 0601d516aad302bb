// manyhands._core: models, how they are loaded, and where assets lie.
#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <system_error>

#include "bindings/bindings.h"
#include "bindings/model/load_warning.h"
#include "bindings/model/model_values.h"
#include "bindings/model/python_model.h"
#include "bindings/pickling.h"
#include "manyhands/base/assets.h"
#include "manyhands/model/fingerprint.h"
#include "manyhands/model/io/mjcf/mjcf.h"
#include "manyhands/model/io/sdf/sdf.h"
#include "manyhands/model/io/urdf/urdf.h"
#include "manyhands/model/model_archive.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::copied;
using bindings::copy_of;
using bindings::returns_array;
using bindings::vector3;

void bind_errors(nb::module_& m) {
  nb::register_exception_translator([](const std::exception_ptr& error, void*) {
    try {
      std::rethrow_exception(error);
    } catch (const std::out_of_range& e) {
      PyErr_SetString(PyExc_KeyError, e.what());
    } catch (const AssetNotFound& e) {
      PyErr_SetString(PyExc_FileNotFoundError, e.what());
    } catch (const FileNotFound& e) {
      PyErr_SetString(PyExc_FileNotFoundError, e.what());
    } catch (const std::system_error& e) {
      PyErr_SetString(PyExc_OSError, e.what());
    }
  });
  nb::exception<UrdfError>(m, "UrdfError", PyExc_ValueError).doc() =
      "A URDF file is not a robot that can be loaded; the message says 'file:line: what was wrong'.";
  nb::exception<MjcfError>(m, "MjcfError", PyExc_ValueError).doc() =
      "An MJCF file is not a scene that can be loaded; the message says 'file:line: what was wrong'.";
  nb::exception<SdfError>(m, "SdfError", PyExc_ValueError).doc() =
      "An SDF file holds no models that can be loaded; the message says 'file:line: what was wrong'.";
}

void bind_report(nb::module_& m) {
  m.attr("LoadWarning") = nb::steal(PyErr_NewExceptionWithDoc(
      "manyhands._core.LoadWarning",
      "A file was loaded, but something in it is left out that changes how things move or touch: the report tells. "
      "`warnings.simplefilter(\"error\", mh.LoadWarning)` makes it an error.",
      PyExc_UserWarning, nullptr));
  nb::class_<LoadNote>(m, "LoadNote", "One thing that a loader defaulted, repaired or ignored.")
      .def_prop_ro(
          "action", [](const LoadNote& note) { return to_string(note.action); },
          nb::sig("def action(self) -> typing.Literal['defaulted', 'repaired', 'ignored']"),
          "'defaulted': the file did not say; 'repaired': it said what cannot be simulated; 'ignored': it said what is "
          "not used.")
      .def_ro("file", &LoadNote::file, "Empty for models that were built in code.")
      .def_ro("line", &LoadNote::line, "1-based; 0 if unknown.")
      .def_ro("element", &LoadNote::element, "What it is about, for example \"link 'panda_hand'\".")
      .def_ro("message", &LoadNote::message, "What was done, with the value taken.")
      .def_ro("serious", &LoadNote::serious,
              "Whether a part is missing, or moves or touches otherwise than the file asks for: loading warns of it.");
  nb::class_<LoadReport>(m, "LoadReport", "What a loader did with a file beyond reading it. str() gives a line a note.")
      .def_ro("notes", &LoadReport::notes, "In the order of the file.")
      .def("__len__", [](const LoadReport& report) { return report.notes.size(); })
      .def("__str__", &LoadReport::to_string)
      .def("__repr__", &LoadReport::to_string);
}

void bind_model_class(nb::module_& m) {
  auto model = nb::class_<PythonModel>(
      m, "Model",
      "A robot or scene that never changes, made by `load_urdf` or `ModelBuilder.build`.\n\n"
      "Coordinates, depth first over the joints (see `Joint.iq`, `Joint.iv`): revolute, continuous: angle [rad]; "
      "prismatic: shift [m]; planar: x, y [m] across the axis and the angle [rad]; spherical: q is a quaternion xyzw, "
      "v "
      "the angular velocity in the joint frame F; floating: q is position [m] and quaternion xyzw, v is angular "
      "velocity, then velocity of the origin, both in F.");
  model
      .def_prop_ro(
          "name", [](const PythonModel& self) { return self.model->name(); }, "As the file, or ModelBuilder, calls it.")
      .def_prop_ro(
          "nq", [](const PythonModel& self) { return self.model->nq(); }, "Length of q.")
      .def_prop_ro(
          "nv", [](const PythonModel& self) { return self.model->nv(); }, "Length of v, a and tau.")
      .def_prop_ro(
          "num_bodies", [](const PythonModel& self) { return self.model->num_bodies(); },
          "Bodies that move on their own, and the world.")
      .def_prop_ro(
          "links", [](const PythonModel& self) { return copy_of(self.model->links()); }, "In order, the world first.")
      .def_prop_ro(
          "joints", [](const PythonModel& self) { return copy_of(self.model->joints()); }, "In the order of q.")
      .def_prop_ro(
          "frames", [](const PythonModel& self) { return copy_of(self.model->frames()); }, "Named poses on links.")
      .def_prop_ro(
          "geoms", [](const PythonModel& self) { return copy_of(self.model->geoms()); },
          "Shapes that touch or are seen.")
      .def_prop_ro(
          "meshes", [](const PythonModel& self) { return copy_of(self.model->meshes()); },
          "What geoms refer to by index.")
      .def_prop_ro(
          "height_fields", [](const PythonModel& self) { return copy_of(self.model->height_fields()); },
          "What geoms refer to by index.")
      .def_prop_ro(
          "equalities", [](const PythonModel& self) { return copy_of(self.model->equalities()); },
          "Equality constraints.")
      .def_prop_ro(
          "tendons", [](const PythonModel& self) { return copy_of(self.model->tendons()); }, "In order.")
      .def_prop_ro(
          "actuators", [](const PythonModel& self) { return copy_of(self.model->actuators()); },
          "In the order of ctrl.")
      .def_prop_ro(
          "contact_pairs", [](const PythonModel& self) { return copy_of(self.model->contact_pairs()); },
          "Pairs of geoms with a material of their own.")
      .def_prop_ro(
          "fingerprint", [](const PythonModel& self) { return fingerprint(*self.model); },
          "A number that tells models apart: equal where the same state moves in the same way, to the last bit.")
      .def_prop_ro(
          "mocap_bodies",
          [](const PythonModel& self) {
            std::vector<std::string> names;
            for (const BodyId id : self.model->mocap_bodies()) {
              names.push_back(self.model->link(self.model->joint(self.model->body(id).joint).child).name);
            }
            return names;
          },
          "Names of the links that mocap joints carry, in the order of `World.mocap`.")
      .def_prop_ro(
          "keyframes", [](const PythonModel& self) { return copy_of(self.model->keyframes()); }, "States with names.")
      .def_prop_ro(
          "nu", [](const PythonModel& self) { return self.model->nu(); }, "Length of ctrl: one for each actuator.")
      .def_prop_ro(
          "na", [](const PythonModel& self) { return self.model->na(); },
          "Length of act: one for each actuator that has an activation.")
      .def_prop_ro(
          "sensors", [](const PythonModel& self) { return copy_of(self.model->sensors()); },
          "In the order of `World.sensor_data`.")
      .def_prop_ro(
          "time_step", [](const PythonModel& self) { return self.model->time_step(); },
          "[s], if the description asks for one; else None.")
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
      .def_prop_ro(
          "medium",
          [](const PythonModel& self) {
            const Medium& medium = self.model->medium();
            return nb::make_tuple(medium.density, medium.viscosity, vector3(medium.wind));
          },
          nb::sig("def medium(self) -> tuple[float, float, numpy.typing.NDArray[numpy.float64]]"),
          "What links move through, and what drags on each as on the box of its inertia: density [kg/m^3], viscosity "
          "[Pa s], wind (3) [m/s] in world axes.")
      .def(
          "neutral_configuration",
          [](const PythonModel& self) {
            const std::vector<double> q = self.model->neutral_configuration();
            return copied(q.data(), {q.size()});
          },
          nb::sig(returns_array("neutral_configuration").c_str()),
          "q (nq) with all joints at 0 and quaternions at identity.")
      .def(
          "initial_configuration",
          [](const PythonModel& self) {
            const std::vector<double> q = self.model->initial_configuration();
            return copied(q.data(), {q.size()});
          },
          nb::sig(returns_array("initial_configuration").c_str()),
          "q (nq) where the description places the joints; the neutral one unless it says otherwise.")
      .def("__repr__", [](const PythonModel& self) {
        return "<Model '" + self.model->name() + "': " + std::to_string(self.model->links().size()) + " links, nq " +
               std::to_string(self.model->nq()) + ", nv " + std::to_string(self.model->nv()) + ">";
      });
  copy_as_itself(model);
  bindings::pickle_by(
      model, [](const PythonModel& self) { return archived(*self.model); },
      [](std::span<const std::uint8_t> bytes) { return std::make_shared<const Model>(unarchived(bytes)); });
}

using PythonLoaded = std::pair<std::unique_ptr<PythonModel>, LoadReport>;

PythonLoaded as_python(LoadedModel loaded) {
  bindings::warn_of(loaded.report.notes, "the report, which comes with the model,");
  return {std::make_unique<PythonModel>(std::move(loaded.model)), std::move(loaded.report)};
}

/// Loads without holding Python's lock.
template <class Load>
PythonLoaded loaded_by(Load load) {
  return as_python([&] {
    const nb::gil_scoped_release release;
    return load();
  }());
}

void bind_sdf(nb::module_& m) {
  m.def(
      "load_sdf",
      [](const std::filesystem::path& path, std::vector<std::filesystem::path> package_paths,
         bool allow_outside_package, bool load_meshes, bool bullet) {
        std::vector<LoadedModel> models = [&] {
          const nb::gil_scoped_release release;
          return load_sdf(path, {.package_paths = std::move(package_paths),
                                 .allow_outside_package = allow_outside_package,
                                 .load_meshes = load_meshes,
                                 .bullet = bullet});
        }();
        std::vector<PythonLoaded> loaded;
        for (LoadedModel& model : models) loaded.push_back(as_python(std::move(model)));
        return loaded;
      },
      "path"_a, nb::kw_only(), "package_paths"_a = std::vector<std::filesystem::path>{},
      "allow_outside_package"_a = false, "load_meshes"_a = true, "bullet"_a = false,
      "Loads the models of an SDF file, each with what was defaulted, repaired or ignored in it.\n\n"
      "One for each <model> and <include>, at its place in the world; `World.from_file` takes them all. Root links "
      "float "
      "by joints 'LINK_free', unless the model is static or the link has no mass. package_paths: where models lie, "
      "searched before GZ_SIM_RESOURCE_PATH, GAZEBO_MODEL_PATH, ROS_PACKAGE_PATH, AMENT_PREFIX_PATH and the folders "
      "above the file. bullet: Bullet's rules of friction and joint frames in place of Gazebo's. The other options are "
      "those of `load_urdf`. Raises FileNotFoundError, and SdfError (a ValueError) for malformed files.");
}

MjcfOptions options_of(bool allow_outside_package, bool load_meshes, const std::string& compliance) {
  return {.allow_outside_package = allow_outside_package,
          .load_meshes = load_meshes,
          .compliance = bindings::named("compliance", compliance, bindings::kCompliances)};
}

void bind_mjcf(nb::module_& m) {
  m.def(
      "load_mjcf",
      [](const std::filesystem::path& path, bool allow_outside_package, bool load_meshes, const std::string& compliance,
         bool bullet) {
        MjcfOptions options = options_of(allow_outside_package, load_meshes, compliance);
        options.bullet = bullet;
        return loaded_by([&] { return load_mjcf(path, options); });
      },
      "path"_a, nb::kw_only(), "allow_outside_package"_a = false, "load_meshes"_a = true, "compliance"_a = "stated",
      "bullet"_a = false,
      "Loads a scene from an MJCF file, and what was defaulted, repaired or ignored in it.\n\n"
      "Links, joints, geoms and actuators follow in MuJoCo's order: q is MuJoCo's qpos with quaternions turned from "
      "wxyz "
      "to xyzw, `Model.initial_configuration` its qpos0, `Model.time_step` and `Model.keyframes` the file's. "
      "allow_outside_package: whether meshes and included files may lie outside the file's package. load_meshes: False "
      "leaves out shapes that need a mesh. compliance: which constraints give way by solref and solimp: 'stated', "
      "those "
      "that the file makes clearly softer than MuJoCo's default; 'all', as in MuJoCo; 'none'. bullet: Bullet's rules "
      "where they differ: global coordinates and fixed joints are read, bodies, joints and geoms alone count, at 1000 "
      "kg/m^3, and nothing gives way. Raises FileNotFoundError, and MjcfError (a ValueError) for malformed "
      "files.");
  m.def(
      "load_mjcf_string",
      [](const std::string& text, const std::filesystem::path& folder, bool allow_outside_package, bool load_meshes,
         const std::string& compliance) {
        const MjcfOptions options = options_of(allow_outside_package, load_meshes, compliance);
        return loaded_by([&] { return load_mjcf_string(text, "mjcf", folder, options); });
      },
      "text"_a, nb::kw_only(), "folder"_a = std::filesystem::path("."), "allow_outside_package"_a = false,
      "load_meshes"_a = true, "compliance"_a = "stated",
      "The same for a text; folder is where its relative paths start.");
}

void bind_loading(nb::module_& m) {
  m.def(
      "load_urdf",
      [](const std::filesystem::path& path, bool fixed_base, std::vector<std::filesystem::path> package_paths,
         bool allow_outside_package, bool load_meshes, bool bullet, double scale) {
        return loaded_by([&] {
          return load_urdf(path, {.fixed_base = fixed_base,
                                  .package_paths = std::move(package_paths),
                                  .allow_outside_package = allow_outside_package,
                                  .load_meshes = load_meshes,
                                  .bullet = bullet,
                                  .scale = scale});
        });
      },
      "path"_a, nb::kw_only(), "fixed_base"_a = true, "package_paths"_a = std::vector<std::filesystem::path>{},
      "allow_outside_package"_a = false, "load_meshes"_a = true, "bullet"_a = false, "scale"_a = 1.0,
      "Loads a robot from a URDF file, and what was defaulted, repaired or ignored in it.\n\n"
      "fixed_base: False lets the root link float by a joint 'root_joint', first in q and v. package_paths: where "
      "packages lie, searched before ROS_PACKAGE_PATH, AMENT_PREFIX_PATH and the folders above the file. "
      "allow_outside_package: whether meshes may lie outside their package. load_meshes: False leaves out shapes that "
      "need a mesh file. bullet: Bullet's rules where they differ: a mass of 1 kg without <inertial>, hulls of a "
      "mesh's "
      "objects, no mimics, a root 'world' as a link of its own. scale: multiplies lengths, not masses. "
      "Raises FileNotFoundError, and UrdfError (a ValueError) for malformed files.");
  m.def("set_asset_root", &set_asset_root, "root"_a, "Where the robots that ship with the library lie.");
  m.def("asset_path", &asset_path, "relative"_a,
        "The path of an asset, for example 'panda/panda.urdf'. Raises FileNotFoundError, which lists the robots there "
        "are, and RuntimeError if the folder itself is not there.");
}

}  // namespace

void bind_model(nb::module_& m) {
  bind_errors(m);
  bind_report(m);
  bind_model_parts(m);
  bind_model_class(m);
  bind_model_builder(m);
  bind_loading(m);
  bind_mjcf(m);
  bind_sdf(m);
  bind_saving(m);
}

}  // namespace manyhands
