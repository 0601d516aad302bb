#include "manyhands/math/instantiate.h"
#include "manyhands/physics/world/batch_lanes.inl"

namespace manyhands {

template std::unique_ptr<BatchLanes> make_batch_lanes<Lanes16>(const Model&, int, float, int);

}  // namespace manyhands
