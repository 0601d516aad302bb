// What manyhands._core.planning.Planner holds: a scene with what looks at it.
#pragma once

#include <memory>
#include <span>

#include "manyhands/planning/configuration_check.h"

namespace manyhands {

struct Planner {
  Planner(std::shared_ptr<const Model> m, std::span<const double> q, const SceneSettings& settings)
      : model(std::move(m)), scene(*model, q, settings), check(scene) {}
  Planner(std::shared_ptr<const Model> m, PlanningScene s) : model(std::move(m)), scene(std::move(s)), check(scene) {}

  std::shared_ptr<const Model> model;
  PlanningScene scene;
  ConfigurationCheck check;
};

}  // namespace manyhands
