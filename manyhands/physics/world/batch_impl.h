// What a Batch holds. Internal to Batch.
#pragma once

#include <optional>

#include "manyhands/base/thread_pool.h"
#include "manyhands/physics/world/batch.h"
#include "manyhands/physics/world/batch_lanes.h"
#include "manyhands/physics/world/named_parameters.h"
#include "manyhands/physics/world/snapshot.h"
#include "manyhands/physics/world/world_checks.h"

namespace manyhands {

/// Which worlds: those with a byte that is not 0, or all if it is empty.
using Mask = std::span<const std::uint8_t>;

inline bool chosen(Mask mask, std::size_t world) { return mask.empty() || mask[world] != 0; }

struct Batch::Impl {
  using StateField = Strided<float> StateView<float>::*;

  Impl(std::shared_ptr<const Model> shared_model, int n, double h, const BatchOptions& options);

  [[nodiscard]] WorldView<float> world(std::size_t i) const { return lanes->world(i); }
  [[nodiscard]] NamedParameters<float> parameters();
  [[nodiscard]] const SnapshotOwner& snapshot_owner();
  [[nodiscard]] std::vector<float> rows(StateField field) const;
  void set_rows(StateField field, std::span<const float> values, Mask mask);
  void require_mask(Mask mask) const;
  /// What the last step found is gone, and a world that stands still may move again.
  void forget_step(std::size_t i);

  std::shared_ptr<const Model> model;
  int num_worlds;
  double time_step;
  ThreadPool pool;
  std::unique_ptr<BatchLanes> lanes{};
  std::vector<float> start{};            ///< the state of a world that begins, field by field
  std::vector<std::int64_t> steps;       ///< (n)
  std::vector<std::uint8_t> flags;       ///< (n)
  std::vector<float> pose, velocity;     ///< (n, 12), (n, 6) of one frame
  std::optional<SnapshotOwner> owner{};  ///< once it is asked for
};

}  // namespace manyhands
