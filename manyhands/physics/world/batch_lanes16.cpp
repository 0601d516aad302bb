#include "manyhands/physics/world/batch_lanes.inl"

namespace manyhands {

template <>
std::unique_ptr<BatchLanes> make_batch_lanes<Lanes16>(const Model& model, int num_worlds, float h, int num_workers) {
  return std::make_unique<BatchLanesOf<Lanes16>>(model, num_worlds, h, num_workers);
}

}  // namespace manyhands
