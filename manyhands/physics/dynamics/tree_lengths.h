// Tree: the lengths of tendons and of actuators at sites as kernels read them.
#pragma once

#include "manyhands/physics/dynamics/tree.h"

namespace manyhands {

/// Fills tree.lengths, once its dofs and paths stand. `start`: null where nothing gives way.
template <Real R>
void add_lengths(const Model& model, const StartMobility* start, Tree<R>& tree);

}  // namespace manyhands
