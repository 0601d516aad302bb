#include "manyhands/envs/panda_reach.inl"
#include "manyhands/math/instantiate.h"

namespace manyhands {

template class PandaReachBatch<Lanes4>;

}  // namespace manyhands
