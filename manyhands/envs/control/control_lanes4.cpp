#include "manyhands/envs/control/control.h"

namespace manyhands {

MANYHANDS_FOR_LANES(MANYHANDS_CONTROL, , Lanes4)

}  // namespace manyhands
