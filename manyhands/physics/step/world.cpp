#include "manyhands/physics/step/world.h"

#include <algorithm>

#include "manyhands/base/hash.h"

namespace manyhands {

namespace {

std::shared_ptr<const Model> required(std::shared_ptr<const Model> model) {
  if (model == nullptr) throw std::invalid_argument("a world needs a model; got none");
  return model;
}

void require_numbers(const std::string& name, std::span<const double> values, std::size_t size) {
  if (values.size() != size) {
    throw std::invalid_argument(name + " has shape (" + std::to_string(values.size()) + ",); expected (" +
                                std::to_string(size) + ",)");
  }
  for (std::size_t i = 0; i < size; ++i) {
    if (!is_finite(values[i])) throw std::invalid_argument(name + "[" + std::to_string(i) + "] is not a finite number");
  }
}

void require_not_negative(const std::string& name, std::span<const double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] < 0)
      throw std::invalid_argument(name + "[" + std::to_string(i) + "] is negative; expected 0 or more");
  }
}

}  // namespace

World::World(std::shared_ptr<const Model> model, double time_step, Integrator integrator)
    : model_(required(std::move(model))),
      time_step_(time_step),
      integrator_(integrator),
      nq_(static_cast<std::size_t>(model_->nq())),
      nv_(static_cast<std::size_t>(model_->nv())),
      system_(*model_),
      params_(*model_),
      state_(*model_, system_.contact_numbers()),
      before_(state_),
      step_(system_),
      runge_kutta_(system_.tree),
      scratch_(system_.tree) {
  if (!(time_step > 0) || !is_finite(time_step)) {
    throw std::invalid_argument("time_step is " + std::to_string(time_step) + " s; expected a number above 0");
  }
}

void World::step(int n) {
  if (n < 0) throw std::invalid_argument("the number of steps is " + std::to_string(n) + "; expected 0 or more");
  for (int i = 0; i < n; ++i) {
    if (integrator_ == Integrator::kRungeKutta4) {
      runge_kutta_step_or_throw();
    } else {
      manyhands::step(system_, params_, time_step_, state_, step_);
    }
    ++steps_;
  }
}

void World::require_within_limits(const char* when) const {
  for (std::size_t i = 0; i < nv_; ++i) {
    if (!system_.tree.dof_limited[i]) continue;
    const double q = state_.q()[system_.tree.dof_q[i]];
    if (q >= params_.lower[i] && q <= params_.upper[i]) continue;
    const std::string& joint = model_->joint(JointId(model_->dof_joint()[i])).name;
    throw std::runtime_error("the rk4 integrator knows no joint limits, but joint '" + joint + "' is outside its own " +
                             when + " the step at " + std::to_string(time()) + " s: use semi_implicit");
  }
}

void World::runge_kutta_step_or_throw() {
  if (std::ranges::any_of(params_.motor_max_force, [](double force) { return force > 0; })) {
    throw std::runtime_error("the rk4 integrator knows no motors: set their max_force to 0, or use semi_implicit");
  }
  require_within_limits("before");
  before_ = state_;
  runge_kutta_step(system_.tree, params_, time_step_, state_, runge_kutta_);
  try {
    require_within_limits("after");
  } catch (const std::runtime_error&) {
    state_ = before_;
    throw;
  }
}

void World::set_q(std::span<const double> q) {
  require_numbers("q", q, nq_);
  std::vector<double> checked(q.begin(), q.end());
  for (const TreeBody<double>& body : system_.tree.bodies) {
    if (body.type != JointType::kSpherical && body.type != JointType::kFloating) continue;
    double* r = &checked[static_cast<std::size_t>(body.iq + (body.type == JointType::kFloating ? 3 : 0))];
    const double length = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
    if (!(abs(length - 1) <= 1e-6)) {
      throw std::invalid_argument("the quaternion at q[" + std::to_string(r - checked.data()) + "] has length " +
                                  std::to_string(length) + "; expected 1 (order x, y, z, w)");
    }
    for (int k = 0; k < 4; ++k) r[k] /= length;
  }
  std::ranges::copy(checked, state_.q());
}

void World::set_v(std::span<const double> v) {
  require_numbers("v", v, nv_);
  std::ranges::copy(v, state_.v());
}

void World::set_tau(std::span<const double> tau) {
  require_numbers("tau", tau, nv_);
  std::ranges::copy(tau, state_.tau());
}

void World::set_motors(const MotorCommands& commands) {
  require_numbers("target_q", commands.target_q, nv_);
  require_numbers("target_v", commands.target_v, nv_);
  require_numbers("kp", commands.kp, nv_);
  require_numbers("kd", commands.kd, nv_);
  require_numbers("max_force", commands.max_force, nv_);
  require_not_negative("kp", commands.kp);
  require_not_negative("kd", commands.kd);
  require_not_negative("max_force", commands.max_force);
  std::ranges::copy(commands.target_q, state_.target_q());
  std::ranges::copy(commands.target_v, state_.target_v());
  std::ranges::copy(commands.kp, params_.motor_kp.begin());
  std::ranges::copy(commands.kd, params_.motor_kd.begin());
  std::ranges::copy(commands.max_force, params_.motor_max_force.begin());
}

Energy<double> World::energy() const {
  return manyhands::energy(system_.tree, params_, state_.q(), state_.v(), scratch_);
}

MassProperties<double> World::mass_properties() const {
  return manyhands::mass_properties(system_.tree, params_, state_.q(), state_.v(), scratch_);
}

std::vector<double> World::snapshot() const {
  std::vector<double> numbers{time_step_, static_cast<double>(steps_)};
  numbers.insert(numbers.end(), state_.numbers().begin(), state_.numbers().end());
  for (const auto* gains : {&params_.motor_kp, &params_.motor_kd, &params_.motor_max_force}) {
    numbers.insert(numbers.end(), gains->begin(), gains->end());
  }
  return numbers;
}

void World::restore(std::span<const double> snapshot) {
  const std::size_t state_size = state_.numbers().size();
  const std::size_t expected = 2 + state_size + 3 * nv_;
  if (snapshot.size() != expected) {
    throw std::invalid_argument("the snapshot holds " + std::to_string(snapshot.size()) +
                                " numbers; this world's hold " + std::to_string(expected) +
                                ": is it of another model?");
  }
  if (snapshot[0] != time_step_) {
    throw std::invalid_argument("the snapshot is of a world with a time_step of " + std::to_string(snapshot[0]) +
                                " s; this world's is " + std::to_string(time_step_) + " s");
  }
  require_numbers("the snapshot", snapshot, expected);
  steps_ = static_cast<std::int64_t>(snapshot[1]);
  std::ranges::copy(snapshot.subspan(2, state_size), state_.numbers().begin());
  const double* gains = snapshot.data() + 2 + state_size;
  for (auto* to : {&params_.motor_kp, &params_.motor_kd, &params_.motor_max_force}) {
    std::copy_n(gains, nv_, to->begin());
    gains += nv_;
  }
}

std::uint64_t World::state_hash() const {
  Hash hash;
  for (const double number : snapshot()) hash.add(number);
  return hash.value();
}

}  // namespace manyhands
