// The judge: distances of a scene's shapes at one configuration, by the collision code and nothing else.
#pragma once

#include "manyhands/planning/configuration_check.h"

namespace manyhands::internal {

class ExactCheck {
 public:
  explicit ExactCheck(const PlanningScene& scene);

  /// Places everything at planned coordinates (n).
  void place(std::span<const double> planned);

  /// Of a part from an obstacle or a cloud, and of both parts of a pair from each other [m]; `far` if it is more.
  [[nodiscard]] double distance(int part, int obstacle, double far) const;
  [[nodiscard]] double distance(const PartPair& pair, double far) const;
  /// The nearest two of all that may not touch; nothing farther than `far` is looked for.
  [[nodiscard]] Encounter nearest(double far) const;

 private:
  [[nodiscard]] Transform<double> pose(const MovingPart& part, const SceneGeom& geom) const;
  void take_nearer(const SceneGeom& a, const Transform<double>& X_WA, const SceneGeom& b, const Transform<double>& X_WB,
                   double& least) const;
  [[nodiscard]] double distance_from_cloud(const MovingPart& part, int cloud, double far) const;
  [[nodiscard]] std::string name_of(int obstacle) const;

  const PlanningScene& scene_;
  Workspace<double> ws_;
  std::vector<double> q_;
};

}  // namespace manyhands::internal
