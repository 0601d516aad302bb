// The shapes of a model's links at a configuration.
#pragma once

#include <span>
#include <vector>

#include "manyhands/physics/collision/colliders.h"
#include "manyhands/physics/dynamics/workspace.h"
#include "manyhands/planning/line_crossings.h"

namespace manyhands {

/// The model outlives it.
class PlacedLinks {
 public:
  /// q (nq); mocap: poses of the mocap bodies, as State has them, or empty: where the model has them. Throws
  /// std::invalid_argument on other numbers of them, and on numbers that are not finite.
  PlacedLinks(const Model& model, std::span<const double> q, std::span<const double> mocap);

  /// What collides of a link, in the world; valid while this lives.
  [[nodiscard]] std::vector<PlacedShape> shapes_of(LinkId link) const;
  /// The link's centre of mass in the world [m].
  [[nodiscard]] Vec3<double> com_of(LinkId link) const;

 private:
  const Model& model_;
  Tree<double> tree_;
  Colliders<double> colliders_;
  Workspace<double> ws_;
};

}  // namespace manyhands
