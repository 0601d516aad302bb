// One world in double precision, for scripting and tests: a state, what drives it, and its clock.
#pragma once

#include <cstdint>
#include <memory>

#include "manyhands/physics/dynamics/energy.h"
#include "manyhands/physics/step/runge_kutta.h"

namespace manyhands {

enum class Integrator {
  kSemiImplicit,  ///< first order, implicit damping, motors and limits
  kRungeKutta4,   ///< fourth order, without motors and limits
};

/// Motor commands, one number per dof (nv) each; see `World::set_motors`.
struct MotorCommands {
  std::span<const double> target_q;  ///< [rad or m]; read for dofs with one coordinate, not for rotations by quaternion
  std::span<const double> target_v;  ///< [rad/s or m/s]
  std::span<const double> kp;        ///< share of the position error that one step removes
  std::span<const double> kd;        ///< share of the velocity error that one step removes
  std::span<const double> max_force;  ///< [N m or N]; 0 switches the motor off
};

/// A model in motion. Arrays are copied in and out; setters throw std::invalid_argument if a length is not what the
/// model asks for, a number is not finite, or a quaternion not of unit length (to 1e-6; it is normalised).
class World {
 public:
  /// Starts at rest in the neutral configuration, with motors off. Throws std::invalid_argument unless time_step > 0.
  explicit World(std::shared_ptr<const Model> model, double time_step = 0.002,
                 Integrator integrator = Integrator::kSemiImplicit);

  /// Advances by n steps. With kRungeKutta4 throws std::runtime_error if a motor is on, or if a joint with limits lies
  /// outside them before or after a step: this integrator would ignore both. The state stays as it was before that
  /// step.
  void step(int n = 1);

  [[nodiscard]] const Model& model() const { return *model_; }
  [[nodiscard]] double time_step() const { return time_step_; }
  [[nodiscard]] Integrator integrator() const { return integrator_; }
  [[nodiscard]] double time() const { return static_cast<double>(steps_) * time_step_; }  ///< [s]

  [[nodiscard]] std::span<const double> q() const { return {state_.q(), nq_}; }      ///< (nq)
  [[nodiscard]] std::span<const double> v() const { return {state_.v(), nv_}; }      ///< (nv)
  [[nodiscard]] std::span<const double> tau() const { return {state_.tau(), nv_}; }  ///< (nv) [N m or N]
  void set_q(std::span<const double> q);
  void set_v(std::span<const double> v);
  void set_tau(std::span<const double> tau);  ///< acts in every step until it is set again

  /// Motors at the velocity level, as PyBullet's: per step a dof is driven towards the velocity
  /// kp (target_q - q) / h + v' + kd (target_v - v') with at most max_force, where v' is what it would reach without.
  void set_motors(const MotorCommands& commands);

  [[nodiscard]] Energy<double> energy() const;                   ///< [J]
  [[nodiscard]] MassProperties<double> mass_properties() const;  ///< centre of mass, momentum about the world's origin

  /// All that a run continues from, bit for bit: state, motor gains and clock, as plain numbers.
  [[nodiscard]] std::vector<double> snapshot() const;
  /// Throws std::invalid_argument if the snapshot has not the length of this model's.
  void restore(std::span<const double> snapshot);
  /// FNV-1a of the snapshot's bytes.
  [[nodiscard]] std::uint64_t state_hash() const;

 private:
  void runge_kutta_step_or_throw();
  void require_within_limits(const char* when) const;

  std::shared_ptr<const Model> model_;
  double time_step_;
  Integrator integrator_;
  std::size_t nq_, nv_;
  std::int64_t steps_ = 0;
  System<double> system_;
  Params<double> params_;
  State<double> state_, before_;
  StepWorkspace<double> step_;
  RungeKutta<double> runge_kutta_;
  mutable Workspace<double> scratch_;  // of energy and mass_properties
};

}  // namespace manyhands
