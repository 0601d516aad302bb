#include "manyhands/envs/control/control.h"

namespace manyhands {

MANYHANDS_CONTROL(, Lanes4, Lanes4)
MANYHANDS_CONTROL(, Lanes4, float)

}  // namespace manyhands
