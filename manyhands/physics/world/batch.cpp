#include "manyhands/physics/world/batch.h"

#include <algorithm>

#include "manyhands/base/hash.h"
#include "manyhands/math/for_width.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/physics/world/world_checks.h"

namespace manyhands {

namespace {

constexpr int kMaxWorlds = 1 << 20;

std::unique_ptr<BatchLanes> make_lanes(const Model& model, int num_worlds, double time_step, int lanes, int workers) {
  if (lanes == 0) lanes = num_worlds == 1 ? 1 : width_v<NativeLanes>;
  const auto make = for_width("lanes", lanes, []<class T>() { return &make_batch_lanes<T>; });
  return make(model, num_worlds, static_cast<float>(time_step), workers);
}

std::shared_ptr<const Model> checked(std::shared_ptr<const Model> model, int num_worlds, double time_step,
                                     const BatchOptions& options) {
  if (model == nullptr) throw std::invalid_argument("a batch needs a model; got none");
  if (num_worlds < 1 || num_worlds > kMaxWorlds) {
    throw std::invalid_argument("the number of worlds is " + std::to_string(num_worlds) + "; expected 1 to " +
                                std::to_string(kMaxWorlds));
  }
  internal::require_time_step(time_step);
  if (!(static_cast<float>(time_step) > 0)) throw std::invalid_argument("time_step is too small for float");
  constexpr int kMaxThreads = 1024;
  if (options.num_threads < 0 || options.num_threads > kMaxThreads) {
    throw std::invalid_argument("num_threads is " + std::to_string(options.num_threads) + "; expected 0 to 1024");
  }
  return model;
}

}  // namespace

Batch::Batch(std::shared_ptr<const Model> model, int num_worlds, double time_step, const BatchOptions& options)
    : model_(checked(std::move(model), num_worlds, time_step, options)),
      num_worlds_(num_worlds),
      time_step_(time_step),
      pool_(std::min(choose_num_threads(options.num_threads), num_worlds)),
      steps_(static_cast<std::size_t>(num_worlds)),
      flags_(steps_.size()),
      layout_(*model_, 0),
      pose_(12 * steps_.size()),
      velocity_(6 * steps_.size()) {
  lanes_ = make_lanes(*model_, num_worlds, time_step, options.lanes, pool_.num_threads());
  const Strided<float> state = lanes_->state(0);
  for (std::size_t i = 0; i < state.size(); ++i) start_.push_back(state[i]);
}

void Batch::step(int n) {
  if (n < 0) throw std::invalid_argument("the number of steps is " + std::to_string(n) + "; expected 0 or more");
  if (n == 0) return;
  lanes_->step(n, pool_);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const BatchExtras extras = lanes_->extras(i);
    steps_[i] += static_cast<std::int64_t>(extras.advanced);
    const bool deep = extras.deepest > static_cast<float>(kDeepPenetration);
    flags_[i] =
        static_cast<std::uint8_t>((extras.frozen > 0 ? BatchFlag::kNotFinite : 0) | (deep ? BatchFlag::kDeep : 0));
  }
}

std::vector<double> Batch::time() const {
  std::vector<double> result;
  result.reserve(steps_.size());
  for (const std::int64_t steps : steps_) result.push_back(static_cast<double>(steps) * time_step_);
  return result;
}

void Batch::set_solver(const SolverSettings& settings) {
  internal::require_solver(settings);
  lanes_->set_solver(settings);
}

// ---- state -------------------------------------------------------------------------------------------------------

Batch::Range Batch::range(Part part) const {
  const auto nq = static_cast<std::size_t>(model_->nq()), nv = static_cast<std::size_t>(model_->nv());
  const auto at = [&](const float* first, std::size_t count) {
    return Range{static_cast<std::size_t>(first - layout_.q()), count};
  };
  switch (part) {
    case Part::kQ:
      return at(layout_.q(), nq);
    case Part::kV:
      return at(layout_.v(), nv);
    case Part::kTau:
      return at(layout_.tau(), nv);
    case Part::kTargetQ:
      return at(layout_.target_q(), nv);
    case Part::kTargetV:
      return at(layout_.target_v(), nv);
    default:
      return at(layout_.ctrl(), static_cast<std::size_t>(model_->nu()));
  }
}

std::vector<float> Batch::rows(Part part) const {
  const auto [first, count] = range(part);
  std::vector<float> result;
  result.reserve(count * steps_.size());
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const Strided<float> state = lanes_->state(i);
    for (std::size_t k = 0; k < count; ++k) result.push_back(state[first + k]);
  }
  return result;
}

std::vector<float> Batch::q() const { return rows(Part::kQ); }
std::vector<float> Batch::v() const { return rows(Part::kV); }
std::vector<float> Batch::tau() const { return rows(Part::kTau); }
std::vector<float> Batch::ctrl() const { return rows(Part::kCtrl); }

void Batch::require_rows(const std::string& name, std::span<const float> values, std::size_t columns) const {
  if (values.size() != columns * steps_.size()) {
    throw std::invalid_argument(name + " has " + std::to_string(values.size()) + " numbers; expected " +
                                std::to_string(num_worlds_) + " rows of " + std::to_string(columns));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (is_finite(values[i])) continue;
    throw std::invalid_argument(name + " of world " + std::to_string(i / columns) + " has a number at " +
                                std::to_string(i % columns) + " that is not finite");
  }
}

void Batch::require_mask(std::span<const std::uint8_t> mask) const {
  if (mask.empty() || mask.size() == steps_.size()) return;
  throw std::invalid_argument("the mask has " + std::to_string(mask.size()) + " numbers; expected " +
                              std::to_string(num_worlds_));
}

void Batch::set_rows(Part part, std::span<const float> values, std::span<const std::uint8_t> mask) {
  const auto [first, count] = range(part);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    if (!chosen(mask, i)) continue;
    const Strided<float> state = lanes_->state(i);
    for (std::size_t k = 0; k < count; ++k) state[first + k] = values[i * count + k];
  }
}

void Batch::set_q(std::span<const float> q, std::span<const std::uint8_t> mask) {
  require_mask(mask);
  const auto nq = static_cast<std::size_t>(model_->nq());
  require_rows("q", q, nq);
  std::vector<float> rows(q.begin(), q.end());
  for (const Body& body : model_->bodies()) {
    if (body.type != JointType::kSpherical && body.type != JointType::kFloating) continue;
    const auto offset = static_cast<std::size_t>(body.iq + (body.type == JointType::kFloating ? 3 : 0));
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      float* r = &rows[i * nq + offset];
      const float length = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
      if (chosen(mask, i) && !(abs(length - 1) <= 1e-5f)) {
        throw std::invalid_argument("the quaternion at q[" + std::to_string(i) + ", " + std::to_string(offset) +
                                    "] has length " + std::to_string(length) + "; expected 1 (order x, y, z, w)");
      }
      for (int k = 0; k < 4; ++k) r[k] /= length;
    }
  }
  set_rows(Part::kQ, rows, mask);
}

void Batch::set_v(std::span<const float> v, std::span<const std::uint8_t> mask) {
  require_mask(mask);
  require_rows("v", v, static_cast<std::size_t>(model_->nv()));
  set_rows(Part::kV, v, mask);
}

void Batch::set_tau(std::span<const float> tau, std::span<const std::uint8_t> mask) {
  require_mask(mask);
  require_rows("tau", tau, static_cast<std::size_t>(model_->nv()));
  set_rows(Part::kTau, tau, mask);
}

void Batch::set_ctrl(std::span<const float> ctrl, std::span<const std::uint8_t> mask) {
  require_mask(mask);
  const auto nu = static_cast<std::size_t>(model_->nu());
  require_rows("ctrl", ctrl, nu);
  std::vector<float> rows(ctrl.begin(), ctrl.end());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Actuator& actuator = model_->actuators()[i % nu];
    rows[i] = clamp(rows[i], static_cast<float>(actuator.min_ctrl), static_cast<float>(actuator.max_ctrl));
  }
  set_rows(Part::kCtrl, rows, mask);
}

void Batch::set_motors(const BatchMotors& commands) {
  const auto nv = static_cast<std::size_t>(model_->nv());
  require_rows("target_q", commands.target_q, nv);
  require_rows("target_v", commands.target_v, nv);
  require_rows("kp", commands.kp, nv);
  require_rows("kd", commands.kd, nv);
  require_rows("max_force", commands.max_force, nv);
  internal::require_not_negative("kp", commands.kp);
  internal::require_not_negative("kd", commands.kd);
  internal::require_not_negative("max_force", commands.max_force);
  for (std::size_t i = 0; i < steps_.size() && nv > 0; ++i) {
    require_undriven(*model_, commands.max_force.subspan(i * nv, nv));
  }
  set_rows(Part::kTargetQ, commands.target_q, {});
  set_rows(Part::kTargetV, commands.target_v, {});
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const ParamsView<float> params = lanes_->params(i);
    for (std::size_t k = 0; k < nv; ++k) {
      params.motor_kp[k] = commands.kp[i * nv + k];
      params.motor_kd[k] = commands.kd[i * nv + k];
      params.motor_max_force[k] = commands.max_force[i * nv + k];
    }
  }
}

void Batch::forget_step(std::size_t world) {
  const BatchExtras extras = lanes_->extras(world);
  for (std::size_t k = 0; k < extras.wrench.size(); ++k) extras.wrench[k] = 0;
  extras.contacts = extras.penetration = extras.deepest = extras.frozen = 0;
  flags_[world] = 0;
}

void Batch::reset(std::span<const std::uint8_t> mask) {
  require_mask(mask);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    if (!chosen(mask, i)) continue;
    const Strided<float> state = lanes_->state(i);
    for (std::size_t k = 0; k < start_.size(); ++k) state[k] = start_[k];
    const BatchExtras extras = lanes_->extras(i);
    for (std::size_t k = 0; k < extras.external.size(); ++k) extras.external[k] = 0;
    extras.pushed = 0;
    steps_[i] = 0;
    forget_step(i);
  }
}

namespace {

/// Calls visit(number) for every number of a world's snapshot but its clock.
template <class Visit>
void visit_world(BatchLanes& lanes, std::size_t world, Visit&& visit) {
  const auto all = [&](const Strided<float>& numbers) {
    for (std::size_t k = 0; k < numbers.size(); ++k) visit(numbers[k]);
  };
  const BatchExtras extras = lanes.extras(world);
  all(lanes.state(world));
  all(extras.link_mass);
  all(extras.external);
  visit(extras.pushed);
  visit(extras.frozen);
  lanes.params(world).for_each(all);
}

/// A count of steps in two numbers, exact where one float would not be.
constexpr std::int64_t kClockUnit = 1 << 20;

}  // namespace

std::size_t Batch::snapshot_size() const {
  std::size_t size = 2;
  visit_world(*lanes_, 0, [&](float&) { ++size; });
  return size;
}

std::vector<float> Batch::snapshot() const {
  std::vector<float> numbers;
  numbers.reserve(snapshot_size() * steps_.size());
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const auto units = steps_[i] / kClockUnit, rest = steps_[i] % kClockUnit;
    numbers.push_back(static_cast<float>(units));
    numbers.push_back(static_cast<float>(rest));
    visit_world(*lanes_, i, [&](const float& number) { numbers.push_back(number); });
  }
  return numbers;
}

void Batch::restore(std::span<const float> snapshot, std::span<const std::uint8_t> mask) {
  require_mask(mask);
  const std::size_t size = snapshot_size();
  if (snapshot.size() != size * steps_.size()) {
    throw std::invalid_argument("the snapshot has " + std::to_string(snapshot.size()) + " numbers; expected " +
                                std::to_string(num_worlds_) + " rows of " + std::to_string(size) +
                                ": is it of another model?");
  }
  if (std::ranges::any_of(snapshot, [](float x) { return x != x; })) {
    throw std::invalid_argument("the snapshot holds a NaN");
  }
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    if (!chosen(mask, i)) continue;
    const float* next = &snapshot[i * size];
    forget_step(i);
    steps_[i] = static_cast<std::int64_t>(next[0]) * kClockUnit + static_cast<std::int64_t>(next[1]);
    next += 2;
    visit_world(*lanes_, i, [&](float& number) { number = *next++; });
    if (lanes_->extras(i).frozen > 0) flags_[i] = BatchFlag::kNotFinite;
    let_resist_turning(lanes_->params(i), lanes_->colliders());
  }
}

std::uint64_t Batch::state_hash() const {
  Hash hash;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    hash.add(steps_[i]);
    visit_world(*lanes_, i, [&](const float& number) { hash.add(number); });
  }
  return hash.value();
}

}  // namespace manyhands
