// What a World keeps behind its header. Internal to World.
#pragma once

#include "manyhands/model/compose.h"
#include "manyhands/physics/collision/queries/queries.h"
#include "manyhands/physics/world/named_parameters.h"
#include "manyhands/physics/world/world.h"
#include "manyhands/physics/world/world_checks.h"
#include "manyhands/physics/world/world_core.h"

namespace manyhands {

/// What `q` and its like show while removed parts lie between the others.
struct World::Shown {
  std::vector<double> q, v, tau, ctrl, act;
};

}  // namespace manyhands
