// How far the impulses of contacts are from obeying Signorini's and Coulomb's laws. In double alone.
#pragma once

#include "manyhands/physics/contact/loops.h"
#include "manyhands/physics/contact/newton_finish.h"

namespace manyhands::internal {

/// What resists an impulse along a contact's tangents: the mean of G_tt's diagonal [1 / kg].
[[nodiscard]] double tangent_size(const ContactStiffness<double>& G);

/// The violation of the law at one point [m/s]: |min(G n, u_n)|, |G y - P(G y - u_t)| with P onto the disc of radius G
/// n, and the same of torsion, times its length.
[[nodiscard]] double point_residual(const ContactProblem& problem, const ContactPoint<double>& point);

/// The worst of all points.
[[nodiscard]] double law_residual(const ContactProblem& problem);

}  // namespace manyhands::internal
