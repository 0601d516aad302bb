// The dynamics over rows of states: what scripts and tests call, in lanes where the numbers are float.
#pragma once

#include <memory>
#include <span>

#include "manyhands/model/model.h"
#include "manyhands/physics/dynamics/jacobian_form.h"

namespace manyhands {

namespace internal {
template <Real R>
class RowKernel;
}

/// The algorithms of one model over n independent rows. Arrays are row-major, (n, ...); units, frames and joint
/// coordinates are the model's: q (n, nq) with unit quaternions, v, a and tau (n, nv).
///
/// R = double runs the reference. R = float runs blocks of `width` rows in lanes, the last block padded; every width
/// gives the same bits. A row that holds NaN or infinity spoils its own results only. All scratch is allocated by the
/// constructor. Calls use the scratch: one object per thread. Every function throws std::invalid_argument, naming the
/// array, if a length is wrong.
template <Real R>
class BatchDynamics {
 public:
  /// `width`: rows at once, 1 or what for_width.h finds; 0 takes the fastest of this build. For double only 0 and 1
  /// exist. Throws std::invalid_argument on any other.
  explicit BatchDynamics(const Model& model, int width = 0);
  ~BatchDynamics();
  BatchDynamics(BatchDynamics&&) noexcept;
  BatchDynamics& operator=(BatchDynamics&&) noexcept;

  /// Inverse dynamics, Featherstone 2008 table 5.1: tau (n, nv) = M a + C v + g [N m or N], with armature, without
  /// damping.
  void rnea(std::size_t n, std::span<const R> q, std::span<const R> v, std::span<const R> a, std::span<R> tau);
  /// Forward dynamics, Featherstone 2008 table 7.1: a (n, nv) = M^-1 (tau - C v - g), with armature, without damping.
  void aba(std::size_t n, std::span<const R> q, std::span<const R> v, std::span<const R> tau, std::span<R> a);
  /// Joint-space inertia, Featherstone 2008 table 6.2: M (n, nv, nv), symmetric, armature on its diagonal.
  void crba(std::size_t n, std::span<const R> q, std::span<R> M);

  /// Pose of a frame in the world: position (n, 3) [m] and quaternion xyzw (n, 4).
  void frame_pose(std::size_t n, std::span<const R> q, FrameId frame, std::span<R> position, std::span<R> quaternion);
  /// Poses of all frames of the model, links first, in the world: position (n, nf, 3) [m], quaternion xyzw (n, nf, 4).
  void forward_kinematics(std::size_t n, std::span<const R> q, std::span<R> position, std::span<R> quaternion);
  /// J (n, 6, nv) of a frame: J v is its spatial velocity in the form that is asked for.
  void jacobian(std::size_t n, std::span<const R> q, FrameId frame, std::span<R> J,
                JacobianForm form = JacobianForm::kMixed);
  /// dJ/dt (n, 6, nv) of the same at the velocity v (n, nv).
  void jacobian_derivative(std::size_t n, std::span<const R> q, std::span<const R> v, FrameId frame, std::span<R> dJ,
                           JacobianForm form = JacobianForm::kMixed);

  /// Centre of mass of all moving bodies in the world, (n, 3) [m].
  void center_of_mass(std::size_t n, std::span<const R> q, std::span<R> com);
  /// Momentum of all moving bodies about the world's origin, (n, 6): angular [kg m^2/s], linear [kg m/s].
  void momentum(std::size_t n, std::span<const R> q, std::span<const R> v, std::span<R> momentum);
  /// Kinetic (rotors included) and potential energy (0 at the world's origin), (n) each [J].
  void energy(std::size_t n, std::span<const R> q, std::span<const R> v, std::span<R> kinetic, std::span<R> potential);

  [[nodiscard]] int width() const;  ///< rows that run at once

 private:
  [[nodiscard]] const Frame& frame_of(FrameId frame) const;

  std::size_t nq_, nv_;
  std::vector<Frame> frames_;
  std::unique_ptr<internal::RowKernel<R>> kernel_;
};

}  // namespace manyhands
