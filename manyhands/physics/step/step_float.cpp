#include "manyhands/physics/step/step.h"

namespace manyhands {

MANYHANDS_STEP(, float, float)

}  // namespace manyhands
