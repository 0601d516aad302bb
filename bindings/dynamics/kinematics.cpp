// manyhands._core.kinematics: inverse kinematics over rows of targets, and what frames.cpp and screws.cpp add.
#include "bindings/dynamics/kinematics.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "bindings/model/python_model.h"
#include "bindings/vectors.h"
#include "manyhands/kinematics/ik_search.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

/// Searches of a model, each for one of its frames.
struct IkPool {
  struct Search : IkSearch {
    Search(const Model& model, int frame) : IkSearch(model, FrameId(frame)) {}
  };

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

nb::tuple search(PythonModel& model, const std::string& frame, const Array<double, 2>& position,
                 const Array<double, 2>& quaternion, const Array<double, 2>& toward, const Array<double, 1>& start,
                 const std::string& orientation, const std::array<double, 3>& axis, double position_weight,
                 double rotation_weight, const Array<double, 1>& posture, int restarts, std::uint64_t seed,
                 bool respect_limits, double position_tolerance, double rotation_tolerance) {
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
  const FrameId id = model.model->frame_id(frame);
  if (!model.ik) model.ik = std::make_shared<IkPool>(*model.model);
  const std::shared_ptr<IkPool> pool = model.ik;
  IkSolutions all;
  for (std::size_t first = 0; first < n; first += kPiece) {
    const std::span piece = std::span(targets).subspan(first, std::min(kPiece, n - first));
    IkSolutions found;
    {
      const nb::gil_scoped_release release;
      pool->searches.use(
          id.value(), [&](IkPool::Search& one) { found = one.find(goal, piece, bindings::as_span(start), settings); });
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
  m.def("search", &search, "model"_a, "frame"_a, "position"_a, "quaternion"_a, "toward"_a, "start"_a, nb::kw_only(),
        "orientation"_a, "axis"_a, "position_weight"_a, "rotation_weight"_a, "posture"_a, "restarts"_a, "seed"_a,
        "respect_limits"_a, "position_tolerance"_a, "rotation_tolerance"_a,
        "position (n, 3), quaternion (n, 4) xyzw, toward (n, 3), start (nq,), posture (nq,) or (0,) -> q (n, nq), "
        "success (n,), position_error (n,), "
        "rotation_error (n,); see manyhands.kinematics.inverse.");
}

}  // namespace manyhands
