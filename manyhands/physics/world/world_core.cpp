#include "manyhands/physics/world/world_core.h"

#include <algorithm>
#include <map>

namespace manyhands {

namespace {

std::shared_ptr<const Model> required(std::shared_ptr<const Model> model) {
  if (model == nullptr) throw std::invalid_argument("a world needs a model; got none");
  return model;
}

/// Beyond so many colliding geoms a broad phase is faster than a list of all pairs.
constexpr std::ptrdiff_t kMostListed = 60;

System<double> system_of(const std::shared_ptr<const Model>& shared_model) {
  const Model& model = *required(shared_model);
  const auto count = std::ranges::count(model.geoms(), GeomRole::kCollision, &Geom::role);
  return System<double>(model, count > kMostListed ? PairSearch::kSwept : PairSearch::kListed);
}

/// The two colliders, lower index first, and the number of the manifold between them that a large world's key tells.
struct ManifoldOf {
  std::size_t low, high, number;
};

ManifoldOf manifold_of(const Colliders<double>& colliders, double key) {
  const auto whole = static_cast<std::size_t>(key);
  const std::size_t pair = whole / kManifoldPoints;
  return {pair / colliders.geoms.size(), pair % colliders.geoms.size(), whole % kManifoldPoints};
}

double key_of(const Colliders<double>& colliders, const ManifoldOf& m) {
  return static_cast<double>(kManifoldPoints * (m.low * colliders.geoms.size() + m.high) + m.number);
}

}  // namespace

WorldCore::WorldCore(std::shared_ptr<const Model> shared_model)
    : WorldCore(required(shared_model), system_of(shared_model)) {}

WorldCore::WorldCore(std::shared_ptr<const Model> shared_model, System<double> own_system)
    : WorldBlock<double>(*shared_model, own_system.contact_numbers()),
      model(std::move(shared_model)),
      system(std::move(own_system)),
      step(system),
      runge_kutta(system.tree),
      external_before(model->links().size(), Force<double>::zero()),
      scratch(system.tree) {
  keep_all(before);
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

std::pair<std::size_t, std::size_t> WorldCore::colliders_of(const ContactPatch<double>& patch) const {
  const Colliders<double>& colliders = system.colliders;
  if (colliders.search == PairSearch::kListed) {
    const ColliderPair& pair = colliders.pairs[patch.pair];
    return {pair.a, pair.b};
  }
  const std::size_t first = patch.manifold * kManifoldNumbers<double>;
  const ManifoldOf m = manifold_of(colliders, state.contact_cache()[first]);
  const std::optional<ColliderPair> pair = colliders.pair_of(m.low, m.high);
  return {pair->a, pair->b};
}

void WorldCore::forget_step() {
  has_stepped = false;
  step.contact.problem.points.clear();
  step.contact.problem.torsions.clear();
}

namespace {

/// Copies a joint's items of every field that has one for each of `each`, from index i on to index k on.
template <class Fields>
void copy_items(const Fields& from, Fields& to, Each each, int i, int k, int count) {
  Fields::visit_fields(
      [&](const FieldInfo& info, const auto& a, auto& b) {
        if (info.each == each) std::copy_n(a.begin() + i, count, b.begin() + k);
      },
      from, to);
}

void carry_joint(const WorldCore& from, const Joint& a, const Joint& b, WorldCore& to) {
  const int nq = configuration_size(a.type), nv = velocity_size(a.type);
  if (nv == 0) return;
  copy_items(from.state, to.state, Each::kCoordinate, a.iq, b.iq, nq);
  copy_items(from.state, to.state, Each::kDof, a.iv, b.iv, nv);
  copy_items(from.params, to.params, Each::kDof, a.iv, b.iv, nv);
}

/// Inertias of bodies follow the masses of their links.
void carry_links(const WorldCore& from, const std::vector<int>& links, WorldCore& to) {
  const WorldView<double> view = to.view(0);
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (links[i] < 0) continue;
    const auto k = static_cast<std::size_t>(links[i]);
    to.extras.external[k] = from.extras.external[i];
    const double mass = from.extras.link_mass[i];
    if (to.extras.link_mass[k] != mass) set_link_mass(*to.model, LinkId(k), mass, view.extras.link_mass, view.params);
  }
  to.extras.pushed[0] = from.extras.pushed[0];
}

void carry_geoms(const WorldCore& from, const std::vector<int>& geoms, WorldCore& to) {
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    if (geoms[i] >= 0) copy_items(from.params, to.params, Each::kGeom, static_cast<int>(i), geoms[i], 1);
  }
}

void carry_actuators(const WorldCore& from, const std::vector<int>& actuators, WorldCore& to) {
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    if (actuators[i] < 0) continue;
    copy_items(from.state, to.state, Each::kActuator, static_cast<int>(i), actuators[i], 1);
    copy_items(from.params, to.params, Each::kActuator, static_cast<int>(i), actuators[i], 1);
  }
}

/// Calls visit(which, its numbers) for every manifold in a core's memory.
template <class Visit>
void visit_memory(const WorldCore& core, Visit&& visit) {
  const Colliders<double>& colliders = core.system.colliders;
  const std::span<const double> memory = core.state.contact_cache();
  const auto numbers = [&](std::size_t i) {
    return memory.subspan(i * kManifoldNumbers<double>, kManifoldNumbers<double>);
  };
  if (colliders.search == PairSearch::kSwept) {
    for (std::size_t i = 0; i < memory.size() / kManifoldNumbers<double>; ++i) {
      visit(manifold_of(colliders, numbers(i)[0]), numbers(i));
    }
    return;
  }
  for (const ColliderPair& pair : colliders.pairs) {
    for (std::size_t k = 0; k < pair.manifolds; ++k) {
      visit(ManifoldOf{std::min(pair.a, pair.b), std::max(pair.a, pair.b), k}, numbers(pair.manifold + k));
    }
  }
}

/// Impulses of pairs whose geoms are both still there.
void carry_contacts(const WorldCore& from, const std::vector<int>& geoms, WorldCore& to) {
  const Colliders<double>&before = from.system.colliders, &now = to.system.colliders;
  std::vector<std::size_t> collider_of(to.model->geoms().size(), now.geoms.size());
  for (std::size_t i = 0; i < now.geoms.size(); ++i) collider_of[now.geoms[i].geom] = i;
  const auto carried = [&](std::size_t old) {
    const int geom = geoms[before.geoms[old].geom];
    return geom < 0 ? now.geoms.size() : collider_of[static_cast<std::size_t>(geom)];
  };
  std::map<double, std::vector<double>> kept;  // by key: the order in which a large world remembers
  visit_memory(from, [&](const ManifoldOf& m, std::span<const double> numbers) {
    const std::size_t a = carried(m.low), b = carried(m.high);
    const bool used = numbers[1] != 0;
    if (!used || std::max(a, b) >= now.geoms.size()) return;
    const double key = key_of(now, {std::min(a, b), std::max(a, b), m.number});
    kept[key].assign(numbers.begin(), numbers.end());
  });
  if (now.search == PairSearch::kSwept) {
    to.state.resize_contact_cache(kept.size() * kManifoldNumbers<double>);
    auto next = to.state.contact_cache().begin();
    for (auto& [key, numbers] : kept) {
      numbers[0] = key;
      next = std::ranges::copy(numbers, next).out;
    }
    return;
  }
  for (const ColliderPair& pair : now.pairs) {
    for (std::size_t k = 0; k < pair.manifolds; ++k) {
      const auto found = kept.find(key_of(now, {std::min(pair.a, pair.b), std::max(pair.a, pair.b), k}));
      if (found == kept.end()) continue;
      found->second[0] = 0;
      const auto first = static_cast<std::ptrdiff_t>((pair.manifold + k) * kManifoldNumbers<double>);
      std::ranges::copy(found->second, to.state.contact_cache().begin() + first);
    }
  }
}

}  // namespace

void carry(const WorldCore& from, const PartMap& map, WorldCore& to) {
  copy_items(from.params, to.params, Each::kWorld, 0, 0, 1);
  for (std::size_t i = 0; i < map.joints.size(); ++i) {
    if (map.joints[i] < 0) continue;
    carry_joint(from, from.model->joints()[i], to.model->joints()[static_cast<std::size_t>(map.joints[i])], to);
  }
  carry_links(from, map.links, to);
  carry_geoms(from, map.geoms, to);
  carry_actuators(from, map.actuators, to);
  carry_contacts(from, map.geoms, to);
  let_resist_turning(view(to.params, 0), to.system.colliders);
}

}  // namespace manyhands
