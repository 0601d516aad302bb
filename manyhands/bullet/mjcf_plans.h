// The bodies that PyBullet makes of an MJCF file.
#pragma once

#include <vector>

#include "manyhands/bullet/body_plan.h"

namespace manyhands::bullet {

/// One body for each geom of the world, then one for each body on it. Each joint carries a link without mass, to which
/// the file's body is fixed by a joint "jointfix_C_K": C counts these joints, from `fixed` on, K is the number of the
/// link in its file. A body on the world without joints moves freely; one on joints hangs on a base that stands.
[[nodiscard]] std::vector<BodyPlan> mjcf_plans_of(const Model& model, int& fixed);

}  // namespace manyhands::bullet
