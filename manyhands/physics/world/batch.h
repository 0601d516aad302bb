// Many worlds of one model in single precision, stepped together: SIMD lanes in threads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace manyhands {

class Model;
struct SolverSettings;

struct BatchOptions {
  int num_threads = 0;  ///< 0: the variable MANYHANDS_THREADS, else as many as the machine has cores
  int lanes = 0;        ///< 0: the fastest for this build, or scalars for a single world; else 1, 4, 8 or 16
};

/// Bits of `Batch::flags`.
struct BatchFlag {
  static constexpr std::uint8_t kNotFinite =
      1;                                    ///< or made motion from nothing: stands still where it was, until reset
  static constexpr std::uint8_t kDeep = 2;  ///< penetration beyond kDeepPenetration in the last call of `step`
  static constexpr std::uint8_t kUnsettled = 4;  ///< in the last call of `step` contacts were left as kUnsettledChange
};

/// What counts as a deep penetration [m].
inline constexpr double kDeepPenetration = 0.01;
/// The last iteration of a step changed a contact's velocity by more than this [m/s]: float and few iterations do not
/// do for what is stacked high, or for what is heavy on what is light. Iterate more (`set_solver`), or use a World.
inline constexpr double kUnsettledChange = 0.05;

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

  Batch(Batch&&) noexcept;
  Batch& operator=(Batch&&) noexcept;
  ~Batch();

  /// Advances all worlds by n steps. A world whose numbers stop being finite stays as it was before that step.
  void step(int n = 1);

  [[nodiscard]] const Model& model() const;
  [[nodiscard]] std::shared_ptr<const Model> shared_model() const;
  [[nodiscard]] int num_worlds() const;
  [[nodiscard]] int lanes() const;
  [[nodiscard]] int num_threads() const;
  [[nodiscard]] double time_step() const;
  [[nodiscard]] std::vector<double> time() const;  ///< (n) [s] since each world began
  [[nodiscard]] const SolverSettings& solver() const;
  /// Throws std::invalid_argument unless max_iterations is 1 or more and the tolerance 0 or more.
  void set_solver(const SolverSettings& settings);

  // ---- state ---------------------------------------------------------------------------------------------------
  [[nodiscard]] std::vector<float> q() const;     ///< (n, nq)
  [[nodiscard]] std::vector<float> v() const;     ///< (n, nv)
  [[nodiscard]] std::vector<float> tau() const;   ///< (n, nv) [N m or N]
  [[nodiscard]] std::vector<float> ctrl() const;  ///< (n, nu)
  [[nodiscard]] std::vector<float> act() const;   ///< (n, na)
  /// Poses of the model's mocap bodies, in its order: x y z [m] and quaternion xyzw each, (n, mocap bodies, 7).
  [[nodiscard]] std::vector<float> mocap() const;
  void set_q(std::span<const float> q, std::span<const std::uint8_t> mask = {});
  void set_v(std::span<const float> v, std::span<const std::uint8_t> mask = {});
  void set_tau(std::span<const float> tau, std::span<const std::uint8_t> mask = {});
  void set_ctrl(std::span<const float> ctrl, std::span<const std::uint8_t> mask = {});
  void set_act(std::span<const float> act, std::span<const std::uint8_t> mask = {});
  void set_motors(const BatchMotors& commands);
  /// Back to the start, parameters kept.
  void reset(std::span<const std::uint8_t> mask = {});

  /// All that each world continues from, bit for bit, as bytes (see snapshot.h): state, contact memory, commands,
  /// forces applied, parameters and clock; not the solver's settings. Lanes and threads may differ where it is
  /// restored.
  [[nodiscard]] std::vector<std::uint8_t> snapshot() const;
  /// Throws std::invalid_argument if the snapshot is not of a batch of this size, model and time step, or holds numbers
  /// that cannot be; then nothing has changed.
  void restore(std::span<const std::uint8_t> snapshot, std::span<const std::uint8_t> mask = {});
  /// The whole batch for another process of the same build: its model, settings of the solver and snapshot.
  [[nodiscard]] std::vector<std::uint8_t> archived() const;
  /// A batch that goes on with the same bits, in lanes that this build has. Throws std::invalid_argument on damaged
  /// bytes.
  [[nodiscard]] static Batch unarchived(std::span<const std::uint8_t> bytes);
  /// FNV-1a over the bits of what a snapshot holds of each world, in order.
  [[nodiscard]] std::uint64_t state_hash() const;
  [[nodiscard]] std::span<const std::uint8_t> flags() const;  ///< (n) see BatchFlag

  // ---- bodies: links and frames by name ------------------------------------------------------------------------
  /// In the world: position (n, 3) [m] and quaternion xyzw (n, 4).
  void body_pose(std::string_view name, std::span<float> position, std::span<float> quaternion);
  /// Angular (n, 3) [rad/s], and that of the origin (n, 3) [m/s], in world axes.
  void body_velocity(std::string_view name, std::span<float> omega, std::span<float> velocity);
  /// Puts a body that a mocap joint carries at position (n, 3) [m] and quaternion xyzw (n, 4): see World::set_mocap.
  void set_mocap(std::string_view link, std::span<const float> position, std::span<const float> quaternion,
                 std::span<const std::uint8_t> mask = {});
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

  // ---- parameters of each world, see NamedParameters: values (n), or as said --------------------------------------
  void set_gravity(std::span<const float> gravity);                        ///< (n, 3) [m/s^2]
  void set_mass(std::string_view link, std::span<const float> mass);       ///< [kg]; scales the inertia with it
  void set_friction(std::string_view name, std::span<const float> value);  ///< of a geom, or of a link's geoms
  void set_spinning_friction(std::string_view name, std::span<const float> value);
  void set_rolling_friction(std::string_view name, std::span<const float> value);
  void set_restitution(std::string_view name, std::span<const float> value);
  void set_damping(std::string_view joint, std::span<const float> value);
  void set_stiffness(std::string_view joint, std::span<const float> value);
  void set_joint_friction(std::string_view joint, std::span<const float> value);
  void set_armature(std::string_view joint, std::span<const float> value);
  void set_geom_size(std::string_view geom, std::span<const float> size);  ///< (n, 3), see Shape [m]
  void set_gains(std::string_view actuator, std::span<const float> kp, std::span<const float> kd);

 private:
  struct Impl;

  std::unique_ptr<Impl> impl_;
};

}  // namespace manyhands
