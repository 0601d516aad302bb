// The blocks of a Batch behind an interface that knows no width. Internal to Batch.
#pragma once

#include <memory>

#include "manyhands/base/thread_pool.h"
#include "manyhands/physics/world/world_block.h"

namespace manyhands {

class BatchLanes {
 public:
  virtual ~BatchLanes() = default;

  [[nodiscard]] virtual int width() const = 0;
  [[nodiscard]] virtual const SolverSettings& solver() const = 0;
  virtual void set_solver(const SolverSettings& settings) = 0;
  [[nodiscard]] virtual Colliders<float>& colliders() = 0;
  [[nodiscard]] virtual WorldView<float> world(std::size_t world) = 0;

  virtual void step(int n, ThreadPool& pool) = 0;
  /// Pose (n, 12: the columns of R, then p) and velocity (n, 6) of a frame, for the first n worlds.
  virtual void frame_motion(BodyId body, const Transform<float>& X_BF, ThreadPool& pool, std::span<float> pose,
                            std::span<float> velocity) = 0;
};

/// T: float, or one of the lane types of math/instantiate.h.
template <Number T>
[[nodiscard]] std::unique_ptr<BatchLanes> make_batch_lanes(const Model& model, int num_worlds, float time_step,
                                                           int num_workers);

// clang-format off
template <> std::unique_ptr<BatchLanes> make_batch_lanes<float>(const Model&, int, float, int);
template <> MANYHANDS_LANES4 std::unique_ptr<BatchLanes> make_batch_lanes<Lanes4>(const Model&, int, float, int);
template <> MANYHANDS_LANES8 std::unique_ptr<BatchLanes> make_batch_lanes<Lanes8>(const Model&, int, float, int);
template <> MANYHANDS_LANES16 std::unique_ptr<BatchLanes> make_batch_lanes<Lanes16>(const Model&, int, float, int);
// clang-format on

}  // namespace manyhands
