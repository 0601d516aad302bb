// manyhands._core.planning.Planner: a scene, what is free in it, and ways through it.
#include "bindings/planning/planner.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include "bindings/arrays.h"
#include "bindings/model/python_model.h"
#include "bindings/planning/path_constraints.h"
#include "bindings/planning/planning.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/planning/plan.h"
#include "manyhands/planning/trajectory_check.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::Array;
using bindings::as_span;
using bindings::copied;
using NamePairs = std::vector<std::pair<std::string, std::string>>;

SceneSettings settings_of(const Model& model, const std::string& frame, const std::vector<std::string>& joints,
                          const NamePairs& attached, const NamePairs& allowed) {
  SceneSettings settings;
  if (!frame.empty()) settings.joints = joints_that_move(model, model.frame_id(frame));
  for (const std::string& name : joints) settings.joints.push_back(model.joint_id(name));
  for (const auto& [link, on] : attached) settings.attached.push_back({model.link_id(link), model.link_id(on)});
  for (const auto& [a, b] : allowed) settings.allowed.emplace_back(model.link_id(a), model.link_id(b));
  return settings;
}

PointCloud cloud_of(const Array<double, 2>& points, double radius) {
  PointCloud cloud{.radius = radius};
  for (std::size_t i = 0; i < points.shape(0); ++i) cloud.points.push_back({points(i, 0), points(i, 1), points(i, 2)});
  return cloud;
}

const char* name_of(PlanStatus status) {
  switch (status) {
    case PlanStatus::kSolved:
      return "solved";
    case PlanStatus::kStartOutsideLimits:
      return "start outside limits";
    case PlanStatus::kStartCollides:
      return "start collides";
    case PlanStatus::kGoalOutsideLimits:
      return "goal outside limits";
    case PlanStatus::kGoalCollides:
      return "goal collides";
    case PlanStatus::kStartBreaksConstraint:
      return "start breaks constraint";
    case PlanStatus::kGoalBreaksConstraint:
      return "goal breaks constraint";
    case PlanStatus::kNoGoal:
      return "goal unreachable";
    case PlanStatus::kSeedsBlocked:
      return "seeds blocked";
    case PlanStatus::kTimeLimit:
      return "time limit";
  }
  return "";
}

nb::object rows_of(std::span<const double> numbers, std::size_t n) {
  return copied(numbers.data(), {numbers.size() / n, n});
}

/// Ctrl-C ends a search.
void look_for_signals() {
  const nb::gil_scoped_acquire acquire;
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

nb::tuple as_tuple(const PlanningScene& scene, const Plan& plan) {
  return nb::make_tuple(name_of(plan.status), plan.message, rows_of(plan.waypoints, scene.size()), plan.curve,
                        plan.nodes, plan.iterations, plan.search_time, plan.shorten_time, plan.cost);
}

nb::tuple plan(Planner& self, const Array<double, 1>& start, const Array<double, 2>& goals, double time_limit,
               bool shorten, bool smooth, double blend, double range, std::uint64_t seed,
               const bindings::AxisConstraints& axes, const bindings::PositionConstraints& positions) {
  PlanSettings settings{.time_limit = time_limit, .shorten = shorten, .smooth = smooth, .blend = blend};
  settings.rrt = {range, seed};
  settings.shortening.seed = seed;
  settings.optimization.seed = seed;
  settings.look_up = look_for_signals;
  std::optional<ConfigurationCheck> constrained = bindings::constrained_check(self, axes, positions);
  Plan found;
  {
    const nb::gil_scoped_release release;
    found = find_plan(self.scene, constrained ? *constrained : self.check, as_span(start), as_span(goals), settings);
  }
  return as_tuple(self.scene, found);
}

nb::tuple optimize(Planner& self, const Array<double, 1>& start, const Array<double, 2>& goals, double time_limit,
                   std::size_t seeds, double clearance, std::uint64_t seed) {
  PlanSettings settings{.time_limit = time_limit};
  settings.optimization.seeds = seeds;
  settings.optimization.seed = seed;
  settings.optimization.descent.clearance = clearance;
  settings.look_up = look_for_signals;
  Plan found;
  {
    const nb::gil_scoped_release release;
    found = optimize_plan(self.scene, self.check, as_span(start), as_span(goals), settings);
  }
  return as_tuple(self.scene, found);
}

/// rows (m, n), and where there are none, the plan's status and message.
nb::tuple goals(Planner& self, const std::string& frame, const Array<double, 1>& position,
                const Array<double, 1>& quaternion, const Array<double, 1>& start, std::size_t count,
                std::uint64_t seed, double time_limit) {
  const double *p = position.data(), *r = quaternion.data();
  const Transform<double> X_WF{to_matrix(normalized(Quat<double>{r[0], r[1], r[2], r[3]})), {p[0], p[1], p[2]}};
  GoalConfigurations found;
  {
    const nb::gil_scoped_release release;
    found = goal_configurations(*self.model, self.scene, self.check, self.model->frame_id(frame), X_WF, as_span(start),
                                count, seed, Deadline(time_limit, look_for_signals));
  }
  return nb::make_tuple(rows_of(found.rows, self.scene.size()), name_of(found.status), found.message);
}

double motion_free_until(Planner& self, const Trajectory& motion, double from, const bindings::AxisConstraints& axes,
                         const bindings::PositionConstraints& positions) {
  std::optional<ConfigurationCheck> constrained = bindings::constrained_check(self, axes, positions);
  return free_until(self.scene, constrained ? *constrained : self.check, motion, from);
}

nb::object numbers(const std::vector<double>& row) { return copied(row.data(), {row.size()}); }

NamePairs names_of_pairs(const PlanningScene& scene) {
  NamePairs names;
  for (const PartPair& pair : scene.pairs)
    names.emplace_back(scene.link_name(scene.parts[pair.a].link), scene.link_name(scene.parts[pair.b].link));
  return names;
}

/// Balls (m, 4), centre and radius in the world, that stand for what moves at planned coordinates.
nb::object balls(const Planner& self, const Array<double, 1>& q) {
  const std::vector<double> found = placed_balls(self.scene, as_span(q));
  return copied(found.data(), {found.size() / 4, 4});
}

}  // namespace

void bindings::bind_planner(nb::module_& planning) {
  planning.def("check_path_constraints", &bindings::check_path_constraints, "axes"_a, "positions"_a);
  nb::class_<Planner>(planning, "Planner")
      .def(
          "__init__",
          [](Planner* self, const PythonModel& model, const Array<double, 1>& q, const Array<double, 1>& mocap,
             const std::string& frame, const std::vector<std::string>& joints, const NamePairs& attached,
             const NamePairs& allowed, const std::vector<std::pair<Array<double, 2>, double>>& clouds, double margin,
             double overshoot) {
            SceneSettings settings = settings_of(*model.model, frame, joints, attached, allowed);
            for (const auto& [points, radius] : clouds) settings.clouds.push_back(cloud_of(points, radius));
            settings.mocap.assign(mocap.data(), mocap.data() + mocap.size());
            settings.margin = margin;
            settings.overshoot = overshoot;
            new (self) Planner(model.model, as_span(q), settings);
          },
          "model"_a, "q"_a, "mocap"_a, "frame"_a, "joints"_a, "attached"_a, "allowed"_a, "clouds"_a, "margin"_a,
          "overshoot"_a)
      .def_prop_ro("joints", [](const Planner& self) { return self.scene.joint_names; })
      .def_prop_ro("start", [](const Planner& self) { return numbers(self.scene.planned(self.scene.q)); })
      .def_prop_ro("lower", [](const Planner& self) { return numbers(self.scene.lower); })
      .def_prop_ro("upper", [](const Planner& self) { return numbers(self.scene.upper); })
      .def_prop_ro("velocity", [](const Planner& self) { return numbers(self.scene.velocity); })
      .def(
          "planned",
          [](const Planner& self, const Array<double, 1>& q) { return numbers(self.scene.planned(as_span(q))); }, "q"_a)
      .def(
          "configuration",
          [](const Planner& self, const Array<double, 1>& q) { return numbers(self.scene.configuration(as_span(q))); },
          "q"_a)
      .def("balls", &balls, "q"_a)
      .def_prop_ro("pairs", [](const Planner& self) { return names_of_pairs(self.scene); })
      .def(
          "are_free",
          [](Planner& self, const Array<double, 2>& rows) {
            return bindings::copied_bools(self.check.are_free(as_span(rows)));
          },
          "rows"_a)
      .def(
          "is_way_free",
          [](Planner& self, const Array<float, 1>& a, const Array<float, 1>& b) {
            return self.check.is_free(as_span(a), as_span(b));
          },
          "a"_a, "b"_a)
      .def(
          "nearest",
          [](Planner& self, const Array<double, 1>& q) {
            const Encounter found = self.check.nearest(as_span(q));
            return nb::make_tuple(found.distance, found.a, found.b);
          },
          "q"_a)
      .def(
          "least_distance",
          [](Planner& self, const Array<double, 2>& rows, double step) {
            const Encounter found = least_distance(self.scene, self.check, as_span(rows), step);
            return nb::make_tuple(found.distance, found.a, found.b);
          },
          "rows"_a, "step"_a)
      .def("free_until", &motion_free_until, "motion"_a, "start"_a, "axes"_a, "positions"_a)
      .def(
          "with_cloud",
          [](const Planner& self, const Array<double, 2>& points, double radius) {
            return std::make_unique<Planner>(self.model, self.scene.with_cloud(cloud_of(points, radius)));
          },
          "points"_a, "radius"_a)
      .def("goals", &goals, "frame"_a, "position"_a, "quaternion"_a, "start"_a, "count"_a, "seed"_a, "time_limit"_a)
      .def("plan", &plan, "start"_a, "goals"_a, "time_limit"_a, "shorten"_a, "smooth"_a, "blend"_a, "range"_a, "seed"_a,
           "axes"_a, "positions"_a)
      .def("optimize", &optimize, "start"_a, "goals"_a, "time_limit"_a, "seeds"_a, "clearance"_a, "seed"_a);
}

}  // namespace manyhands
