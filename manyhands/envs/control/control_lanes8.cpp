#include "manyhands/envs/control/control.h"

namespace manyhands {

MANYHANDS_FOR_LANES(MANYHANDS_CONTROL, , Lanes8)

}  // namespace manyhands
