// What a World keeps behind its header. Internal to World.
#pragma once

#include <set>

#include "manyhands/model/compose.h"
#include "manyhands/physics/collision/queries/queries.h"
#include "manyhands/physics/world/named_parameters.h"
#include "manyhands/physics/world/world.h"
#include "manyhands/physics/world/world_checks.h"
#include "manyhands/physics/world/world_core.h"

namespace manyhands {

struct World::Edit {
  ModelBuilder builder{"world"};
  PartMap map;             // from the present model to the builder
  std::set<int> left_out;  // links of the builder that will be removed
};

}  // namespace manyhands
