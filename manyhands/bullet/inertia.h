// What inertia PyBullet gives to links.
#pragma once

#include "manyhands/bullet/body_plan.h"

namespace manyhands::bullet {

/// The inertia that a link's collision shapes have for a mass, along the axes of its inertial frame: exact for a single
/// centred box, sphere or true cylinder, that of the box around the shapes for others, 0 for ground.
/// `from_file`: of a link in a file, where no shape counts as a cube of 2 mm.
[[nodiscard]] Vec3<double> inertia_of_shapes(const BodyPlan& plan, const LinkPlan& link, double mass, bool from_file);

/// Gives all links their inertia: by their shapes, or the file's (URDF_USE_INERTIA_FROM_FILE), which turns inertial
/// frames to the principal axes.
void set_inertias(BodyPlan& plan, bool use_file, bool from_file);

}  // namespace manyhands::bullet
