// Meshes as arrays.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "manyhands/model/description.h"

namespace manyhands::bindings {

/// A row of three numbers for each vertex or triangle.
template <class T>
using Rows3 = nanobind::ndarray<const T, nanobind::shape<-1, 3>, nanobind::c_contig, nanobind::device::cpu>;

/// Of vertices [m] and triangles.
[[nodiscard]] inline Mesh mesh_of(const Rows3<float>& vertices, const Rows3<int>& triangles) {
  Mesh mesh{.source = "arrays"};
  for (std::size_t i = 0; i < vertices.shape(0); ++i) {
    const float* const v = vertices.data() + 3 * i;
    mesh.vertices.push_back({v[0], v[1], v[2]});
  }
  for (std::size_t i = 0; i < triangles.shape(0); ++i) {
    const int* const t = triangles.data() + 3 * i;
    mesh.triangles.push_back({t[0], t[1], t[2]});
  }
  return mesh;
}

}  // namespace manyhands::bindings
