// manyhands._core.planning: how a gripper can take hold of a shape, or of a link in a scene.
#include "manyhands/planning/grasps.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings/arrays.h"
#include "bindings/model/python_model.h"
#include "bindings/planning/planning.h"
#include "manyhands/physics/collision/general/collision_shape.h"
#include "manyhands/planning/grasp_quality.h"
#include "manyhands/planning/placed_links.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::Array;
using bindings::as_span;
using bindings::copied;
using Vec = Vec3<double>;
using Three = std::array<double, 3>;

Vec vector(const Three& v) { return {v[0], v[1], v[2]}; }

ParallelGripper gripper_of(double opening, double depth, double reach, double width, double thickness,
                           const Three& palm) {
  const ParallelGripper gripper{opening, depth, reach, width, thickness, vector(palm)};
  require_lengths(gripper);
  return gripper;
}

GraspSettings settings_of(double friction, int samples, int approaches, const Three& approach, double tilt,
                          double clearance, std::uint64_t seed) {
  return {friction, samples, approaches, vector(approach), tilt, clearance, seed};
}

/// Rows of a Grasps of Python, in its order.
nb::tuple rows_of(const std::vector<Grasp>& grasps) {
  std::vector<double> p, r, width, quality, margin, points, normals;
  const auto append = [](std::vector<double>& to, const Vec& x) { to.insert(to.end(), {x.x, x.y, x.z}); };
  for (const Grasp& grasp : grasps) {
    const Quat<double> turn = to_quat(grasp.X_OG.R);
    append(p, grasp.X_OG.p);
    r.insert(r.end(), {turn.x, turn.y, turn.z, turn.w});
    width.push_back(grasp.width);
    quality.push_back(grasp.quality);
    margin.push_back(grasp.margin);
    for (const Vec& x : grasp.points) append(points, x);
    for (const Vec& x : grasp.normals) append(normals, x);
  }
  const std::size_t n = grasps.size();
  return nb::make_tuple(copied(p.data(), {n, 3}), copied(r.data(), {n, 4}), copied(width.data(), {n}),
                        copied(quality.data(), {n}), copied(margin.data(), {n}), copied(points.data(), {n, 2, 3}),
                        copied(normals.data(), {n, 2, 3}));
}

nb::tuple found_on(const GraspObject& object, const std::vector<PlacedShape>& obstacles, const ParallelGripper& gripper,
                   const GraspSettings& settings) {
  std::vector<Grasp> grasps;
  {
    const nb::gil_scoped_release release;
    grasps = find_grasps(object, obstacles, gripper, settings);
  }
  return rows_of(grasps);
}

nb::tuple grasps_of_shape(const CollisionShape& shape, const Three& com, const ParallelGripper& gripper,
                          const GraspSettings& settings) {
  return found_on({{{shape.view()}}, vector(com)}, {}, gripper, settings);
}

nb::tuple grasps_of_link(const PythonModel& model, const Array<double, 1>& q, const Array<double, 1>& mocap,
                         const std::string& link, const std::vector<std::string>& obstacles,
                         const ParallelGripper& gripper, const GraspSettings& settings) {
  const PlacedLinks links(*model.model, as_span(q), as_span(mocap));
  const LinkId target = model.model->link_id(link);
  std::vector<PlacedShape> others;
  for (const std::string& name : obstacles) {
    const std::vector<PlacedShape> more = links.shapes_of(model.model->link_id(name));
    others.insert(others.end(), more.begin(), more.end());
  }
  return found_on({links.shapes_of(target), links.com_of(target)}, others, gripper, settings);
}

double quality_of(const Array<double, 2>& points, const Array<double, 2>& normals, const Array<double, 1>& friction,
                  const Array<double, 1>& torsion, const Three& about, double length, int edges) {
  std::vector<GraspContact> contacts;
  for (std::size_t i = 0; i < points.shape(0); ++i) {
    const Vec normal{normals(i, 0), normals(i, 1), normals(i, 2)};
    contacts.push_back({{points(i, 0), points(i, 1), points(i, 2)}, normal, friction(i), torsion(i)});
  }
  return epsilon_quality(contacts, vector(about), length, edges);
}

}  // namespace

void bindings::bind_grasps(nb::module_& planning) {
  nb::class_<ParallelGripper>(planning, "Gripper")
      .def(
          "__init__",
          [](ParallelGripper* self, double opening, double depth, double reach, double width, double thickness,
             const Three& palm) {
            new (self) ParallelGripper(gripper_of(opening, depth, reach, width, thickness, palm));
          },
          "opening"_a, "depth"_a, "reach"_a, "width"_a, "thickness"_a, "palm"_a);
  nb::class_<GraspSettings>(planning, "GraspSettings")
      .def(
          "__init__",
          [](GraspSettings* self, double friction, int samples, int approaches, const Three& approach, double tilt,
             double clearance, std::uint64_t seed) {
            new (self) GraspSettings(settings_of(friction, samples, approaches, approach, tilt, clearance, seed));
          },
          "friction"_a, "samples"_a, "approaches"_a, "approach"_a, "tilt"_a, "clearance"_a, "seed"_a);
  planning.def("grasps_of_shape", &grasps_of_shape, "shape"_a, "com"_a, "gripper"_a, "settings"_a);
  planning.def("grasps_of_link", &grasps_of_link, "model"_a, "q"_a, "mocap"_a, "link"_a, "obstacles"_a, "gripper"_a,
               "settings"_a);
  planning.def("epsilon_quality", &quality_of, "points"_a, "normals"_a, "friction"_a, "torsion"_a, "about"_a,
               "length"_a, "edges"_a);
}

}  // namespace manyhands
