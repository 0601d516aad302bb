// What the files that bind World share.
#pragma once

#include <nanobind/nanobind.h>

#include "manyhands/physics/world/world.h"

namespace manyhands {

void bind_world_bodies(nanobind::class_<World>& world);                          // poses, velocities, forces
void bind_world_contacts(nanobind::module_& m, nanobind::class_<World>& world);  // what the last step found
void bind_world_queries(nanobind::module_& m, nanobind::class_<World>& world);   // distances and rays
void bind_world_parts(nanobind::class_<World>& world);                           // adding, removing, parameters

}  // namespace manyhands
