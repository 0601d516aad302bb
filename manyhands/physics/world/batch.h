// Many worlds of one model in single precision, stepped together: SIMD lanes in threads.
#pragma once

#include <cstdint>
#include <memory>

#include "manyhands/base/thread_pool.h"
#include "manyhands/physics/world/batch_lanes.h"

namespace manyhands {

struct BatchOptions {
  int num_threads = 0;  ///< 0: the variable MANYHANDS_THREADS, else as many as the machine has cores
  int lanes = 0;        ///< 0: the fastest for this build, or scalars for a single world; else 1 or a built width
};

/// Bits of `Batch::flags`.
struct BatchFlag {
  static constexpr std::uint8_t kNotFinite = 1;  ///< stands still at its last finite state, until reset or restored
  static constexpr std::uint8_t kDeep = 2;       ///< penetration beyond kDeepPenetration in the last call of `step`
};

/// What counts as a deep penetration [m].
inline constexpr double kDeepPenetration = 0.01;

/// Motor commands (n, nv) each; see `World::set_motors`.
struct BatchMotors {
  std::span<const float> target_q, target_v, kp, kd, max_force;
};

/// Rows are worlds: an array written (n, k) is row-major, n = num_worlds(). World i has the same bits whatever the size
/// of the batch, the lanes, the threads or its neighbours' fate, and those of a scalar run in float. Setters throw
/// std::invalid_argument on a wrong length or a number that is not finite, and change nothing then; names that are not
/// there throw std::out_of_range. A `mask` (n) chooses worlds by bytes that are not 0; empty: all.
class Batch {
 public:
  /// All worlds start at rest in the model's initial configuration, with motors off.
  Batch(std::shared_ptr<const Model> model, int num_worlds, double time_step = 0.002, const BatchOptions& options = {});

  /// Advances all worlds by n steps. A world whose numbers stop being finite stays as it was before that step.
  void step(int n = 1);

  [[nodiscard]] const Model& model() const { return *model_; }
  [[nodiscard]] std::shared_ptr<const Model> shared_model() const { return model_; }
  [[nodiscard]] int num_worlds() const { return num_worlds_; }
  [[nodiscard]] int lanes() const { return lanes_->width(); }
  [[nodiscard]] int num_threads() const { return pool_.num_threads(); }
  [[nodiscard]] double time_step() const { return time_step_; }
  [[nodiscard]] std::vector<double> time() const;  ///< (n) [s] since each world began
  [[nodiscard]] const SolverSettings& solver() const { return lanes_->solver(); }
  /// Throws std::invalid_argument unless max_iterations is 1 or more and the tolerance 0 or more.
  void set_solver(const SolverSettings& settings);

  // ---- state ---------------------------------------------------------------------------------------------------
  [[nodiscard]] std::vector<float> q() const;     ///< (n, nq)
  [[nodiscard]] std::vector<float> v() const;     ///< (n, nv)
  [[nodiscard]] std::vector<float> tau() const;   ///< (n, nv) [N m or N]
  [[nodiscard]] std::vector<float> ctrl() const;  ///< (n, nu)
  void set_q(std::span<const float> q, std::span<const std::uint8_t> mask = {});
  void set_v(std::span<const float> v, std::span<const std::uint8_t> mask = {});
  void set_tau(std::span<const float> tau, std::span<const std::uint8_t> mask = {});
  void set_ctrl(std::span<const float> ctrl, std::span<const std::uint8_t> mask = {});
  void set_motors(const BatchMotors& commands);
  /// Back to the start, parameters kept.
  void reset(std::span<const std::uint8_t> mask = {});

  [[nodiscard]] std::size_t snapshot_size() const;  ///< numbers of one world
  /// (n, snapshot_size()): all that each world continues from, bit for bit; not the solver's settings.
  [[nodiscard]] std::vector<float> snapshot() const;
  void restore(std::span<const float> snapshot, std::span<const std::uint8_t> mask = {});
  /// FNV-1a over the bits of every world's snapshot, in order.
  [[nodiscard]] std::uint64_t state_hash() const;
  [[nodiscard]] std::span<const std::uint8_t> flags() const { return flags_; }  ///< (n) see BatchFlag

  // ---- bodies: links and frames by name ------------------------------------------------------------------------
  /// In the world: position (n, 3) [m] and quaternion xyzw (n, 4).
  void body_pose(std::string_view name, std::span<float> position, std::span<float> quaternion);
  /// Angular (n, 3) [rad/s], and that of the origin (n, 3) [m/s], in world axes.
  void body_velocity(std::string_view name, std::span<float> omega, std::span<float> velocity);
  /// Forces (n, 3) [N] at the points (n, 3) [m] (empty: the link's centre of mass) and torques (n, 3) [N m] (empty:
  /// none), in world axes; they act in the next step only, and add up.
  void apply_force(std::string_view link, std::span<const float> force, std::span<const float> torque = {},
                   std::span<const float> point = {});

  // ---- what the last step found ----------------------------------------------------------------------------------
  [[nodiscard]] std::vector<std::int32_t> contact_count() const;  ///< (n) points that touch
  [[nodiscard]] std::vector<float> max_penetration() const;       ///< (n) [m], before the step
  /// What contacts do to the link: torque, force (n, 6) in world axes about its origin as it was before the step, of
  /// normal forces and of friction.
  void contact_wrench(std::string_view link, std::span<float> normal, std::span<float> friction) const;

  // ---- parameters of each world: values (n), or as said -----------------------------------------------------------
  void set_gravity(std::span<const float> gravity);                        ///< (n, 3) [m/s^2]
  void set_mass(std::string_view link, std::span<const float> mass);       ///< [kg]; scales the inertia with it
  void set_friction(std::string_view name, std::span<const float> value);  ///< of a geom, or of a link's geoms
  void set_spinning_friction(std::string_view name, std::span<const float> value);
  void set_rolling_friction(std::string_view name, std::span<const float> value);
  void set_restitution(std::string_view name, std::span<const float> value);
  void set_damping(std::string_view joint, std::span<const float> value);
  void set_joint_friction(std::string_view joint, std::span<const float> value);
  void set_armature(std::string_view joint, std::span<const float> value);
  void set_geom_size(std::string_view geom, std::span<const float> size);  ///< (n, 3), see Shape [m]
  void set_gains(std::string_view actuator, std::span<const float> kp, std::span<const float> kd);

 private:
  enum class Part { kQ, kV, kTau, kTargetQ, kTargetV, kCtrl };
  struct Range {
    std::size_t first, count;
  };

  [[nodiscard]] Range range(Part part) const;
  [[nodiscard]] std::vector<float> rows(Part part) const;
  void set_rows(Part part, std::span<const float> values, std::span<const std::uint8_t> mask);
  [[nodiscard]] bool chosen(std::span<const std::uint8_t> mask, std::size_t world) const {
    return mask.empty() || mask[world] != 0;
  }
  void require_rows(const std::string& name, std::span<const float> values, std::size_t columns) const;
  void require_mask(std::span<const std::uint8_t> mask) const;
  void require_least(const std::string& name, std::span<const float> values) const;
  void set_geoms(std::string_view name, const std::string& what, Strided<float> ParamsView<float>::* field,
                 std::span<const float> value);
  void set_dofs(std::string_view joint, const std::string& what, Strided<float> ParamsView<float>::* field,
                std::span<const float> value);
  void forget_step(std::size_t world);

  std::shared_ptr<const Model> model_;
  int num_worlds_;
  double time_step_;
  std::unique_ptr<BatchLanes> lanes_;
  ThreadPool pool_;
  std::vector<float> start_;            // (state numbers) of a world that begins
  std::vector<std::int64_t> steps_;     // (n)
  std::vector<std::uint8_t> flags_;     // (n)
  State<float> layout_;                 // tells where a world's numbers lie
  std::vector<float> pose_, velocity_;  // (n, 12), (n, 6) of one frame
};

}  // namespace manyhands
