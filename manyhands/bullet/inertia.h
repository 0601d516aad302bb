// What inertia PyBullet gives to links.
#pragma once

#include "manyhands/bullet/body_plan.h"

namespace manyhands::bullet {

/// The inertia that a link's collision shapes have for a mass, along the axes of its inertial frame: exact for a single
/// centred box, sphere or true cylinder, that of the box around the shapes for others, 0 for ground.
/// In a body from a file, no shape counts as a cube of 2 mm.
[[nodiscard]] Vec3<double> inertia_of_shapes(const BodyPlan& plan, const LinkPlan& link, double mass);

/// Whether a link has one shape alone, and that along its inertial frame; PyBullet puts others into a compound.
[[nodiscard]] bool stands_for_link(const LinkPlan& link);

/// Gives all links their inertia: by their shapes, or the file's (URDF_USE_INERTIA_FROM_FILE), which turns inertial
/// frames to the principal axes.
void set_inertias(BodyPlan& plan, bool use_file);

}  // namespace manyhands::bullet
