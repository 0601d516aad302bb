// manyhands._core.collision: shapes, and questions about two of them, for one pose or rows of poses.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <limits>

#include "bindings/bindings.h"
#include "bindings/model/model_values.h"
#include "bindings/world/poses.h"
#include "manyhands/physics/collision/general/shape_contact.h"
#include "manyhands/physics/collision/queries/distance.h"
#include "manyhands/physics/collision/queries/ray_cast.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::copied;
using bindings::Numbers;
using Poses = std::vector<Transform<double>>;
using Shapes = std::vector<CollisionShape>;
using Triangles = nb::ndarray<const int, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

/// A Python class for each type of shape.
template <ShapeType type>
struct ShapeOf : CollisionShape {
  explicit ShapeOf(CollisionShape shape) : CollisionShape(std::move(shape)) {}
};

/// The number of rows of a call: that of all its arguments which are not single. Throws std::invalid_argument.
class RowCount {
 public:
  void see(const char* name, std::size_t n) {
    if (n == 1 || n == count_) return;
    if (count_ != 1) {
      throw std::invalid_argument(std::string(name) + " has " + std::to_string(n) + " rows, others " +
                                  std::to_string(count_) + "; expected as many, or one for all");
    }
    count_ = n;
  }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  std::size_t count_ = 1;
};

template <class T>
const T& row(const std::vector<T>& rows, std::size_t i) {
  return rows[rows.size() == 1 ? 0 : i];
}

nb::tuple signed_distances(const Shapes& a, const Numbers& p_a, const Numbers& q_a, const Shapes& b, const Numbers& p_b,
                           const Numbers& q_b) {
  const Poses X_WA = bindings::poses("pose_a", p_a, q_a), X_WB = bindings::poses("pose_b", p_b, q_b);
  RowCount rows;
  rows.see("a", a.size());
  rows.see("pose_a", X_WA.size());
  rows.see("b", b.size());
  rows.see("pose_b", X_WB.size());
  const std::size_t n = rows.count();
  std::vector<double> phi(n);
  std::vector<Vec3<double>> point_a(n), point_b(n), normal(n);
  {
    const nb::gil_scoped_release release;
    for (std::size_t i = 0; i < n; ++i) {
      const auto d = signed_distance(row(a, i).view(), row(X_WA, i), row(b, i).view(), row(X_WB, i));
      phi[i] = d.phi;
      point_a[i] = d.p_A;
      point_b[i] = d.p_B;
      normal[i] = d.normal_AB;
    }
  }
  return nb::make_tuple(copied(phi.data(), {n}), copied(&point_a.data()->x, {n, 3}), copied(&point_b.data()->x, {n, 3}),
                        copied(&normal.data()->x, {n, 3}));
}

template <Real R>
nb::tuple contact_points(const CollisionShape& a, const Numbers& p_a, const Numbers& q_a, const CollisionShape& b,
                         const Numbers& p_b, const Numbers& q_b, double margin) {
  const Poses X_WA = bindings::poses("pose_a", p_a, q_a), X_WB = bindings::poses("pose_b", p_b, q_b);
  if (X_WA.size() != 1 || X_WB.size() != 1) {
    throw std::invalid_argument("contact_points takes one pose of each shape; call it for each row");
  }
  const ShapeContact<R> contact =
      shape_contact<R>(a, broadcast<R>(X_WA[0]), b, broadcast<R>(X_WB[0]), static_cast<R>(margin));
  std::vector<Vec3<R>> normals, points;
  std::vector<R> distances;
  for (std::size_t i = 0; i < contact.size; ++i) {
    const Manifold<R>& m = contact.manifolds[i];
    for (std::size_t k = 0; k < m.phi.size(); ++k) {
      if (!is_finite(m.phi[k])) continue;
      normals.push_back(m.normal);
      points.push_back(m.p[k]);
      distances.push_back(m.phi[k]);
    }
  }
  const std::size_t n = points.size();
  return nb::make_tuple(copied(reinterpret_cast<const R*>(normals.data()), {n, 3}),
                        copied(reinterpret_cast<const R*>(points.data()), {n, 3}), copied(distances.data(), {n}));
}

nb::tuple ray_casts(const CollisionShape& shape, const Numbers& p, const Numbers& q, const Numbers& origin,
                    const Numbers& direction, double max_distance) {
  const Poses X_WG = bindings::poses("pose", p, q);
  const auto o = bindings::vectors("origin", origin), d = bindings::directions("direction", direction);
  if (!(max_distance >= 0)) {
    throw std::invalid_argument("max_distance is " + std::to_string(max_distance) + " m; expected 0 or more");
  }
  RowCount rows;
  rows.see("pose", X_WG.size());
  rows.see("origin", o.size());
  rows.see("direction", d.size());
  const std::size_t n = rows.count();
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> distance(n, std::numeric_limits<double>::infinity());
  std::vector<Vec3<double>> point(n, {kNone, kNone, kNone}), normal(point);
  {
    const nb::gil_scoped_release release;
    for (std::size_t i = 0; i < n; ++i) {
      const auto hit = ray_cast(shape.view(), row(X_WG, i), row(o, i), row(d, i), max_distance);
      if (!hit) continue;
      distance[i] = hit->distance;
      point[i] = fma(hit->distance, row(d, i), row(o, i));
      normal[i] = hit->normal;
    }
  }
  return nb::make_tuple(copied(distance.data(), {n}), copied(&point.data()->x, {n, 3}),
                        copied(&normal.data()->x, {n, 3}));
}

Mesh mesh_of(const Numbers& vertices, const Triangles& t) {
  if (t.shape(1) != 3) {
    throw std::invalid_argument("triangles have " + std::to_string(t.shape(1)) + " corners; expected shape (m, 3)");
  }
  Mesh mesh{.source = "arrays"};
  for (const Vec3<double>& v : bindings::vectors("vertices", vertices)) mesh.vertices.push_back(broadcast<float>(v));
  for (std::size_t i = 0; i < t.shape(0); ++i) mesh.triangles.push_back({t(i, 0), t(i, 1), t(i, 2)});
  return mesh;
}

HeightField field_of(const Numbers& heights, double dx, double dy) {
  if (heights.ndim() != 2) {
    throw std::invalid_argument("heights have shape " + bindings::shape_of(heights) + "; expected (rows, columns)");
  }
  HeightField field{
      .columns = static_cast<int>(heights.shape(1)), .rows = static_cast<int>(heights.shape(0)), .dx = dx, .dy = dy};
  field.height.assign(heights.data(), heights.data() + heights.size());
  return field;
}

template <ShapeType type, auto make, class... Arguments, class... Extras>
void bind_shape(nb::module_& m, const char* name, const char* doc, const Extras&... extras) {
  nb::class_<ShapeOf<type>, CollisionShape>(m, name, doc)
      .def(
          "__init__", [](ShapeOf<type>* self, Arguments... arguments) { new (self) ShapeOf<type>(make(arguments...)); },
          extras...);
}

CollisionShape box_of(const Numbers& half) {
  if (half.ndim() != 1 || half.size() != 3) {
    throw std::invalid_argument("half_extents have shape " + bindings::shape_of(half) + "; expected (3,)");
  }
  return CollisionShape::box({half.data()[0], half.data()[1], half.data()[2]});
}
CollisionShape convex_of(const Numbers& vertices) {
  return CollisionShape::convex(bindings::vectors("vertices", vertices));
}
CollisionShape mesh_shape(const Numbers& vertices, const Triangles& triangles) {
  return CollisionShape::mesh(mesh_of(vertices, triangles));
}
CollisionShape field_shape(const Numbers& heights, double dx, double dy) {
  return CollisionShape::height_field(field_of(heights, dx, dy));
}

void bind_shapes(nb::module_& m) {
  nb::class_<CollisionShape>(m, "Shape", "A shape outside of any model; immutable.")
      .def_prop_ro(
          "type", [](const CollisionShape& shape) { return bindings::name_of(shape.type(), bindings::kShapes); },
          "'sphere', 'capsule', 'cylinder', 'box', 'plane', 'convex', 'mesh' or 'height_field'.")
      .def_prop_ro(
          "size", [](const CollisionShape& shape) { return bindings::vector3(shape.size()); },
          nb::sig(bindings::returns_array("size").c_str()),
          "(3) [m]: sphere: radius; capsule, cylinder: radius, half length; box: half extents; the rest is 0.")
      .def("__repr__", [](const CollisionShape& shape) {
        return std::string("<collision shape: ") + bindings::name_of(shape.type(), bindings::kShapes) + ">";
      });
  using enum ShapeType;
  bind_shape<kSphere, &CollisionShape::sphere, double>(m, "Sphere", "radius [m], about the origin.", "radius"_a);
  bind_shape<kCapsule, &CollisionShape::capsule, double, double>(
      m, "Capsule", "Along z: radius, and half the length between the centres of its ends [m].", "radius"_a,
      "half_length"_a);
  bind_shape<kCylinder, &CollisionShape::cylinder, double, double>(m, "Cylinder", "Along z: radius, half length [m].",
                                                                   "radius"_a, "half_length"_a);
  bind_shape<kPlane, &CollisionShape::plane>(m, "Plane", "The half-space z <= 0.");
  bind_shape<kBox, &box_of, const Numbers&>(m, "BoxShape", "half_extents (3) [m].", "half_extents"_a);
  bind_shape<kConvex, &convex_of, const Numbers&>(m, "ConvexShape", "The hull of vertices (n, 3) [m].", "vertices"_a);
  bind_shape<kMesh, &mesh_shape, const Numbers&, const Triangles&>(
      m, "MeshShape", "vertices (n, 3) [m], triangles (m, 3) int32.", "vertices"_a, "triangles"_a);
  bind_shape<kHeightField, &field_shape, const Numbers&, double, double>(
      m, "HeightFieldShape", "heights (rows, columns) [m], spacings [m].", "heights"_a, "dx"_a, "dy"_a);
}

}  // namespace

void bind_collision(nb::module_& parent) {
  nb::module_ m = parent.def_submodule("collision", "Shapes and where they touch; see manyhands.collision.");
  bind_shapes(m);
  m.def("signed_distance", &signed_distances, "a"_a, "position_a"_a, "quaternion_a"_a, "b"_a, "position_b"_a,
        "quaternion_b"_a, "-> phi (n), point_a (n, 3), point_b (n, 3), normal (n, 3).");
  m.def("contact_points_float64", &contact_points<double>, "a"_a, "position_a"_a, "quaternion_a"_a, "b"_a,
        "position_b"_a, "quaternion_b"_a, "margin"_a, "-> normals (k, 3), points (k, 3), distances (k).");
  m.def("contact_points_float32", &contact_points<float>, "a"_a, "position_a"_a, "quaternion_a"_a, "b"_a,
        "position_b"_a, "quaternion_b"_a, "margin"_a, "-> normals (k, 3), points (k, 3), distances (k).");
  m.def("ray_cast", &ray_casts, "shape"_a, "position"_a, "quaternion"_a, "origin"_a, "direction"_a, "max_distance"_a,
        "-> distance (n), infinite for a miss; point (n, 3), normal (n, 3), NaN for a miss.");
}

}  // namespace manyhands
