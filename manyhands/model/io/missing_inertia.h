// Joints that would move no inertia get some.
#pragma once

#include <functional>
#include <string>

#include "manyhands/model/model_builder.h"

namespace manyhands::io {

/// Gives the links of such joints what is missing: the outermost first, which serves those nearer the root as well. A
/// first link that floats without mass is fixed instead. `repaired` is told the link and what was done.
void give_missing_inertia(ModelBuilder& builder, const std::function<void(const Link&, const std::string&)>& repaired);

}  // namespace manyhands::io
