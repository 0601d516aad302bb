// Tree: the actuators as kernels read them.
#pragma once

#include "manyhands/physics/dynamics/tree.h"

namespace manyhands {

/// Fills tree.actuators and tree.dof_drive, once its lengths stand.
template <Real R>
void add_actuators(const Model& model, Tree<R>& tree);

}  // namespace manyhands
