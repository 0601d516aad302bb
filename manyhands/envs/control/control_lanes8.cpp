#include "manyhands/envs/control/control.h"

namespace manyhands {

MANYHANDS_CONTROL(, Lanes8, Lanes8)
MANYHANDS_CONTROL(, Lanes8, float)

}  // namespace manyhands
