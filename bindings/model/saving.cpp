// manyhands._core: models saved as MJCF and URDF.
#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include "bindings/model/model_values.h"
#include "bindings/model/python_model.h"
#include "manyhands/model/io/save/save.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

// Both save without holding Python's lock.

template <LoadReport (*save)(const Model&, const std::filesystem::path&, const SaveOptions&)>
LoadReport to_file(const PythonModel& model, const std::filesystem::path& path, bool allow_loss) {
  const nb::gil_scoped_release release;
  return save(*model.model, path, {.allow_loss = allow_loss});
}

template <SavedText (*save)(const Model&, const SaveOptions&)>
std::pair<std::string, LoadReport> to_text(const PythonModel& model, bool allow_loss) {
  const nb::gil_scoped_release release;
  SavedText saved = save(*model.model, {.allow_loss = allow_loss});
  return {std::move(saved.text), std::move(saved.report)};
}

}  // namespace

void bind_saving(nb::module_& m) {
  nb::exception<SaveError>(m, "SaveError", PyExc_ValueError).doc() =
      "A model cannot be saved: the format cannot say what moves or touches in it, or a file cannot be written.";
  m.def(
      "save_mjcf", to_file<save_mjcf>, "model"_a, "path"_a, nb::kw_only(), "allow_loss"_a = false,
      "Saves a model as an MJCF file, which `load_mjcf` and MuJoCo read; returns what is said otherwise or left "
      "out.\n\n"
      "What MJCF can say is read back as the same numbers, to the last bit. Meshes (OBJ) and images go to the folder "
      "STEM_assets beside the file, which alone is overwritten. allow_loss: whether to write a file that moves or "
      "touches otherwise than the model, where MJCF cannot say it. Raises SaveError (a ValueError) else, or if a file "
      "cannot be written; what was there is whole then.");
  m.def("save_mjcf_string", to_text<save_mjcf_string>, "model"_a, nb::kw_only(), "allow_loss"_a = false,
        "The same as a text that needs no other files, and the report: meshes lie in it, images are left out.");
  m.def(
      "save_urdf", to_file<save_urdf>, "model"_a, "path"_a, nb::kw_only(), "allow_loss"_a = false,
      "Saves a robot as a URDF file; returns what is said otherwise or left out.\n\n"
      "URDF has a tree of links with masses, shapes, joints and mimics, and PyBullet's <contact>. One root is the "
      "file's; several come from a link 'world'. Loops, actuators, armature, planes, ball joints and other things that "
      "move or "
      "touch raise SaveError (a ValueError), or with allow_loss are left out. Meshes (OBJ) and images go to the folder "
      "STEM_assets beside the file, which alone is overwritten.");
  m.def("save_urdf_string", to_text<save_urdf_string>, "model"_a, nb::kw_only(), "allow_loss"_a = false,
        "The same as a text, which holds no meshes, and the report.");
}

}  // namespace manyhands
