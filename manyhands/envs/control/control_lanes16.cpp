#include "manyhands/envs/control/control.h"

namespace manyhands {

MANYHANDS_CONTROL(, Lanes16, Lanes16)
MANYHANDS_CONTROL(, Lanes16, float)

}  // namespace manyhands
