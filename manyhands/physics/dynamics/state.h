// The minimum from which a run continues bit for bit.
#pragma once

#include <span>

#include "manyhands/physics/dynamics/tree.h"

namespace manyhands {

/// One world, or one block of worlds if T is lanes. Plain memory: copy it to save a world, compare or hash its numbers.
template <Number T>
class State {
 public:
  /// `contact_numbers`: how many numbers the memory of contacts takes, which System::contact_numbers tells.
  State(const Model& model, std::size_t contact_numbers)
      : nq_(static_cast<std::size_t>(model.nq())),
        nv_(static_cast<std::size_t>(model.nv())),
        nu_(static_cast<std::size_t>(model.nu())),
        nl_(equality_rows(model)),
        numbers_(nq_ + 7 * nv_ + nu_ + nl_ + contact_numbers, T(real_t<T>(0))) {
    const std::vector<double> initial = model.initial_configuration();
    for (std::size_t i = 0; i < nq_; ++i) numbers_[i] = T(static_cast<real_t<T>>(initial[i]));
  }

  [[nodiscard]] T* q() { return numbers_.data(); }            ///< (nq) configuration
  [[nodiscard]] T* v() { return q() + nq_; }                  ///< (nv) velocity
  [[nodiscard]] T* tau() { return v() + nv_; }                ///< (nv) applied joint force [N m or N]
  [[nodiscard]] T* target_q() { return tau() + nv_; }         ///< (nv) motor target [rad or m]
  [[nodiscard]] T* target_v() { return target_q() + nv_; }    ///< (nv) motor target [rad/s or m/s]
  [[nodiscard]] T* active_set() { return target_v() + nv_; }  ///< (nv) where each dof is on its force law
  [[nodiscard]] T* dv() { return active_set() + nv_; }        ///< (nv) change of v in the last step: a hint to the next
  [[nodiscard]] T* joint_impulse() { return dv() + nv_; }     ///< (nv) impulse of motor and limit in the last step
  [[nodiscard]] T* ctrl() { return joint_impulse() + nv_; }   ///< (nu) commands of the actuators
  [[nodiscard]] std::span<T> equality_impulses() {
    return numbers().subspan(nq_ + 7 * nv_ + nu_, nl_);
  }  ///< warm start: impulses
  [[nodiscard]] std::span<T> contact_cache() {
    return numbers().subspan(nq_ + 7 * nv_ + nu_ + nl_);
  }  ///< what they remember
  [[nodiscard]] const T* q() const { return numbers_.data(); }
  [[nodiscard]] const T* v() const { return q() + nq_; }
  [[nodiscard]] const T* tau() const { return v() + nv_; }
  [[nodiscard]] const T* target_q() const { return tau() + nv_; }
  [[nodiscard]] const T* target_v() const { return target_q() + nv_; }
  [[nodiscard]] const T* active_set() const { return target_v() + nv_; }
  [[nodiscard]] const T* dv() const { return active_set() + nv_; }
  [[nodiscard]] const T* joint_impulse() const { return dv() + nv_; }
  [[nodiscard]] const T* ctrl() const { return joint_impulse() + nv_; }

  [[nodiscard]] std::span<const T> contact_cache() const { return numbers().subspan(nq_ + 7 * nv_ + nu_ + nl_); }

  /// Makes room for other contacts; the old ones are forgotten.
  void resize_contact_cache(std::size_t count) {
    numbers_.resize(nq_ + 7 * nv_ + nu_ + nl_);
    numbers_.resize(nq_ + 7 * nv_ + nu_ + nl_ + count, T(real_t<T>(0)));
  }

  [[nodiscard]] std::span<T> numbers() { return numbers_; }
  [[nodiscard]] std::span<const T> numbers() const { return numbers_; }

 private:
  std::size_t nq_, nv_, nu_, nl_;
  std::vector<T>
      numbers_;  // q, v, tau, target_q, target_v, active_set, dv, joint_impulse, ctrl, equality_impulses, contact_cache
};

/// Copies lane `from_lane` of one state into lane `to_lane` of another of the same model.
template <Number T>
void copy_lane(const State<T>& from, int from_lane, State<T>& to, int to_lane) {
  for (std::size_t i = 0; i < from.numbers().size(); ++i) {
    set_lane(to.numbers()[i], to_lane, lane(from.numbers()[i], from_lane));
  }
}

}  // namespace manyhands
