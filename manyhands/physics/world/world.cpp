#include "manyhands/physics/world/world.h"

#include <algorithm>

#include "manyhands/base/float_environment.h"
#include "manyhands/base/hash.h"
#include "manyhands/physics/dynamics/checks.h"
#include "manyhands/physics/world/world_impl.h"
#include "manyhands/physics/world/world_text.h"

namespace manyhands {

using internal::require_not_negative;
using internal::require_numbers;

World::World(double time_step, Integrator integrator)
    : World(std::make_shared<const Model>(ModelBuilder("world").build()), time_step, integrator) {}

World::World(std::shared_ptr<const Model> model, double time_step, Integrator integrator)
    : time_step_(time_step),
      integrator_(integrator),
      solver_(std::make_unique<SolverSettings>()),
      core_(std::make_unique<WorldCore>(std::move(model))),
      shown_(std::make_unique<Shown>()) {
  internal::require_time_step(time_step);
}

World::World(const World& other)
    : time_step_(other.time_step_),
      integrator_(other.integrator_),
      since_(other.since_),
      steps_(other.steps_),
      edition_(other.edition_),
      report_(other.report_),
      solver_(std::make_unique<SolverSettings>(*other.solver_)),
      core_(std::make_unique<WorldCore>(*other.core_)),
      shown_(std::make_unique<Shown>()) {}

World::World(World&& other) noexcept = default;
World::~World() = default;

World& World::operator=(World other) noexcept {
  time_step_ = other.time_step_;
  integrator_ = other.integrator_;
  since_ = other.since_;
  steps_ = other.steps_;
  edition_ = other.edition_ + 1;
  report_ = std::move(other.report_);
  solver_ = std::move(other.solver_);
  core_ = std::move(other.core_);
  shown_ = std::move(other.shown_);
  return *this;
}

WorldCore& World::core() const {
  if (core_->num_gone > 0) rebuild();
  loose().refresh_keys();
  return *core_;
}

WorldCore& World::loose() const {
  if (!core_->new_places.empty()) rebuild();
  return *core_;
}

const Model& World::model() const { return *core().model; }
std::shared_ptr<const Model> World::shared_model() const { return core().model; }
std::span<const double> World::q() const { return loose().living(core_->state.q(), Each::kCoordinate, shown_->q); }
std::span<const double> World::v() const { return loose().living(core_->state.v(), Each::kDof, shown_->v); }
std::span<const double> World::tau() const { return loose().living(core_->state.tau(), Each::kDof, shown_->tau); }
std::span<const double> World::ctrl() const {
  return loose().living(core_->state.ctrl(), Each::kActuator, shown_->ctrl);
}
std::span<const double> World::act() const {
  return loose().living(core_->state.act(), Each::kActivation, shown_->act);
}
int World::solver_iterations() const { return loose().has_stepped ? core_->step.contact.iterations : 0; }
const SolverSettings& World::solver() const { return *solver_; }

void World::set_time_step(double time_step) {
  internal::require_time_step(time_step);
  since_ = time();
  steps_ = 0;
  time_step_ = time_step;
  loose().owner.reset();
}

void World::step(int n) {
  if (n < 0) throw std::invalid_argument("the number of steps is " + std::to_string(n) + "; expected 0 or more");
  const FloatEnvironment floats;
  WorldCore& now = core();
  now.prepare_step();
  for (int i = 0; i < n; ++i) step_once(now);
}

namespace {

/// The joints with a coordinate that is not finite, by name; empty if there are none.
std::string joints_without_numbers(const WorldCore& core) {
  std::vector<std::string> names;
  for (const Body& body : core.model->bodies()) {
    const bool finite = internal::all_finite(core.state.q() + body.iq, body.nq) &&
                        internal::all_finite(core.state.v() + body.iv, body.nv);
    if (!finite) names.push_back(core.model->joint(body.joint).name);
  }
  return internal::list_of(names, 5);
}

/// The joint that moves farthest in the step, of the trees that have made motion, and what is wrong with it.
std::string made_motion(const WorldCore& core, double h) {
  const std::vector<TreeBody<double>>& bodies = core.system.tree.bodies;
  const EnergyBalance<double>& balance = core.balance;
  std::size_t farthest = 0, tree = 0;
  double most = 0;
  for (std::size_t b = 1; b < bodies.size(); ++b) {
    if (!internal::gains(balance, balance.root[b])) continue;
    for (int i = bodies[b].iv; i < bodies[b].iv + bodies[b].nv; ++i) {
      const double moves = h * std::abs(core.state.v()[i]);
      if (moves <= most) continue;
      most = moves;
      farthest = b;
      tree = balance.root[b];
    }
  }
  const double moving = std::max(balance.after[tree], balance.moved[tree]), risen = internal::risen(balance, tree);
  const std::string gains = risen > moving ? "springs gain " + internal::short_text(risen)
                                           : "motion grows from " + internal::short_text(balance.before[tree]) +
                                                 " J to " + internal::short_text(moving);
  return "moves joint '" + core.model->joint(core.model->bodies()[farthest].joint).name + "' by " +
         internal::short_text(most) + " rad or m at once, and its tree's " + gains + " J from nothing";
}

}  // namespace

void World::fail_step(WorldCore& core, const std::string& what) {
  core.return_to_start();
  core.moved();
  core.forget_step();
  throw SimulationError("the step at " + std::to_string(time()) + " s " + what +
                        ": look for forces, speeds or mass ratios beyond reason, or take a smaller time_step. The "
                        "world is as it was before this step");
}

void World::step_once(WorldCore& core) {
  core.keep_start();
  core.external_before.assign(core.extras.external.begin(), core.extras.external.end());
  const bool pushed = core.extras.pushed[0] != 0;
  if (pushed) core.push(core.system.tree, core.model->frames(), core.placed());
  if (integrator_ == Integrator::kRungeKutta4) {
    try {
      runge_kutta_step_or_throw(core);
    } catch (const std::runtime_error&) {
      core.return_to_start();
      core.moved();
      throw;
    }
  } else {
    core.system.solver = *solver_;
    manyhands::step(core.system, core.params, time_step_, core.state, core.step);
  }
  core.moved();
  if (!core.is_finite()) {
    fail_step(core, "leads to numbers that are not finite at joint " + joints_without_numbers(core));
  }
  if (integrator_ == Integrator::kSemiImplicit) require_balance(core);
  if (pushed) core.restore_tau(core.before);
  core.has_stepped = integrator_ == Integrator::kSemiImplicit;
  ++steps_;
}

void World::require_balance(WorldCore& core) {
  if (keep_balance(core.system.tree, core.params, time_step_, core.q_before(), core.v_before(), core.step.dynamics,
                   core.state, core.scratch, core.balance))
    fail_step(core, made_motion(core, time_step_));
}

void World::require_within_limits(const WorldCore& core, const char* when) const {
  const Tree<double>& tree = core.system.tree;
  for (std::size_t i = 0; i < core.nv(); ++i) {
    if (!tree.dof_limited[i]) continue;
    const double q = core.state.q()[tree.dof_q[i]];
    if (q >= core.params.lower[i] && q <= core.params.upper[i]) continue;
    const std::string& joint = core.model->joint(JointId(core.model->dof_joint()[i])).name;
    throw std::runtime_error("the rk4 integrator knows no joint limits, but joint '" + joint + "' is outside its own " +
                             when + " the step at " + std::to_string(time()) + " s: use semi_implicit");
  }
}

void World::require_apart(WorldCore& core) const {
  const Colliders<double>& colliders = core.system.colliders;
  const std::span<const ColliderPair> pairs =
      look_for_touches(colliders, core.params, time_step_, core.placed(), core.step);
  for (const Touch<double>& touch : core.step.collision.touches) {
    if (std::ranges::none_of(touch.contact.phi, [](double phi) { return phi < 0; })) continue;
    const auto label = [&](std::size_t geom) { return geom_label(*core.model, GeomId(colliders.geoms[geom].geom)); };
    throw std::runtime_error("the rk4 integrator knows no contacts, but geoms '" + label(pairs[touch.pair].a) +
                             "' and '" + label(pairs[touch.pair].b) + "' touch at " + std::to_string(time()) +
                             " s: use semi_implicit");
  }
}

void World::runge_kutta_step_or_throw(WorldCore& core) {
  const auto acts = [](double force) { return force > 0; };
  if (std::ranges::any_of(core.params.motor_max_force, acts)) {
    throw std::runtime_error("the rk4 integrator knows no motors: set their max_force to 0, or use semi_implicit");
  }
  if (core.nu() > 0) throw std::runtime_error("the rk4 integrator knows no actuators: use semi_implicit");
  if (!core.model->tendons().empty())
    throw std::runtime_error("the rk4 integrator knows no tendons: use semi_implicit");
  require_within_limits(core, "before");
  require_apart(core);
  runge_kutta_step(core.system.tree, core.params, time_step_, core.state, core.runge_kutta);
  require_within_limits(core, "after");
}

void World::set_q(std::span<const double> q) {
  const FloatEnvironment floats;
  WorldCore& now = core();
  require_numbers("q", q, now.nq());
  std::vector<double> checked(q.begin(), q.end());
  internal::normalise_quaternions(*now.model, std::span(checked));
  std::ranges::copy(checked, now.state.q());
  now.moved();
}

void World::set_v(std::span<const double> v) {
  WorldCore& now = core();
  require_numbers("v", v, now.nv());
  std::ranges::copy(v, now.state.v());
  now.moved();
}

void World::set_tau(std::span<const double> tau) {
  WorldCore& now = core();
  require_numbers("tau", tau, now.nv());
  std::ranges::copy(tau, now.state.tau());
}

void World::set_ctrl(std::span<const double> ctrl) {
  WorldCore& now = core();
  require_numbers("ctrl", ctrl, now.nu());
  for (std::size_t i = 0; i < ctrl.size(); ++i) {
    const Actuator& actuator = now.model->actuators()[i];
    now.state.ctrl()[i] = clamp(ctrl[i], actuator.min_ctrl, actuator.max_ctrl);
  }
}

void World::set_act(std::span<const double> act) {
  WorldCore& now = core();
  require_numbers("act", act, static_cast<std::size_t>(now.model->na()));
  std::ranges::copy(act, now.state.act());
}

namespace {

/// The place in act of the actuator of that name.
int activation_index(const Model& model, std::string_view name) {
  const Actuator& actuator = model.actuators()[actuator_id(model, name).index()];
  if (actuator.iact < 0) throw std::invalid_argument("actuator '" + actuator.name + "' has no activation");
  return actuator.iact;
}

}  // namespace

double World::activation(std::string_view actuator) const {
  return loose().state.act()[activation_index(*core_->model, actuator)];
}

void World::set_activation(std::string_view actuator, double act) {
  require_numbers("act", std::span<const double>(&act, 1), 1);
  loose().state.act()[activation_index(*core_->model, actuator)] = act;
}

void World::set_keyframe(std::string_view name) {
  const Keyframe key = core().model->keyframe(name);
  set_q(key.q);
  set_v(key.v);
  set_ctrl(key.ctrl);
  set_act(key.act);
  std::ranges::copy(key.mocap, core().state.mocap());
}

void World::set_motors(const MotorCommands& commands) {
  WorldCore& now = core();
  const std::size_t nv = now.nv();
  require_numbers("target_q", commands.target_q, nv);
  require_numbers("target_v", commands.target_v, nv);
  require_numbers("kp", commands.kp, nv);
  require_numbers("kd", commands.kd, nv);
  require_numbers("max_force", commands.max_force, nv);
  require_not_negative("kp", commands.kp);
  require_not_negative("kd", commands.kd);
  require_not_negative("max_force", commands.max_force);
  require_undriven(*now.model, commands.max_force);
  std::ranges::copy(commands.target_q, now.state.target_q());
  std::ranges::copy(commands.target_v, now.state.target_v());
  std::ranges::copy(commands.kp, now.params.motor_kp.begin());
  std::ranges::copy(commands.kd, now.params.motor_kd.begin());
  std::ranges::copy(commands.max_force, now.params.motor_max_force.begin());
}

void World::set_solver(const SolverSettings& settings) {
  internal::require_solver(settings);
  *solver_ = settings;
}

Energy<double> World::energy() const {
  const WorldCore& now = core();
  now.is_placed = false;
  return manyhands::energy(now.system.tree, now.params, now.state.q(), now.state.v(), now.scratch);
}

std::vector<double> World::tendon_lengths() const {
  const WorldCore& now = core();
  const Workspace<double>& placed = now.placed_lengths();
  return {placed.length.begin(), placed.length.begin() + std::ssize(now.model->tendons())};
}

std::vector<double> World::tendon_velocities() const {
  const WorldCore& now = core();
  const Workspace<double>& placed = now.placed_lengths();
  return {placed.length_rate.begin(), placed.length_rate.begin() + std::ssize(now.model->tendons())};
}

MassProperties<double> World::mass_properties() const {
  const WorldCore& now = core();
  now.is_placed = false;
  return manyhands::mass_properties(now.system.tree, now.params, now.state.q(), now.state.v(), now.scratch);
}

namespace {

const SnapshotOwner& owner_of(const WorldCore& core, double time_step) {
  if (!core.owner) core.owner = snapshot_owner("a World", *core.model, time_step);
  return *core.owner;
}

/// Reads a world's part of a snapshot; `draft` has the core's model. Throws std::invalid_argument on numbers that
/// cannot be.
std::int64_t take_world(SnapshotReader& in, const WorldCore& core, WorldBlock<double>& draft) {
  const std::int64_t steps = in.take_count("a count of steps", kMostSteps);
  const auto most = static_cast<std::int64_t>(in.left() / sizeof(double));
  const std::int64_t contacts = in.take_count("a number of contacts", most);
  const bool swept = core.system.colliders.search == PairSearch::kSwept;
  if (swept && static_cast<std::size_t>(contacts) % kManifoldNumbers<double> == 0) {
    draft.state.resize_contact_cache(static_cast<std::size_t>(contacts));
  }
  if (static_cast<std::size_t>(contacts) != draft.state.contact_cache().size()) {
    throw std::invalid_argument("the snapshot holds another number of contacts than its world can have");
  }
  const WorldView<double> view = draft.view(0);
  in.take_world(view);
  in.finish();
  require_sound(*core.model, view);
  if (swept) {
    require_found_contacts(view.state, core.system.colliders.geoms.size());
  } else {
    require_listed_contacts(view.state);
  }
  return steps;
}

}  // namespace

std::vector<std::uint8_t> World::snapshot() const {
  const WorldCore& now = core();
  SnapshotWriter out(owner_of(now, time_step_));
  out.put(steps_);
  out.put(static_cast<std::int64_t>(now.state.contact_cache().size()));
  out.put_world(now.view(0));
  return out.finish();
}

void World::restore(std::span<const std::uint8_t> snapshot) {
  WorldCore& now = core();
  SnapshotReader in(snapshot, owner_of(now, time_step_));
  WorldBlock<double> draft(now);
  steps_ = take_world(in, now, draft);
  static_cast<WorldBlock<double>&>(now) = std::move(draft);
  let_resist_turning(now.view(0).params, now.system.colliders);
  now.moved();
  now.forget_step();
}

void World::forget() {
  WorldCore& now = core();
  State<double>& state = now.state;
  for (double* first : {state.active_set(), state.dv(), state.joint_impulse()}) std::fill_n(first, now.nv(), 0.0);
  state.calm()[0] = 0;
  std::ranges::fill(state.equality_impulses(), 0.0);
  std::ranges::fill(state.contact_cache(), 0.0);
  since_ = 0;
  steps_ = 0;
  now.moved();
  now.forget_step();
}

std::uint64_t World::state_hash() const {
  Hash hash;
  hash.add(steps_);
  add_world(core().view(0), hash);
  return hash.value();
}

}  // namespace manyhands
