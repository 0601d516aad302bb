#include "bindings/planning/path_constraints.h"

#include "manyhands/math/quaternion.h"

namespace manyhands::bindings {

namespace {

Vec3<double> vector_of(const Array<double, 1>& x) { return {x(0), x(1), x(2)}; }

}  // namespace

std::optional<ConfigurationCheck> constrained_check(const Planner& planner, const AxisConstraints& axes,
                                                    const PositionConstraints& positions) {
  if (axes.empty() && positions.empty()) return {};
  const Model& model = *planner.model;
  std::vector<PathConstraint> all;
  for (const auto& [frame, axis, direction, within] : axes)
    all.push_back(keep_axis(model.frame_id(frame), vector_of(axis), vector_of(direction), within));
  for (const auto& [frame, position, r, lower, upper] : positions) {
    const Transform<double> X_WR{to_matrix(normalized(Quat<double>{r(0), r(1), r(2), r(3)})), vector_of(position)};
    const std::vector<PathConstraint> rows =
        keep_position(model.frame_id(frame), X_WR, vector_of(lower), vector_of(upper));
    all.insert(all.end(), rows.begin(), rows.end());
  }
  return ConfigurationCheck(planner.scene, PathConstraints(model, planner.scene, all));
}

}  // namespace manyhands::bindings
