#include "manyhands/physics/step/step.h"

namespace manyhands {

MANYHANDS_STEP(, Lanes16, Lanes16)
MANYHANDS_STEP(, Lanes16, float)

}  // namespace manyhands
