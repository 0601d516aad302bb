// The box that has a body's mass and inertia.
#pragma once

#include "manyhands/model/description.h"

namespace manyhands {

/// A solid box of even density.
struct EquivalentBox {
  Transform<double> X_LB;  ///< its centre and axes in the link's frame
  Vec3<double> size;       ///< whole lengths [m]
};

/// The box of the same mass, centre of mass and inertia. Needs a mass above 0.
[[nodiscard]] EquivalentBox equivalent_box(const Inertial& inertial);

}  // namespace manyhands
