// The balls that stand for a part that moves.
#pragma once

#include "manyhands/planning/planning_scene.h"

namespace manyhands::internal {

/// Covers the part's geoms with balls, grown by `margin` [m], and builds the tree over them.
void cover(MovingPart& part, double margin, double overshoot);

}  // namespace manyhands::internal
