#include "manyhands/physics/world/world.h"

#include <algorithm>

#include "manyhands/base/hash.h"
#include "manyhands/physics/world/world_checks.h"

namespace manyhands {

using internal::require_finite;
using internal::require_not_negative;
using internal::require_numbers;

World::World(double time_step, Integrator integrator)
    : World(std::make_shared<const Model>(ModelBuilder("world").build()), time_step, integrator) {}

World::World(std::shared_ptr<const Model> model, double time_step, Integrator integrator)
    : time_step_(time_step), integrator_(integrator), core_(std::move(model)) {
  internal::require_time_step(time_step);
}

void World::step(int n) {
  if (n < 0) throw std::invalid_argument("the number of steps is " + std::to_string(n) + "; expected 0 or more");
  WorldCore& now = core();
  for (int i = 0; i < n; ++i) step_once(now);
}

namespace {

/// The joints with a coordinate that is not finite, by name; empty if there are none.
std::string joints_without_numbers(const WorldCore& core) {
  constexpr int kMostNamed = 5;
  std::string names;
  int count = 0;
  for (const Body& body : core.model->bodies()) {
    const auto all_finite = [](const double* x, int size) { return std::all_of(x, x + size, &is_finite<double>); };
    if (all_finite(core.state.q() + body.iq, body.nq) && all_finite(core.state.v() + body.iv, body.nv)) continue;
    if (++count > kMostNamed) continue;
    names += (names.empty() ? "'" : ", '") + core.model->joint(body.joint).name + "'";
  }
  return count > kMostNamed ? names + " and " + std::to_string(count - kMostNamed) + " more" : names;
}

/// J^T F of the forces applied to links, added to tau.
void push(WorldCore& core) {
  const Workspace<double>& ws = core.placed();
  const Tree<double>& tree = core.system.tree;
  for (std::size_t i = 0; i < core.external.size(); ++i) {
    const std::size_t body = core.model->links()[i].body.index();
    const Force<double>& F = core.external[i];
    const Force<double> about_tree{F.n - cross(ws.p_WO[body], F.f), F.f};
    for (int k = tree.last_dof[body]; k >= 0; k = tree.dof_parent[static_cast<std::size_t>(k)]) {
      core.state.tau()[k] += dot(ws.S[static_cast<std::size_t>(k)], about_tree);
    }
  }
}

}  // namespace

void World::step_once(WorldCore& core) {
  core.before = core.state;
  core.external_before = core.external;
  const bool pushed = core.pushed;
  if (pushed) {
    push(core);
    std::ranges::fill(core.external, Force<double>::zero());
    core.pushed = false;
  }
  if (integrator_ == Integrator::kRungeKutta4) {
    try {
      runge_kutta_step_or_throw(core);
    } catch (const std::runtime_error&) {
      core.state = core.before;
      core.moved();
      throw;
    }
  } else {
    core.system.solver = solver_;
    manyhands::step(core.system, core.params, time_step_, core.state, core.step);
  }
  core.moved();
  if (const std::string joints = joints_without_numbers(core); !joints.empty()) {
    core.state = core.before;
    core.forget_step();
    throw SimulationError("the step at " + std::to_string(time()) +
                          " s leads to numbers that are not finite at joint " + joints +
                          ": look for forces, speeds or mass ratios beyond reason, or take a smaller "
                          "time_step. The world is as it was before this step");
  }
  if (pushed) std::copy_n(core.before.tau(), core.nv(), core.state.tau());
  core.has_stepped = integrator_ == Integrator::kSemiImplicit;
  ++steps_;
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
  require_within_limits(core, "before");
  require_apart(core);
  runge_kutta_step(core.system.tree, core.params, time_step_, core.state, core.runge_kutta);
  require_within_limits(core, "after");
}

void World::set_q(std::span<const double> q) {
  WorldCore& now = core();
  require_numbers("q", q, now.nq());
  std::vector<double> checked(q.begin(), q.end());
  for (const TreeBody<double>& body : now.system.tree.bodies) {
    if (body.type != JointType::kSpherical && body.type != JointType::kFloating) continue;
    double* r = &checked[static_cast<std::size_t>(body.iq + (body.type == JointType::kFloating ? 3 : 0))];
    const double length = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
    if (!(abs(length - 1) <= 1e-6)) {
      throw std::invalid_argument("the quaternion at q[" + std::to_string(r - checked.data()) + "] has length " +
                                  std::to_string(length) + "; expected 1 (order x, y, z, w)");
    }
    for (int k = 0; k < 4; ++k) r[k] /= length;
  }
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
  solver_ = settings;
}

Energy<double> World::energy() const {
  const WorldCore& now = core();
  now.is_placed = false;
  return manyhands::energy(now.system.tree, now.params, now.state.q(), now.state.v(), now.scratch);
}

MassProperties<double> World::mass_properties() const {
  const WorldCore& now = core();
  now.is_placed = false;
  return manyhands::mass_properties(now.system.tree, now.params, now.state.q(), now.state.v(), now.scratch);
}

namespace {

/// Tells models apart; a whole number that a double holds.
double fingerprint(const Model& model) {
  Hash hash;
  const auto add_text = [&](const std::string& text) {
    for (const char c : text) hash.add(c);
    hash.add('\0');
  };
  for (const Link& link : model.links()) add_text(link.name);
  for (const Joint& joint : model.joints()) {
    add_text(joint.name);
    hash.add(static_cast<int>(joint.type));
  }
  for (const Geom& geom : model.geoms()) hash.add(static_cast<int>(geom.shape.type));
  hash.add(model.nu());
  return static_cast<double>(hash.value() >> 11);
}

/// Calls visit(first number, how many) for every piece of a snapshot after its head.
template <class Core, class Visit>
void visit_pieces(Core& core, Visit&& visit) {
  visit(core.state.numbers().data(), core.state.numbers().size());
  visit(core.link_mass.data(), core.link_mass.size());
  if (!core.external.empty()) visit(&core.external.front().n.x, 6 * core.external.size());
}

constexpr std::size_t kSnapshotHead = 5;  // fingerprint, time step, steps, whether forces are applied, contact numbers

/// The count that a number of a snapshot means; 0 if it means none.
std::size_t whole(double x) { return x >= 0 && x < 1e12 ? static_cast<std::size_t>(x) : 0; }

}  // namespace

std::vector<double> World::snapshot() const {
  const WorldCore& now = core();
  std::vector<double> numbers{fingerprint(*now.model), time_step_, static_cast<double>(steps_), now.pushed ? 1.0 : 0.0,
                              static_cast<double>(now.state.contact_cache().size())};
  visit_pieces(now,
               [&](const double* first, std::size_t count) { numbers.insert(numbers.end(), first, first + count); });
  view(const_cast<Params<double>&>(now.params), 0).for_each([&](const Strided<double>& field) {
    numbers.insert(numbers.end(), field.first, field.first + field.count);
  });
  return numbers;
}

void World::restore(std::span<const double> snapshot) {
  WorldCore& now = core();
  // A large world remembers as many contacts as it has.
  const bool grows = now.system.colliders.search == PairSearch::kSwept && snapshot.size() >= kSnapshotHead;
  const std::size_t contacts = grows ? whole(snapshot[4]) : now.state.contact_cache().size();
  std::size_t expected = kSnapshotHead + contacts - now.state.contact_cache().size();
  visit_pieces(now, [&](double*, std::size_t count) { expected += count; });
  const ParamsView<double> params = view(now.params, 0);
  params.for_each([&](const Strided<double>& field) { expected += field.count; });
  if (snapshot.size() != expected || snapshot[0] != fingerprint(*now.model)) {
    throw std::invalid_argument("the snapshot is of another model, or of a world with other parts: it holds " +
                                std::to_string(snapshot.size()) + " numbers, this world's hold " +
                                std::to_string(expected));
  }
  if (snapshot[1] != time_step_) {
    throw std::invalid_argument("the snapshot is of a world with a time_step of " + std::to_string(snapshot[1]) +
                                " s; this world's is " + std::to_string(time_step_) + " s");
  }
  require_finite("the snapshot", snapshot.first(kSnapshotHead + now.nq() + now.nv()));
  if (std::ranges::any_of(snapshot, [](double x) { return x != x; })) {
    throw std::invalid_argument("the snapshot holds a NaN");
  }
  steps_ = static_cast<std::int64_t>(snapshot[2]);
  now.pushed = snapshot[3] != 0;
  now.state.resize_contact_cache(contacts);
  const double* next = snapshot.data() + kSnapshotHead;
  const auto take = [&](double* first, std::size_t count) {
    std::copy_n(next, count, first);
    next += count;
  };
  visit_pieces(now, take);
  params.for_each([&](const Strided<double>& field) { take(field.first, field.count); });
  let_resist_turning(params, now.system.colliders);
  now.moved();
  now.forget_step();
}

void World::forget() {
  WorldCore& now = core();
  State<double>& state = now.state;
  for (double* first : {state.active_set(), state.dv(), state.joint_impulse()}) std::fill_n(first, now.nv(), 0.0);
  std::ranges::fill(state.equality_impulses(), 0.0);
  std::ranges::fill(state.contact_cache(), 0.0);
  steps_ = 0;
  now.moved();
  now.forget_step();
}

std::uint64_t World::state_hash() const {
  Hash hash;
  for (const double number : snapshot()) hash.add(number);
  return hash.value();
}

}  // namespace manyhands
