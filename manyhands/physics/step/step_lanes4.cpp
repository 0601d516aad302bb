#include "manyhands/physics/step/step.h"

namespace manyhands {

MANYHANDS_STEP(, Lanes4, Lanes4)
MANYHANDS_STEP(, Lanes4, float)

}  // namespace manyhands
