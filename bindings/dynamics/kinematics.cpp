// manyhands._core.kinematics: inverse kinematics over rows of targets, and what frames.cpp and screws.cpp add.
#include "bindings/dynamics/kinematics.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "bindings/dynamics/rows.h"
#include "bindings/model/python_model.h"
#include "bindings/numbers.h"
#include "bindings/planning/planner.h"
#include "manyhands/kinematics/closed_form.h"
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

using bindings::copied;

/// Targets between two looks for Ctrl-C.
constexpr std::size_t kPiece = 1024;

/// A part of a goal, as it was given: one row for all targets, or one each.
class Part {
 public:
  /// Throws std::invalid_argument on a wrong shape, NaN and infinities; None is not given.
  Part(const char* name, std::size_t width, nb::handle given) : name_(name), width_(width) {
    if (given.is_none()) return;
    numbers_.emplace(name, given);
    const std::size_t dimensions = numbers_->ndim();
    if (dimensions < 1 || dimensions > 2 || numbers_->shape(dimensions - 1) != width) {
      const std::string w = std::to_string(width);
      throw std::invalid_argument(std::string(name) + " has shape " + bindings::shape_of(*numbers_) + "; expected (" +
                                  w + ",) or (n, " + w + ")");
    }
    bindings::require_finite(name, *numbers_);
  }

  [[nodiscard]] const char* name() const { return name_; }
  [[nodiscard]] bool is_given() const { return numbers_.has_value(); }
  [[nodiscard]] bool has_rows() const { return is_given() && numbers_->ndim() == 2; }
  [[nodiscard]] std::size_t rows() const { return numbers_->shape(0); }
  [[nodiscard]] const double* row(std::size_t i) const { return numbers_->data() + (has_rows() ? i * width_ : 0); }
  [[nodiscard]] Vec3<double> vector(std::size_t i) const {
    const double* x = row(i);
    return {x[0], x[1], x[2]};
  }

 private:
  const char* name_;
  std::size_t width_;
  std::optional<bindings::Numbers> numbers_{};
};

Vec3<double> unit(const char* name, const Vec3<double>& v) {
  const double length = norm(v);
  if (!(length >= bindings::kShortest)) bindings::refuse_short(name);
  return (1 / length) * v;
}

Mat3<double> rotation(const double* x) {
  bindings::require_rotation(x);
  return to_matrix(normalized(Quat<double>{x[0], x[1], x[2], x[3]}));
}

/// A goal as Python names its parts.
struct Goal {
  Part position, quaternion, direction, look_at;

  void check() const {
    const int orientations = quaternion.is_given() + direction.is_given() + look_at.is_given();
    if (orientations == 0 && !position.is_given())
      throw std::invalid_argument("there is no goal; give position, quaternion, direction or look_at");
    if (orientations > 1)
      throw std::invalid_argument(
          "quaternion, direction and look_at are different goals of orientation; give one of them");
  }

  [[nodiscard]] std::array<const Part*, 4> parts() const { return {&position, &quaternion, &direction, &look_at}; }

  [[nodiscard]] bool is_single() const {
    return std::ranges::none_of(parts(), [](const Part* part) { return part->has_rows(); });
  }

  /// How many targets it has. Throws std::invalid_argument where parts differ.
  [[nodiscard]] std::size_t count() const {
    const Part* first = nullptr;
    for (const Part* part : parts()) {
      if (!part->has_rows()) continue;
      if (!first) first = part;
      const std::size_t n = first->rows(), other = part->rows();
      if (n != other)
        throw std::invalid_argument(std::string(first->name()) + " " + std::to_string(n) + " and " + part->name() +
                                    " " + std::to_string(other) +
                                    " rows; expected as many rows of each, or a single one for all");
    }
    return first ? first->rows() : 1;
  }

  [[nodiscard]] IkOrientation orientation() const {
    return quaternion.is_given()  ? IkOrientation::kFull
           : direction.is_given() ? IkOrientation::kAxisAlong
           : look_at.is_given()   ? IkOrientation::kAxisAt
                                  : IkOrientation::kFree;
  }

  [[nodiscard]] IkTarget<double> target(std::size_t i) const {
    IkTarget<double> target{Transform<double>::identity(), Vec3<double>::zero()};
    if (position.is_given()) target.X_WF.p = position.vector(i);
    if (quaternion.is_given()) target.X_WF.R = rotation(quaternion.row(i));
    if (direction.is_given()) target.toward = unit("direction", direction.vector(i));
    if (look_at.is_given()) target.toward = look_at.vector(i);
    return target;
  }
};

/// Empty for None.
std::vector<double> configuration(const char* name, nb::handle given, int nq) {
  if (given.is_none()) return {};
  const bindings::Numbers q(name, given);
  if (q.ndim() != 1 || q.shape(0) != bindings::size(nq))
    throw std::invalid_argument(std::string(name) + " has shape " + bindings::shape_of(q) + "; expected (" +
                                std::to_string(nq) + ",)");
  bindings::require_finite(name, q);
  return {q.data(), q.data() + q.size()};
}

void require_positive(const char* name, double number, bool may_be_infinite) {
  if (number > 0 && (may_be_infinite || std::isfinite(number))) return;
  throw std::invalid_argument(std::string(name) + " is " + nb::str(nb::float_(number)).c_str() +
                              (may_be_infinite ? "; expected more than 0" : "; expected a finite number above 0"));
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

/// Pieces, between which Ctrl-C is looked for.
IkSolutions search(PythonModel& model, int key, const IkGoal& goal, std::span<const IkTarget<double>> targets,
                   std::span<const double> start, const IkSearchSettings& settings, Planner* avoid) {
  if (!model.ik) model.ik = std::make_shared<IkPool>(*model.model);
  const std::shared_ptr<IkPool> pool = model.ik;
  IkSolutions all;
  for (std::size_t first = 0; first == 0 || first < targets.size(); first += kPiece) {
    const std::span piece = targets.subspan(first, std::min(kPiece, targets.size() - first));
    IkSolutions found;
    {
      const nb::gil_scoped_release release;
      pool->searches.use(key, [&](IkPool::Search& one) {
        const IkFilter accepts = avoid == nullptr ? IkFilter() : free_in(*avoid, *model.model, one.chain());
        found = one.find(goal, piece, start, settings, accepts);
      });
    }
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (first == 0) {
      all = std::move(found);
      continue;
    }
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(all.q, found.q);
    append(all.success, found.success);
    append(all.position_error, found.position_error);
    append(all.rotation_error, found.rotation_error);
  }
  return all;
}

nb::tuple find_inverse(PythonModel& model, const std::string& frame, nb::handle position, nb::handle quaternion,
                       nb::handle direction, nb::handle look_at, nb::handle axis, nb::handle posture,
                       double position_weight, double rotation_weight, const std::string& relative_to, Planner* avoid,
                       nb::handle start, int restarts, std::uint64_t seed, bool respect_limits,
                       double position_tolerance, double rotation_tolerance) {
  const Model& robot = *model.model;
  const Goal given{
      {"position", 3, position}, {"quaternion", 4, quaternion}, {"direction", 3, direction}, {"look_at", 3, look_at}};
  given.check();
  require_positive("position_weight", position_weight, false);
  require_positive("rotation_weight", rotation_weight, false);
  require_positive("position_tolerance", position_tolerance, true);
  require_positive("rotation_tolerance", rotation_tolerance, true);
  IkGoal goal{.orientation = given.orientation(),
              .position_weight = given.position.is_given() ? position_weight : 0,
              .rotation_weight = rotation_weight,
              .posture = configuration("posture", posture, robot.nq())};
  if (given.direction.is_given() || given.look_at.is_given())
    if (const Part pointing("axis", 3, axis); pointing.is_given()) goal.axis = unit("axis", pointing.vector(0));
  IkSearchSettings settings{.restarts = restarts, .seed = seed};
  settings.ik.respect_limits = respect_limits;
  settings.ik.position_tolerance = position_tolerance;
  settings.ik.rotation_tolerance = rotation_tolerance;
  std::vector<double> first = configuration("start", start, robot.nq());
  settings.from_start = !first.empty() || !goal.posture.empty();
  if (first.empty()) first = goal.posture.empty() ? robot.neutral_configuration() : goal.posture;
  std::vector<IkTarget<double>> targets(given.count());
  for (std::size_t i = 0; i < targets.size(); ++i) targets[i] = given.target(i);
  std::optional<FrameId> base;
  if (!relative_to.empty()) base = robot.frame_id(relative_to);
  const IkSolutions found =
      search(model, IkPool::key(robot, robot.frame_id(frame), base), goal, targets, first, settings, avoid);
  if (given.is_single())
    return nb::make_tuple(bindings::new_array(found.q), found.success[0] != 0, found.position_error[0],
                          found.rotation_error[0]);
  const std::size_t n = targets.size();
  return nb::make_tuple(copied(found.q.data(), {n, bindings::size(robot.nq())}), bindings::copied_bools(found.success),
                        copied(found.position_error.data(), {n}), copied(found.rotation_error.data(), {n}));
}

/// (k, nq) all configurations within the limits that lead to a pose.
nb::object closed_form(PythonModel& model, const std::string& frame, nb::handle position, nb::handle quaternion,
                       nb::handle start) {
  const Model& robot = *model.model;
  const Part p("position", 3, position), r("quaternion", 4, quaternion);
  if (!p.is_given() || !r.is_given() || p.has_rows() || r.has_rows())
    throw std::invalid_argument("position and quaternion are one pose; expected (3,) and (4,)");
  std::vector<double> near = configuration("start", start, robot.nq());
  if (near.empty()) near = robot.neutral_configuration();
  const std::optional<ClosedForm> form = ClosedForm::of(robot, robot.frame_id(frame));
  if (!form)
    throw std::invalid_argument(
        "the joints that move '" + frame +
        "' are no six-axis arm with a closed form: second and third axis parallel, and a spherical wrist or a fourth "
        "axis parallel to them; kinematics.inverse finds one configuration of any arm");
  const auto rows = form->within_limits(robot, {rotation(r.row(0)), p.vector(0)}, near);
  std::vector<double> all;
  for (const std::vector<double>& q : rows) all.insert(all.end(), q.begin(), q.end());
  return copied(all.data(), {rows.size(), near.size()});
}

}  // namespace

void bind_kinematics(nb::module_& parent) {
  nb::module_ m =
      parent.def_submodule("kinematics", "Kinematics over rows; manyhands.kinematics describes the functions.");
  bindings::bind_frames(m);
  bindings::bind_screws(m);
  m.def("inverse", &find_inverse, "model"_a, "frame"_a, "position"_a.none(), "quaternion"_a.none(),
        "direction"_a.none(), "look_at"_a.none(), "axis"_a.none(), "posture"_a.none(), "position_weight"_a,
        "rotation_weight"_a, "relative_to"_a, "avoid"_a.none(), "start"_a.none(), "restarts"_a, "seed"_a,
        "respect_limits"_a, "position_tolerance"_a, "rotation_tolerance"_a,
        "Rows (n, ...) or one of each part of a goal -> q (n, nq), success (n,), position_error (n,), rotation_error "
        "(n,), or those of a single goal; see manyhands.kinematics.inverse.");
  m.def("closed_form", &closed_form, "model"_a, "frame"_a, "position"_a, "quaternion"_a, "start"_a.none(),
        "(k, nq); see manyhands.kinematics.inverse_all.");
}

}  // namespace manyhands
