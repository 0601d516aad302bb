// Concave meshes that move, as several convex ones.
#pragma once

#include <functional>
#include <vector>

#include "manyhands/bullet/body_plan.h"

namespace manyhands::bullet {

/// Makes convex parts of a mesh; none where it cannot, or where its hull will do.
using Decomposer = std::function<std::vector<Mesh>(const Mesh&)>;

/// Gives the triangle meshes that collide on links that move their parts.
void split_concave(const Decomposer& decompose, BodyPlan& plan);

}  // namespace manyhands::bullet
