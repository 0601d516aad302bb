// manyhands._core.kinematics: inverse kinematics over rows of targets, and what frames.cpp and screws.cpp add.
#include "bindings/dynamics/kinematics.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <optional>

#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "bindings/model/python_model.h"
#include "bindings/planning/planner.h"
#include "bindings/vectors.h"
#include "manyhands/kinematics/ik_search.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

/// Searches of a model, each for one of its frames, in the world or in another frame.
struct IkPool {
  struct Search : IkSearch {
    Search(const Model& model, int key) : IkSearch(made(model, key)) {}
  };

  /// Of a frame and the one that it is relative to, if there is one.
  static int key(const Model& model, FrameId frame, std::optional<FrameId> relative_to) {
    const int frames = static_cast<int>(model.frames().size());
    return frame.value() + (relative_to ? frames * (relative_to->value() + 1) : 0);
  }

  static IkSearch made(const Model& model, int key) {
    const int frames = static_cast<int>(model.frames().size());
    const FrameId frame(key % frames);
    return key < frames ? IkSearch(model, frame) : IkSearch(model, frame, FrameId(key / frames - 1));
  }

  explicit IkPool(const Model& model) : searches(model) {}

  ModelPool<Search> searches;
};

namespace {

using bindings::Array;
using bindings::copied;

/// Targets between two looks for Ctrl-C.
constexpr std::size_t kPiece = 1024;

IkOrientation orientation_of(const std::string& name) {
  if (name == "full") return IkOrientation::kFull;
  if (name == "free") return IkOrientation::kFree;
  if (name == "along") return IkOrientation::kAxisAlong;
  if (name == "at") return IkOrientation::kAxisAt;
  throw std::invalid_argument("orientation is '" + name + "'; expected 'full', 'free', 'along' or 'at'");
}

/// Lets through what is free in a planner's scene. Throws std::invalid_argument if the planner is of another model, or
/// if it does not plan a joint of the chain.
IkFilter free_in(Planner& planner, const Model& model, const IkChain& chain) {
  if (planner.model.get() != &model) throw std::invalid_argument("avoid is a planner of another model; use its model");
  for (const std::size_t dof : chain.dofs) {
    const auto k = static_cast<std::size_t>(planner.scene.tree.dof_q[dof]);
    if (std::ranges::find(planner.scene.coordinates, k) != planner.scene.coordinates.end()) continue;
    throw std::invalid_argument("avoid does not plan joint '" + model.joint(JointId(model.dof_joint()[dof])).name +
                                "', which moves the frame");
  }
  return [&planner](std::span<const double> q) { return planner.check.are_free(planner.scene.planned(q))[0] != 0; };
}

nb::tuple search(PythonModel& model, const std::string& frame, const std::string& relative_to,
                 const Array<double, 2>& position, const Array<double, 2>& quaternion, const Array<double, 2>& toward,
                 const Array<double, 1>& start, const std::string& orientation, const std::array<double, 3>& axis,
                 double position_weight, double rotation_weight, const Array<double, 1>& posture, int restarts,
                 std::uint64_t seed, bool respect_limits, double position_tolerance, double rotation_tolerance,
                 Planner* avoid) {
  const std::size_t n = position.shape(0);
  const IkGoal goal{orientation_of(orientation),
                    {axis[0], axis[1], axis[2]},
                    position_weight,
                    rotation_weight,
                    {posture.data(), posture.data() + posture.size()}};
  std::vector<IkTarget<double>> targets;
  for (std::size_t i = 0; i < n; ++i) {
    const Quat<double> r =
        normalized(Quat<double>{quaternion(i, 0), quaternion(i, 1), quaternion(i, 2), quaternion(i, 3)});
    targets.push_back(
        {{to_matrix(r), {position(i, 0), position(i, 1), position(i, 2)}}, {toward(i, 0), toward(i, 1), toward(i, 2)}});
  }
  IkSearchSettings settings{.restarts = restarts, .seed = seed};
  settings.ik.respect_limits = respect_limits;
  settings.ik.position_tolerance = position_tolerance;
  settings.ik.rotation_tolerance = rotation_tolerance;
  std::optional<FrameId> base;
  if (!relative_to.empty()) base = model.model->frame_id(relative_to);
  const int key = IkPool::key(*model.model, model.model->frame_id(frame), base);
  if (!model.ik) model.ik = std::make_shared<IkPool>(*model.model);
  const std::shared_ptr<IkPool> pool = model.ik;
  IkSolutions all;
  for (std::size_t first = 0; first < n; first += kPiece) {
    const std::span piece = std::span(targets).subspan(first, std::min(kPiece, n - first));
    IkSolutions found;
    {
      const nb::gil_scoped_release release;
      pool->searches.use(key, [&](IkPool::Search& one) {
        const IkFilter accepts = avoid == nullptr ? IkFilter() : free_in(*avoid, *model.model, one.chain());
        found = one.find(goal, piece, bindings::as_span(start), settings, accepts);
      });
    }
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(all.q, found.q);
    append(all.success, found.success);
    append(all.position_error, found.position_error);
    append(all.rotation_error, found.rotation_error);
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
  }
  return nb::make_tuple(copied(all.q.data(), {n, static_cast<std::size_t>(model.model->nq())}),
                        bindings::copied_bools(all.success), copied(all.position_error.data(), {n}),
                        copied(all.rotation_error.data(), {n}));
}

}  // namespace

void bind_kinematics(nb::module_& parent) {
  nb::module_ m =
      parent.def_submodule("kinematics", "Kinematics over rows; manyhands.kinematics describes the functions.");
  bindings::bind_frames(m);
  bindings::bind_screws(m);
  m.def("search", &search, "model"_a, "frame"_a, "relative_to"_a, "position"_a, "quaternion"_a, "toward"_a, "start"_a,
        nb::kw_only(), "orientation"_a, "axis"_a, "position_weight"_a, "rotation_weight"_a, "posture"_a, "restarts"_a,
        "seed"_a, "respect_limits"_a, "position_tolerance"_a, "rotation_tolerance"_a, "avoid"_a.none(),
        "position (n, 3), quaternion (n, 4) xyzw, toward (n, 3), start (nq,), posture (nq,) or (0,) -> q (n, nq), "
        "success (n,), position_error (n,), "
        "rotation_error (n,); see manyhands.kinematics.inverse.");
}

}  // namespace manyhands
