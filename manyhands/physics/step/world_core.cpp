#include "manyhands/physics/step/world_core.h"

#include <algorithm>
#include <unordered_map>

namespace manyhands {

namespace {

std::shared_ptr<const Model> required(std::shared_ptr<const Model> model) {
  if (model == nullptr) throw std::invalid_argument("a world needs a model; got none");
  return model;
}

}  // namespace

WorldCore::WorldCore(std::shared_ptr<const Model> shared_model)
    : model(required(std::move(shared_model))),
      system(*model),
      params(*model),
      state(*model, system.contact_numbers()),
      before(state),
      step(system),
      runge_kutta(system.tree),
      external(model->links().size(), Force<double>::zero()),
      external_before(external),
      scratch(system.tree) {
  std::ranges::copy(model->initial_configuration(), state.q());
  for (const Link& link : model->links()) link_mass.push_back(link.inertial.mass);
}

const Workspace<double>& WorldCore::placed() const {
  if (is_placed) return scratch;
  for (std::size_t b = 1; b < system.tree.bodies.size(); ++b) {
    place(system.tree, b, state.q(), scratch);
    move(system.tree, b, state.v(), scratch);
  }
  is_placed = true;
  return scratch;
}

void WorldCore::forget_step() {
  has_stepped = false;
  step.contacts.points.clear();
  step.contacts.torsions.clear();
}

namespace {

void copy_dofs(const double* from, int i, double* to, int k, int count) { std::copy_n(from + i, count, to + k); }

void carry_joint(const WorldCore& from, const Joint& a, const Joint& b, WorldCore& to) {
  const int nq = configuration_size(a.type), nv = velocity_size(a.type);
  if (nv == 0) return;
  const State<double>& old = from.state;
  State<double>& state = to.state;
  copy_dofs(old.q(), a.iq, state.q(), b.iq, nq);
  copy_dofs(old.v(), a.iv, state.v(), b.iv, nv);
  copy_dofs(old.tau(), a.iv, state.tau(), b.iv, nv);
  copy_dofs(old.target_q(), a.iv, state.target_q(), b.iv, nv);
  copy_dofs(old.target_v(), a.iv, state.target_v(), b.iv, nv);
  copy_dofs(old.stance(), a.iv, state.stance(), b.iv, nv);
  copy_dofs(old.dv(), a.iv, state.dv(), b.iv, nv);
  for (const auto field : {&Params<double>::damping, &Params<double>::armature, &Params<double>::lower,
                           &Params<double>::upper, &Params<double>::motor_kp, &Params<double>::motor_kd,
                           &Params<double>::motor_max_force, &Params<double>::friction}) {
    copy_dofs((from.params.*field).data(), a.iv, (to.params.*field).data(), b.iv, nv);
  }
}

void carry_links(const WorldCore& from, const std::vector<int>& links, WorldCore& to) {
  const ParamsView<double> params = view(to.params, 0);
  const Strided<double> masses = lane_of<double>(to.link_mass, 0, 1);
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (links[i] < 0) continue;
    const auto k = static_cast<std::size_t>(links[i]);
    to.external[k] = from.external[i];
    if (to.link_mass[k] != from.link_mass[i]) set_link_mass(*to.model, LinkId(k), from.link_mass[i], masses, params);
  }
  to.pushed = from.pushed;
}

void carry_geoms(const WorldCore& from, const std::vector<int>& geoms, WorldCore& to) {
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    if (geoms[i] < 0) continue;
    const auto k = static_cast<std::size_t>(geoms[i]);
    to.params.geom_size[k] = from.params.geom_size[i];
    for (const auto field :
         {&Params<double>::geom_friction, &Params<double>::geom_friction_y, &Params<double>::geom_spinning,
          &Params<double>::geom_rolling, &Params<double>::geom_restitution}) {
      (to.params.*field)[k] = (from.params.*field)[i];
    }
  }
}

void carry_actuators(const WorldCore& from, const std::vector<int>& actuators, WorldCore& to) {
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    if (actuators[i] < 0) continue;
    const auto k = static_cast<std::size_t>(actuators[i]);
    to.state.ctrl()[k] = from.state.ctrl()[i];
    for (const auto field : {&Params<double>::gear, &Params<double>::drive_kp, &Params<double>::drive_kd,
                             &Params<double>::drive_max_force}) {
      (to.params.*field)[k] = (from.params.*field)[i];
    }
  }
}

/// Impulses of pairs whose geoms are both still there.
void carry_contacts(const WorldCore& from, const std::vector<int>& geoms, WorldCore& to) {
  const auto key = [](std::size_t a, std::size_t b) { return (static_cast<std::uint64_t>(a) << 32) | b; };
  std::unordered_map<std::uint64_t, const ColliderPair*> old_pairs;
  for (const ColliderPair& pair : from.system.colliders.pairs) {
    const int a = geoms[from.system.colliders.geoms[pair.a].geom], b = geoms[from.system.colliders.geoms[pair.b].geom];
    if (a >= 0 && b >= 0) old_pairs.emplace(key(static_cast<std::size_t>(a), static_cast<std::size_t>(b)), &pair);
  }
  const std::span<const double> memory = from.state.contacts();
  for (const ColliderPair& pair : to.system.colliders.pairs) {
    const Colliders<double>& colliders = to.system.colliders;
    const auto found = old_pairs.find(key(colliders.geoms[pair.a].geom, colliders.geoms[pair.b].geom));
    if (found == old_pairs.end() || found->second->manifolds != pair.manifolds) continue;
    const auto numbers =
        memory.subspan(found->second->manifold * kManifoldNumbers<double>, pair.manifolds * kManifoldNumbers<double>);
    const std::size_t start = pair.manifold * kManifoldNumbers<double>;
    std::ranges::copy(numbers, to.state.contacts().begin() + static_cast<std::ptrdiff_t>(start));
  }
}

}  // namespace

void carry(const WorldCore& from, const PartMap& map, WorldCore& to) {
  to.params.gravity = from.params.gravity;
  for (std::size_t i = 0; i < map.joints.size(); ++i) {
    if (map.joints[i] < 0) continue;
    carry_joint(from, from.model->joints()[i], to.model->joints()[static_cast<std::size_t>(map.joints[i])], to);
  }
  carry_links(from, map.links, to);
  carry_geoms(from, map.geoms, to);
  carry_actuators(from, map.actuators, to);
  carry_contacts(from, map.geoms, to);
}

}  // namespace manyhands
