#include "manyhands/physics/step/step.h"

namespace manyhands {

MANYHANDS_FOR_LANES(MANYHANDS_STEP, , Lanes8)

}  // namespace manyhands
