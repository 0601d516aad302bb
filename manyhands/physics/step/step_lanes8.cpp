#include "manyhands/physics/step/step.h"

namespace manyhands {

MANYHANDS_STEP(, Lanes8, Lanes8)
MANYHANDS_STEP(, Lanes8, float)

}  // namespace manyhands
