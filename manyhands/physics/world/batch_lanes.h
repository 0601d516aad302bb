// The blocks of a Batch: W worlds in the lanes of each, behind an interface that knows no width. Internal to Batch.
#pragma once

#include <cstdint>
#include <memory>

#include "manyhands/base/thread_pool.h"
#include "manyhands/physics/step/step.h"
#include "manyhands/physics/world/parameters.h"

namespace manyhands {

/// Numbers of one world beside its state and parameters.
struct BatchExtras {
  Strided<float> link_mass;  ///< (links) [kg]
  Strided<float> external;   ///< (links, 6) torque about the link's origin, force: for the next step only
  Strided<float> wrench;     ///< (links, 12) of contacts in the last step: normal torque, force, friction torque, force
  float& pushed;             ///< 1 where any of `external` is not 0
  float& frozen;             ///< 1 where the world stands still
  float& advanced;           ///< steps that the last call of `step` took
  float& contacts;           ///< points that touch
  float& penetration;        ///< deepest in the last step [m]
  float& deepest;            ///< deepest in the last call of `step` [m]
};

class BatchLanes {
 public:
  virtual ~BatchLanes() = default;

  [[nodiscard]] virtual int width() const = 0;
  [[nodiscard]] virtual int num_blocks() const = 0;
  [[nodiscard]] virtual const SolverSettings& solver() const = 0;
  virtual void set_solver(const SolverSettings& settings) = 0;
  [[nodiscard]] virtual Colliders<float>& colliders() = 0;

  [[nodiscard]] virtual Strided<float> state(std::size_t world) = 0;  ///< the numbers of State
  [[nodiscard]] virtual ParamsView<float> params(std::size_t world) = 0;
  [[nodiscard]] virtual BatchExtras extras(std::size_t world) = 0;

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
