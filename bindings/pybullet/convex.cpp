#include "bindings/pybullet/convex.h"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "bindings/model/mesh_arrays.h"
#include "bindings/pybullet/arguments.h"

namespace nb = nanobind;

namespace manyhands::pybullet {

namespace {

constexpr FreeFunction kVhacd{
    "vhacd",
    "fileNameIn, fileNameOut, fileNameLogging | concavity=0.0025, alpha=0.04, beta=0.05, gamma=0.00125, "
    "minVolumePerCH=0.0001, resolution=100000, maxNumVerticesPerCH=64, depth=20, planeDownsampling=4, "
    "convexhullDownsampling=4, pca=0, mode=0, convexhullApproximation=1",
    "Writes convex parts of a mesh file as objects of an OBJ file, and what was done to the log. The parts are "
    "CoACD's (see manyhands.decompose), which the numbers that tune V-HACD have no effect on.",
    [](const Arguments& a) -> PyObject* {
      nb::module_::import_("manyhands.decomposition").attr("write_parts")(a.text(0), a.text(1), a.text(2));
      return none();
    }};

}  // namespace

std::vector<Mesh> convex_parts(const Mesh& mesh) {
  const nb::gil_scoped_acquire interpreter;
  const nb::module_ module = nb::module_::import_("manyhands.decomposition");
  const auto rows = [](const auto* data, std::size_t n) {
    return nb::cast(nb::ndarray<nb::numpy, const std::remove_cvref_t<decltype(*data)>, nb::ndim<2>>(data, {n, 3}));
  };
  const nb::object parts = module.attr("parts_or_none")(rows(&mesh.vertices.data()->x, mesh.vertices.size()),
                                                        rows(mesh.triangles.data()->data(), mesh.triangles.size()));
  std::vector<Mesh> meshes;
  for (const nb::handle part : parts) {
    meshes.push_back(
        bindings::mesh_of(nb::cast<bindings::Rows3<float>>(part[0]), nb::cast<bindings::Rows3<int>>(part[1])));
  }
  return meshes;
}

void add_convex(Methods& methods) { add_to<kVhacd>(methods); }

}  // namespace manyhands::pybullet
