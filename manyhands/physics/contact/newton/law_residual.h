// How far the impulses of contacts are from obeying Signorini's and Coulomb's laws. In double alone.
#pragma once

#include <cmath>

#include "manyhands/physics/contact/newton/newton_context.h"

namespace manyhands::internal {

/// Of a vector along a contact's tangents.
[[nodiscard]] inline double length(double a, double b) { return std::sqrt(a * a + b * b); }

/// What resists an impulse along a contact's tangents: the mean of G_tt's diagonal [1 / kg].
[[nodiscard]] double tangent_size(const DelassusBlock<double>& G);

/// The worst violation of the law at a patch [m/s]: of its points |min(G n, u_n)|, |G y - P(G y - u_t)| with P onto the
/// disc of radius G n, and the same of torsion, times its length.
[[nodiscard]] double patch_residual(const NewtonContext& context, const ContactPatch<double>& patch);

/// The worst of all patches.
[[nodiscard]] double law_residual(const NewtonContext& context);

}  // namespace manyhands::internal
