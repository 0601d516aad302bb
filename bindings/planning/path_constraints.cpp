#include "bindings/planning/path_constraints.h"

#include "manyhands/math/quaternion.h"

namespace manyhands::bindings {

namespace {

Vec3<double> vector_of(const Array<double, 1>& x) { return {x(0), x(1), x(2)}; }

/// Throws std::invalid_argument on numbers without sense, and what `frame_of` throws of a name.
template <class FrameOf>
std::vector<PathConstraint> made(const AxisConstraints& axes, const PositionConstraints& positions,
                                 const FrameOf& frame_of) {
  std::vector<PathConstraint> all;
  for (const auto& [frame, axis, direction, within] : axes)
    all.push_back(keep_axis(frame_of(frame), vector_of(axis), vector_of(direction), within));
  for (const auto& [frame, position, r, lower, upper] : positions) {
    const Transform<double> X_WR{to_matrix(normalized(Quat<double>{r(0), r(1), r(2), r(3)})), vector_of(position)};
    const std::vector<PathConstraint> rows = keep_position(frame_of(frame), X_WR, vector_of(lower), vector_of(upper));
    all.insert(all.end(), rows.begin(), rows.end());
  }
  return all;
}

}  // namespace

void check_path_constraints(const AxisConstraints& axes, const PositionConstraints& positions) {
  static_cast<void>(made(axes, positions, [](const std::string&) { return FrameId(0); }));
}

std::optional<ConfigurationCheck> constrained_check(const Planner& planner, const AxisConstraints& axes,
                                                    const PositionConstraints& positions) {
  if (axes.empty() && positions.empty()) return {};
  const Model& model = *planner.model;
  const std::vector<PathConstraint> all =
      made(axes, positions, [&](const std::string& name) { return model.frame_id(name); });
  return ConfigurationCheck(planner.scene, PathConstraints(model, planner.scene, all));
}

}  // namespace manyhands::bindings
