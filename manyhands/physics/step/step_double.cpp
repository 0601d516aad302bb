#include "manyhands/physics/step/step.h"

namespace manyhands {

MANYHANDS_STEP(, double, double)

}  // namespace manyhands
