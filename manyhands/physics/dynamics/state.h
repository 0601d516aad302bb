// The minimum from which a run continues bit for bit.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "manyhands/physics/dynamics/tree.h"

namespace manyhands {

/// The one list of what State holds: array(name, one for each, range), whose getter gives a pointer, or list(...),
/// whose getter gives a span. Views, snapshots, hashes and what a World carries over to other parts all follow it. A
/// step changes what stands before the equality constraints, and rebuilds the rest.
// clang-format off
#define MANYHANDS_STATE_FIELDS(array, list)                                                                           \
  array(q,                kCoordinate,    kFinite) /* configuration */                                                \
  array(v,                kDof,           kFinite) /* velocity */                                                     \
  array(tau,              kDof,           kFinite) /* applied joint force [N m or N] */                               \
  array(target_q,         kDof,           kFinite) /* motor target [rad or m] */                                      \
  array(target_v,         kDof,           kFinite) /* motor target [rad/s or m/s] */                                  \
  array(ctrl,             kActuator,      kFinite) /* commands of the actuators */                                    \
  array(act,              kActivation,    kFinite) /* what becomes of commands, see Activation */                      \
  array(mocap,            kMocapNumber,   kFinite) /* poses of the bodies that a user moves */                         \
  array(q_rest,           kCoordinate,    kFinite) /* what q has no room for in single precision, see accumulate */    \
  array(active_set,       kDof,           kFinite) /* where each dof is on its force law, see JointConstraintState */   \
  array(dv,               kDof,           kFinite) /* change of v in the last step: a hint to the next */             \
  array(joint_impulse,    kDof,           kFinite) /* impulse of motor and limit in the last step */                  \
  array(calm,             kWorld,         kNotNegative) /* steps to come in which constraints demand nothing */       \
  list(equality_impulses, kEqualityRow,   kFinite) /* warm start */                                                   \
  list(contact_cache,    kContactNumber, kFinite) /* see CachedManifold */
// clang-format on

/// One world's State: the numbers of a lane.
template <Real R>
struct StateView {
#define MANYHANDS_FIELD(name, each, range) Strided<R> name;
  MANYHANDS_STATE_FIELDS(MANYHANDS_FIELD, MANYHANDS_FIELD)
#undef MANYHANDS_FIELD

  template <class Visit, class... Views>
  static void visit_fields(Visit&& visit, Views&... views) {
#define MANYHANDS_FIELD(name, each, range) visit(FieldInfo{#name, Each::each, Range::range}, views.name...);
    MANYHANDS_STATE_FIELDS(MANYHANDS_FIELD, MANYHANDS_FIELD)
#undef MANYHANDS_FIELD
  }
};

/// One world, or one block of worlds if T is lanes. A view: the numbers lie in the memory of a WorldBlock or a
/// StateStorage.
template <Number T>
class State {
 public:
  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;

#define MANYHANDS_ARRAY(name, each, range)           \
  [[nodiscard]] T* name() { return name##_.data(); } \
  [[nodiscard]] const T* name() const { return name##_.data(); }
#define MANYHANDS_LIST(name, each, range)                                        \
  [[nodiscard]] std::span<T> name() { return {name##_.data(), name##_.size()}; } \
  [[nodiscard]] std::span<const T> name() const { return {name##_.data(), name##_.size()}; }
  MANYHANDS_STATE_FIELDS(MANYHANDS_ARRAY, MANYHANDS_LIST)
#undef MANYHANDS_ARRAY
#undef MANYHANDS_LIST

  /// Calls visit(info, field of each of `states`...) for every field, in the order of memory.
  template <class Visit, class... States>
  static void visit_fields(Visit&& visit, States&... states) {
#define MANYHANDS_FIELD(name, each, range) visit(FieldInfo{#name, Each::each, Range::range}, states.name##_...);
    MANYHANDS_STATE_FIELDS(MANYHANDS_FIELD, MANYHANDS_FIELD)
#undef MANYHANDS_FIELD
  }

  /// All fields in a row, but for a contact cache that grows.
  [[nodiscard]] std::span<T> numbers() { return {q(), size_}; }
  [[nodiscard]] std::span<const T> numbers() const { return {q(), size_}; }
  /// Those that a step changes, or that command it; the rest are warm starts that the next step can do without.
  [[nodiscard]] std::span<T> moved_numbers() { return {q(), equality_impulses_.data()}; }
  [[nodiscard]] std::span<const T> moved_numbers() const { return {q(), equality_impulses_.data()}; }

  /// Lets the fields lie from `memory` on; a contact cache that grows lies in `grown`. Returns where the fields end.
  T* place(const Layout& layout, T* memory, std::vector<T>& grown) {
    T* end = internal::place_fields(layout, memory, *this);
    size_ = static_cast<std::size_t>(end - memory);
    grown_ = &grown;
    if (!grown.empty()) contact_cache_ = {grown.data(), grown.size()};
    return end;
  }

  [[nodiscard]] StateView<real_t<T>> view(std::size_t lane) {
    return {
#define MANYHANDS_FIELD(name, each, range) .name = lane_of<T>(name##_, lane),
        MANYHANDS_STATE_FIELDS(MANYHANDS_FIELD, MANYHANDS_FIELD)
#undef MANYHANDS_FIELD
    };
  }

  /// Sets q to where the model's joints begin, and the bodies that a user moves to where the model has them.
  void take(const Model& model) {
    const std::vector<double> initial = model.initial_configuration();
    const auto number = [](double x) { return T(static_cast<real_t<T>>(x)); };
    std::ranges::transform(initial, q_.begin(), number);
    std::ranges::transform(model.initial_mocap(), mocap_.begin(), number);
  }

  /// Makes room for another number of contacts, of large worlds that list no pairs; the old ones are forgotten.
  void resize_contact_cache(std::size_t count) {
    grown_->assign(count, T(real_t<T>(0)));
    contact_cache_ = {grown_->data(), count};
  }

 private:
#define MANYHANDS_FIELD(name, each, range) Field<T> name##_;
  MANYHANDS_STATE_FIELDS(MANYHANDS_FIELD, MANYHANDS_FIELD)
#undef MANYHANDS_FIELD
  std::size_t size_ = 0;
  std::vector<T>* grown_ = nullptr;
};

/// A state that owns its memory.
template <Number T>
class StateStorage : public State<T> {
 public:
  /// `contact_numbers`: how many numbers the contact cache takes, which System::contact_numbers tells.
  StateStorage(const Model& model, std::size_t contact_numbers)
      : layout_(model, contact_numbers), memory_(internal::numbers_of<T>(layout_, state()), T(real_t<T>(0))) {
    this->place(layout_, memory_.data(), grown_);
    this->take(model);
  }
  StateStorage(const StateStorage& other)
      : State<T>(), layout_(other.layout_), memory_(other.memory_), grown_(other.grown_) {
    this->place(layout_, memory_.data(), grown_);
  }
  StateStorage& operator=(const StateStorage& other) {
    layout_ = other.layout_;
    memory_ = other.memory_;
    grown_ = other.grown_;
    this->place(layout_, memory_.data(), grown_);
    return *this;
  }

 private:
  [[nodiscard]] State<T>& state() { return *this; }

  Layout layout_;
  std::vector<T> memory_, grown_;
};

/// Copies lane `from_lane` of one state into lane `to_lane` of another of the same model.
template <Number T>
void copy_lane(const State<T>& from, int from_lane, State<T>& to, int to_lane) {
  for (std::size_t i = 0; i < from.numbers().size(); ++i) {
    set_lane(to.numbers()[i], to_lane, lane(from.numbers()[i], from_lane));
  }
}

}  // namespace manyhands
