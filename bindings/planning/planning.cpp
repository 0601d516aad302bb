// manyhands._core.planning: trajectories, and how fast a path can be followed.
#include "bindings/planning/planning.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/vector.h>

#include <optional>

#include "bindings/arrays.h"
#include "bindings/model/python_model.h"
#include "manyhands/planning/cartesian.h"
#include "manyhands/planning/potential_field.h"
#include "manyhands/planning/spline.h"
#include "manyhands/planning/time_optimal.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::Array;
using bindings::as_span;
using bindings::copied;
using Numbers = std::vector<double>;

Numbers numbers(const Array<double, 1>& array) { return {array.data(), array.data() + array.size()}; }

Waypoints waypoints_of(const Array<double, 2>& rows) { return {as_span(rows), rows.shape(1)}; }

nb::tuple sample(const Trajectory& motion, const Array<double, 1>& t) {
  Numbers q(t.size() * motion.width()), v(q.size()), a(q.size());
  motion.sample(as_span(t), q, v, a);
  const auto rows = [&](const Numbers& x) { return copied(x.data(), {t.size(), motion.width()}); };
  return nb::make_tuple(rows(q), rows(v), rows(a));
}

/// Positions (n, 3), quaternions (n, 4), velocities (n, 6) and accelerations (n, 6).
nb::tuple sample_poses(const CartesianTrajectory& motion, const Array<double, 1>& t) {
  Numbers p, r, v, a;
  const auto append = [](Numbers& to, const Vec3<double>& x) { to.insert(to.end(), {x.x, x.y, x.z}); };
  for (const double time : as_span(t)) {
    const CartesianSample at = motion.sample(time);
    const Quat<double> turn = to_quat(at.X.R);
    append(p, at.X.p);
    r.insert(r.end(), {turn.x, turn.y, turn.z, turn.w});
    append(v, at.V.w), append(v, at.V.v);
    append(a, at.A.w), append(a, at.A.v);
  }
  return nb::make_tuple(copied(p.data(), {t.size(), 3}), copied(r.data(), {t.size(), 4}),
                        copied(v.data(), {t.size(), 6}), copied(a.data(), {t.size(), 6}));
}

CartesianTrajectory cartesian(const Array<double, 2>& position, const Array<double, 2>& quaternion,
                              const Trajectory& law, bool screw) {
  std::vector<Transform<double>> poses;
  for (std::size_t i = 0; i < position.shape(0); ++i) {
    const double *p = &position(i, 0), *r = &quaternion(i, 0);
    poses.push_back({to_matrix(normalized(Quat<double>{r[0], r[1], r[2], r[3]})), {p[0], p[1], p[2]}});
  }
  return {poses, law, screw ? CartesianPath::kScrew : CartesianPath::kStraight};
}

using Limits = std::optional<Array<double, 1>>;

Trajectory fastest(const Trajectory& path, const Limits& velocity, const Limits& acceleration, const Limits& torque,
                   const PythonModel* model, std::size_t intervals, double start_speed, double end_speed) {
  const auto span = [](const Limits& limits) { return limits ? as_span(*limits) : std::span<const double>(); };
  const MotionLimits limits{span(velocity), span(acceleration), span(torque),
                            model == nullptr ? nullptr : model->model.get()};
  const nb::gil_scoped_release release;
  return time_optimal(path, limits, {intervals, start_speed, end_speed});
}

/// Both potentials, and the gradient (k) of their sum.
nb::tuple field_at(double attractive_gain, double repulsive_gain, double influence, const Array<double, 1>& q,
                   const Array<double, 1>& goal, const Array<double, 2>& obstacles) {
  const PotentialField field{attractive_gain, repulsive_gain, influence};
  const Numbers slope = field.gradient(as_span(q), as_span(goal), as_span(obstacles));
  return nb::make_tuple(field.attractive(as_span(q), as_span(goal)), field.repulsive(as_span(q), as_span(obstacles)),
                        copied(slope.data(), {slope.size()}));
}

void bind_trajectories(nb::module_& m) {
  nb::class_<Trajectory>(m, "Trajectory")
      .def(
          "__init__",
          [](Trajectory* self, const Array<double, 1>& breaks, const Array<double, 3>& coefficients) {
            const auto given = as_span(coefficients);
            new (self) Trajectory(numbers(breaks), {given.begin(), given.end()}, coefficients.shape(2));
          },
          "breaks"_a, "coefficients"_a)
      .def_prop_ro("duration", &Trajectory::duration)
      .def_prop_ro("width", &Trajectory::width)
      .def_prop_ro("breaks",
                   [](const Trajectory& motion) { return copied(motion.breaks().data(), {motion.breaks().size()}); })
      .def_prop_ro("coefficients",
                   [](const Trajectory& motion) {
                     return copied(motion.coefficients().data(), {motion.pieces(), motion.order(), motion.width()});
                   })
      .def("part", &Trajectory::part, "start"_a, "end"_a)
      .def("sample", &sample, "t"_a);
  m.def("joined", [](const std::vector<Trajectory>& motions) { return joined(motions); }, "motions"_a);
  nb::class_<CartesianTrajectory>(m, "CartesianTrajectory")
      .def(
          "__init__",
          [](CartesianTrajectory* self, const Array<double, 2>& position, const Array<double, 2>& quaternion,
             const Trajectory& law,
             bool screw) { new (self) CartesianTrajectory(cartesian(position, quaternion, law, screw)); },
          "position"_a, "quaternion"_a, "law"_a, "screw"_a)
      .def("sample", &sample_poses, "t"_a);
}

}  // namespace

void bindings::bind_planning(nb::module_& m) {
  nb::module_ planning = m.def_submodule("planning");
  bind_trajectories(planning);
  bind_planner(planning);
  bind_grasps(planning);
  planning.def(
      "cubic",
      [](const Array<double, 1>& times, const Array<double, 2>& waypoints, const Array<double, 2>& velocity) {
        return cubic(as_span(times), waypoints_of(waypoints), as_span(velocity));
      },
      "times"_a, "waypoints"_a, "velocity"_a);
  planning.def(
      "quintic",
      [](const Array<double, 1>& times, const Array<double, 2>& waypoints, const Array<double, 2>& velocity,
         const Array<double, 2>& acceleration) {
        return quintic(as_span(times), waypoints_of(waypoints), as_span(velocity), as_span(acceleration));
      },
      "times"_a, "waypoints"_a, "velocity"_a, "acceleration"_a);
  planning.def(
      "trapezoid",
      [](const Array<double, 2>& waypoints, const Array<double, 1>& velocity, const Array<double, 1>& acceleration) {
        return trapezoid(waypoints_of(waypoints), as_span(velocity), as_span(acceleration));
      },
      "waypoints"_a, "velocity"_a, "acceleration"_a);
  planning.def(
      "spline",
      [](const Array<double, 1>& times, const Array<double, 2>& waypoints, std::size_t degree,
         const Array<double, 3>& ends) {
        return spline(as_span(times), waypoints_of(waypoints), degree, as_span(ends));
      },
      "times"_a, "waypoints"_a, "degree"_a, "ends"_a);
  planning.def("potential_field", &field_at, "attractive_gain"_a, "repulsive_gain"_a, "influence"_a, "q"_a, "goal"_a,
               "obstacles"_a);
  planning.def("time_optimal", &fastest, "path"_a, "velocity"_a.none(), "acceleration"_a.none(), "torque"_a.none(),
               "model"_a.none(), "intervals"_a, "start_speed"_a, "end_speed"_a);
}

}  // namespace manyhands
