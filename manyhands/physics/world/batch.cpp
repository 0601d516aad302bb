#include "manyhands/physics/world/batch.h"

#include <algorithm>

#include "manyhands/base/float_environment.h"
#include "manyhands/base/hash.h"
#include "manyhands/math/for_width.h"
#include "manyhands/physics/world/batch_impl.h"

namespace manyhands {

using internal::require_rows;

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

Batch::Impl::Impl(std::shared_ptr<const Model> shared_model, int n, double h, const BatchOptions& options)
    : model(checked(std::move(shared_model), n, h, options)),
      num_worlds(n),
      time_step(h),
      pool(std::min(choose_num_threads(options.num_threads), n)),
      steps(static_cast<std::size_t>(n)),
      flags(steps.size()),
      pose(12 * steps.size()),
      velocity(6 * steps.size()) {
  const FloatEnvironment floats;
  lanes = make_lanes(*model, n, h, options.lanes, pool.num_threads());
  const StateView<float> state = world(0).state;
  StateView<float>::visit_fields(
      [this](const FieldInfo&, const Strided<float>& field) {
        for (std::size_t k = 0; k < field.size(); ++k) start.push_back(field[k]);
      },
      state);
}

NamedParameters<float> Batch::Impl::parameters() {
  return {*model, lanes->colliders(), steps.size(), [this](std::size_t i) { return world(i); }};
}

void Batch::Impl::forget_step(std::size_t i) {
  const ExtrasView<float> extras = world(i).extras;
  ExtrasView<float>::visit_fields(
      [](const FieldInfo& info, const Strided<float>& field) {
        if (info.range != Range::kResult) return;
        for (std::size_t k = 0; k < field.size(); ++k) field[k] = 0;
      },
      extras);
  extras.frozen[0] = 0;
  flags[i] = 0;
}

void Batch::Impl::require_mask(Mask mask) const {
  if (mask.empty() || mask.size() == steps.size()) return;
  throw std::invalid_argument("the mask has " + std::to_string(mask.size()) + " numbers; expected " +
                              std::to_string(num_worlds));
}

std::vector<float> Batch::Impl::rows(StateField field) const {
  std::vector<float> result;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Strided<float> numbers = world(i).state.*field;
    for (std::size_t k = 0; k < numbers.size(); ++k) result.push_back(numbers[k]);
  }
  return result;
}

void Batch::Impl::set_rows(StateField field, std::span<const float> values, Mask mask) {
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!chosen(mask, i)) continue;
    const Strided<float> numbers = world(i).state.*field;
    for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = values[i * numbers.size() + k];
  }
}

Batch::Batch(std::shared_ptr<const Model> model, int num_worlds, double time_step, const BatchOptions& options)
    : impl_(std::make_unique<Impl>(std::move(model), num_worlds, time_step, options)) {}

Batch::Batch(Batch&&) noexcept = default;
Batch& Batch::operator=(Batch&&) noexcept = default;
Batch::~Batch() = default;

const Model& Batch::model() const { return *impl_->model; }
std::shared_ptr<const Model> Batch::shared_model() const { return impl_->model; }
int Batch::num_worlds() const { return impl_->num_worlds; }
int Batch::lanes() const { return impl_->lanes->width(); }
int Batch::num_threads() const { return impl_->pool.num_threads(); }
double Batch::time_step() const { return impl_->time_step; }
const SolverSettings& Batch::solver() const { return impl_->lanes->solver(); }
std::span<const std::uint8_t> Batch::flags() const { return impl_->flags; }

void Batch::step(int n) {
  if (n < 0) throw std::invalid_argument("the number of steps is " + std::to_string(n) + "; expected 0 or more");
  if (n == 0) return;
  const FloatEnvironment floats;
  impl_->lanes->step(n, impl_->pool);
  for (std::size_t i = 0; i < impl_->steps.size(); ++i) {
    const ExtrasView<float> extras = impl_->world(i).extras;
    impl_->steps[i] += static_cast<std::int64_t>(extras.advanced[0]);
    const auto flag = [](bool is_up, std::uint8_t bit) { return is_up ? bit : std::uint8_t{0}; };
    impl_->flags[i] = flag(extras.frozen[0] > 0, BatchFlag::kNotFinite) |
                      flag(extras.deepest[0] > static_cast<float>(kDeepPenetration), BatchFlag::kDeep) |
                      flag(extras.unsettled[0] > static_cast<float>(kUnsettledChange), BatchFlag::kUnsettled);
  }
}

std::vector<double> Batch::time() const {
  std::vector<double> result;
  result.reserve(impl_->steps.size());
  for (const std::int64_t steps : impl_->steps) result.push_back(static_cast<double>(steps) * impl_->time_step);
  return result;
}

void Batch::set_solver(const SolverSettings& settings) {
  internal::require_solver(settings);
  impl_->lanes->set_solver(settings);
}

// ---- state -------------------------------------------------------------------------------------------------------

std::vector<float> Batch::q() const { return impl_->rows(&StateView<float>::q); }
std::vector<float> Batch::v() const { return impl_->rows(&StateView<float>::v); }
std::vector<float> Batch::tau() const { return impl_->rows(&StateView<float>::tau); }
std::vector<float> Batch::ctrl() const { return impl_->rows(&StateView<float>::ctrl); }
std::vector<float> Batch::act() const { return impl_->rows(&StateView<float>::act); }
std::vector<float> Batch::mocap() const { return impl_->rows(&StateView<float>::mocap); }

void Batch::set_q(std::span<const float> q, std::span<const std::uint8_t> mask) {
  const FloatEnvironment floats;
  impl_->require_mask(mask);
  const std::size_t n = impl_->steps.size();
  const auto nq = static_cast<std::size_t>(impl_->model->nq());
  require_rows("q", q, n, nq);
  std::vector<float> rows(q.begin(), q.end());
  for (std::size_t i = 0; i < n; ++i) {
    if (!chosen(mask, i)) continue;
    internal::normalise_quaternions(*impl_->model, std::span(rows).subspan(i * nq, nq), std::to_string(i) + ", ");
  }
  impl_->set_rows(&StateView<float>::q, rows, mask);
  std::ranges::fill(rows, 0.0F);
  impl_->set_rows(&StateView<float>::q_rest, rows, mask);
}

void Batch::set_v(std::span<const float> v, std::span<const std::uint8_t> mask) {
  impl_->require_mask(mask);
  require_rows("v", v, impl_->steps.size(), static_cast<std::size_t>(impl_->model->nv()));
  impl_->set_rows(&StateView<float>::v, v, mask);
}

void Batch::set_tau(std::span<const float> tau, std::span<const std::uint8_t> mask) {
  impl_->require_mask(mask);
  require_rows("tau", tau, impl_->steps.size(), static_cast<std::size_t>(impl_->model->nv()));
  impl_->set_rows(&StateView<float>::tau, tau, mask);
}

void Batch::set_ctrl(std::span<const float> ctrl, std::span<const std::uint8_t> mask) {
  impl_->require_mask(mask);
  const auto nu = static_cast<std::size_t>(impl_->model->nu());
  require_rows("ctrl", ctrl, impl_->steps.size(), nu);
  std::vector<float> rows(ctrl.begin(), ctrl.end());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Actuator& actuator = impl_->model->actuators()[i % nu];
    rows[i] = clamp(rows[i], static_cast<float>(actuator.min_ctrl), static_cast<float>(actuator.max_ctrl));
  }
  impl_->set_rows(&StateView<float>::ctrl, rows, mask);
}

void Batch::set_act(std::span<const float> act, std::span<const std::uint8_t> mask) {
  impl_->require_mask(mask);
  require_rows("act", act, impl_->steps.size(), static_cast<std::size_t>(impl_->model->na()));
  impl_->set_rows(&StateView<float>::act, act, mask);
}

void Batch::set_motors(const BatchMotors& commands) {
  const std::size_t n = impl_->steps.size();
  const auto nv = static_cast<std::size_t>(impl_->model->nv());
  require_rows("target_q", commands.target_q, n, nv);
  require_rows("target_v", commands.target_v, n, nv);
  require_rows("kp", commands.kp, n, nv);
  require_rows("kd", commands.kd, n, nv);
  require_rows("max_force", commands.max_force, n, nv);
  internal::require_not_negative("kp", commands.kp);
  internal::require_not_negative("kd", commands.kd);
  internal::require_not_negative("max_force", commands.max_force);
  for (std::size_t i = 0; i < n && nv > 0; ++i) {
    require_undriven(*impl_->model, commands.max_force.subspan(i * nv, nv));
  }
  impl_->set_rows(&StateView<float>::target_q, commands.target_q, {});
  impl_->set_rows(&StateView<float>::target_v, commands.target_v, {});
  for (std::size_t i = 0; i < n; ++i) {
    const ParamsView<float> params = impl_->world(i).params;
    for (std::size_t k = 0; k < nv; ++k) {
      params.motor_kp[k] = commands.kp[i * nv + k];
      params.motor_kd[k] = commands.kd[i * nv + k];
      params.motor_max_force[k] = commands.max_force[i * nv + k];
    }
  }
}

void Batch::reset(std::span<const std::uint8_t> mask) {
  impl_->require_mask(mask);
  for (std::size_t i = 0; i < impl_->steps.size(); ++i) {
    if (!chosen(mask, i)) continue;
    const WorldView<float> world = impl_->world(i);
    const float* next = impl_->start.data();
    StateView<float>::visit_fields(
        [&](const FieldInfo&, const Strided<float>& field) {
          for (std::size_t k = 0; k < field.size(); ++k) field[k] = *next++;
        },
        world.state);
    for (std::size_t k = 0; k < world.extras.external.size(); ++k) world.extras.external[k] = 0;
    world.extras.pushed[0] = 0;
    impl_->steps[i] = 0;
    impl_->forget_step(i);
  }
}

// ---- snapshots -----------------------------------------------------------------------------------------------------

const SnapshotOwner& Batch::Impl::snapshot_owner() {
  if (!owner) {
    owner = manyhands::snapshot_owner("a Batch", *model, time_step);
    owner->text += ", " + std::to_string(num_worlds) + (num_worlds == 1 ? " world" : " worlds");
  }
  return *owner;
}

std::vector<std::uint8_t> Batch::snapshot() const {
  SnapshotWriter out(impl_->snapshot_owner());
  for (std::size_t i = 0; i < impl_->steps.size(); ++i) {
    out.put(impl_->steps[i]);
    out.put_world(impl_->world(i));
  }
  return out.finish();
}

void Batch::restore(std::span<const std::uint8_t> snapshot, std::span<const std::uint8_t> mask) {
  impl_->require_mask(mask);
  const std::size_t n = impl_->steps.size();
  SnapshotReader check(snapshot, impl_->snapshot_owner());
  SnapshotReader in = check;
  WorldBlock<float> draft(*impl_->model, impl_->world(0).state.contact_cache.size());
  for (std::size_t i = 0; i < n; ++i) {  // all is looked at before anything changes
    (void)check.take_count("a count of steps", kMostSteps);
    check.take_world(draft.view(0));
    require_sound(*impl_->model, draft.view(0));
    require_listed_contacts(draft.view(0).state);
  }
  check.finish();
  for (std::size_t i = 0; i < n; ++i) {
    const auto steps = in.take<std::int64_t>();
    if (!chosen(mask, i)) {
      in.take_world(draft.view(0));
      continue;
    }
    impl_->forget_step(i);
    impl_->steps[i] = steps;
    const WorldView<float> world = impl_->world(i);
    in.take_world(world);
    if (world.extras.frozen[0] > 0) impl_->flags[i] = BatchFlag::kNotFinite;
    let_resist_turning(world.params, impl_->lanes->colliders());
  }
}

std::uint64_t Batch::state_hash() const {
  Hash hash;
  for (std::size_t i = 0; i < impl_->steps.size(); ++i) {
    hash.add(impl_->steps[i]);
    add_world(impl_->world(i), hash);
  }
  return hash.value();
}

}  // namespace manyhands
