#include "manyhands/physics/world/world_core.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace manyhands {

namespace {

std::shared_ptr<const Model> required(std::shared_ptr<const Model> model) {
  if (model == nullptr) throw std::invalid_argument("a world needs a model; got none");
  return model;
}

/// Beyond so many colliding geoms a broad phase is faster than a list of all pairs.
constexpr std::size_t kMostListed = 60;

PairSearch search_of(std::size_t colliders) {
  return colliders > kMostListed ? PairSearch::kSwept : PairSearch::kListed;
}

System<double> system_of(const std::shared_ptr<const Model>& shared_model) {
  const Model& model = *required(shared_model);
  const auto count = std::ranges::count(model.geoms(), GeomRole::kCollision, &Geom::role);
  return System<double>(model, search_of(static_cast<std::size_t>(count)));
}

/// What a large world's key tells, which was made for so many colliders.
CachedContact contact_of(double key, std::size_t colliders) {
  const auto whole = static_cast<std::size_t>(key);
  const std::size_t pair = whole / kManifoldPoints;
  return {.low = pair / colliders, .high = pair % colliders, .number = whole % kManifoldPoints};
}

double key_of(const CachedContact& c, std::size_t colliders) {
  return static_cast<double>(kManifoldPoints * (c.low * colliders + c.high) + c.number);
}

bool in_order(const CachedContact& a, const CachedContact& b) {
  return std::tie(a.low, a.high, a.number) < std::tie(b.low, b.high, b.number);
}

/// How many of the first n are marked.
std::size_t marks_before(const std::vector<std::uint8_t>& marks, std::size_t n) {
  const auto end = marks.begin() + static_cast<std::ptrdiff_t>(std::min(n, marks.size()));
  return static_cast<std::size_t>(std::count(marks.begin(), end, 1));
}

/// The index of the one before which n are not marked; what lies behind all marks is not.
std::size_t unmarked(const std::vector<std::uint8_t>& marks, std::size_t n) {
  std::size_t i = 0;
  for (std::size_t left = n; i < marks.size(); ++i) {
    if (marks[i] != 0) continue;
    if (left-- == 0) return i;
  }
  return n + marks_before(marks, marks.size());
}

/// Where the items of fields go. `rows`: of equality constraints.
FieldInsertion places_of(const Insertion& at, const ListInsertion& rows, const Model& part) {
  const auto behind = [](int old_size, std::size_t new_size) {
    return ListInsertion{old_size, old_size, 0, static_cast<int>(new_size)};
  };
  FieldInsertion places{};
  const auto put = [&](Each each, const ListInsertion& list) { places[static_cast<std::size_t>(each)] = list; };
  put(Each::kCoordinate, at.q);
  put(Each::kDof, at.v);
  put(Each::kActuator, behind(at.actuators, part.actuators().size()));
  put(Each::kEqualityRow, rows);
  put(Each::kBody, at.bodies);
  put(Each::kGeom, behind(at.geoms, part.geoms().size()));
  put(Each::kLink, behind(at.links, part.links().size() - 1));
  put(Each::kLift, behind(at.lifts, part.lifts().size()));
  const auto mocaps = static_cast<int>(kPoseNumbers) * at.mocaps;
  put(Each::kMocapNumber, behind(mocaps, kPoseNumbers * part.mocap_bodies().size()));
  put(Each::kTendon, behind(at.tendons, part.tendons().size()));
  put(Each::kActivation, behind(at.activations, static_cast<std::size_t>(part.na())));
  return places;
}

/// Rows of the equality constraints that come first.
int rows_before(const Tree<double>& tree, int equality) {
  const auto i = static_cast<std::size_t>(equality);
  return static_cast<int>(i < tree.equalities.size() ? tree.equalities[i].row : tree.equality_rows);
}

}  // namespace

WorldCore::WorldCore(std::shared_ptr<const Model> shared_model)
    : WorldCore(required(shared_model), system_of(shared_model)) {}

WorldCore::WorldCore(Model own_model) : WorldCore(std::make_shared<Model>(std::move(own_model))) { owns_model_ = true; }

/// The contact cache lies beside the other numbers, so that it may change when parts do.
WorldCore::WorldCore(std::shared_ptr<const Model> shared_model, System<double> own_system)
    : WorldBlock<double>(*shared_model, 0),
      model(std::move(shared_model)),
      system(std::move(own_system)),
      step(system),
      runge_kutta(system.tree),
      scratch(system.tree),
      key_colliders_(system.colliders.geoms.size()) {
  state.resize_contact_cache(system.contact_numbers());
}

Model& WorldCore::own_model() {
  const bool is_shared = model.use_count() > 1;
  // use_count promises no order. To give a reference back comes after what others did who have let go of theirs.
  std::shared_ptr<const Model>(model).reset();
  if (!owns_model_ || is_shared) {
    model = std::make_shared<Model>(*model);
    owns_model_ = true;
  }
  owner.reset();
  return const_cast<Model&>(*model);  // made as one that may change
}

// ---- where bodies and geoms are ---------------------------------------------------------------------------------

const Workspace<double>& WorldCore::placed() const {
  if (!is_placed) place_from(1);
  is_placed = true;
  return scratch;
}

void WorldCore::place_from(std::size_t body) const {
  place_mocap(system.tree, state.mocap(), scratch);
  for (std::size_t b = body; b < system.tree.bodies.size(); ++b) {
    manyhands::place(system.tree, b, state.q(), scratch);
    move(system.tree, b, state.v(), scratch);
  }
}

const Workspace<double>& WorldCore::placed_lengths() const {
  const Workspace<double>& all = placed();
  place_lengths(system.tree, state.q(), state.v(), scratch);
  return all;
}

const GeomPlaces& WorldCore::placed_geoms() const {
  const std::size_t known = geom_places_.X_WG.size();
  geom_places_.extend(system.colliders, params, placed());
  for (std::size_t i = known; num_gone > 0 && i < geom_places_.X_WG.size(); ++i) {
    if (is_gone(LinkId(system.colliders.geoms[i].link))) geom_places_.remove(i);
  }
  return geom_places_;
}

// ---- parts ------------------------------------------------------------------------------------------------------

void WorldCore::insert(const Model& part, ContactRules rules) {
  const System<double> alone(part, PairSearch::kSwept);
  const WorldBlock<double> numbers(part, 0);
  ModelEdit edit(own_model());
  const Insertion at = edit.insert(part);
  edit.set_contact_rules(rules);
  Tree<double>& tree = system.tree;
  const ListInsertion rows{rows_before(tree, at.equalities.old_first), static_cast<int>(tree.equality_rows),
                           rows_before(alone.tree, at.equalities.new_first),
                           static_cast<int>(alone.tree.equality_rows)};
  if (tree.is_plain() && alone.tree.is_plain()) {
    tree.insert(alone.tree, at);
    tree.set_medium(*model);
  } else {
    tree = Tree<double>(*model);  // what else fills M may lie anywhere
    scratch = Workspace<double>(tree);
    is_placed = false;
  }
  WorldBlock<double>::insert(numbers, places_of(at, rows, part));
  for (const LinkId id : part.links_of(BodyId(0))) {
    const Link& link = part.link(id);
    RigidInertia<double>& world = params.inertia[0];
    world = world + transformed(link.X_BL, link.inertial.about_origin());
  }
  edit_colliders([&](Colliders<double>& colliders) {
    colliders.insert(alone.colliders, at, *model);
    colliders.rules = rules;
  });
  if (!gone_bodies_.empty()) {
    at.bodies.apply(gone_bodies_, std::vector<std::uint8_t>(static_cast<std::size_t>(at.bodies.new_size), 0));
  }
  scratch.resize(tree);
  if (is_placed) place_from(static_cast<std::size_t>(at.bodies.shifts() ? at.bodies.old_first : at.bodies.old_size));
  forget_topology();
}

void WorldCore::remove(LinkId link) {
  ModelEdit(own_model()).forget(link);
  gone_.resize(model->links().size(), 0);
  gone_bodies_.resize(model->bodies().size(), 0);
  gone_[link.index()] = 1;
  const BodyId body = model->link(link).body;
  if (body.value() > 0 && model->body(body).joint == model->link(link).joint) gone_bodies_[body.index()] = 1;
  ++num_gone;
  gone_geoms_.resize(model->geoms().size(), 0);
  for (const GeomId geom : model->geoms_of(link)) {
    gone_geoms_[geom.index()] = 1;
    const int collider = system.colliders.collider_of[geom.index()];
    const bool is_known = collider >= 0 && static_cast<std::size_t>(collider) < geom_places_.X_WG.size();
    if (is_known) geom_places_.remove(static_cast<std::size_t>(collider));
  }
  forget_topology();
}

bool WorldCore::is_gone(const Actuator& actuator) const {
  if (actuator.joint.is_valid()) return is_gone(model->joint(actuator.joint).child);
  const auto lacks = [&](LinkId id) { return id.is_valid() && is_gone(id); };
  return actuator.site && (lacks(actuator.site->link) || lacks(actuator.site->reference));
}

LinkId WorldCore::shown(LinkId id) const { return LinkId(id.index() - marks_before(gone_, id.index())); }
GeomId WorldCore::shown(GeomId id) const { return GeomId(id.index() - marks_before(gone_geoms_, id.index())); }
LinkId WorldCore::hidden(LinkId id) const { return LinkId(unmarked(gone_, id.index())); }
GeomId WorldCore::hidden(GeomId id) const { return GeomId(unmarked(gone_geoms_, id.index())); }

void WorldCore::set_excluded(LinkId a, LinkId b, bool excluded) {
  ModelEdit(own_model()).set_excluded(a, b, excluded);
  edit_colliders([&](Colliders<double>& colliders) { colliders.set_excluded(a, b, excluded); });
  forget_topology();
}

void WorldCore::set_inertial(LinkId link, const Inertial& inertial) {
  ModelEdit(own_model()).set_inertial(link, inertial);
  const WorldView<double> numbers = view(0);
  set_link_mass(*model, link, inertial.mass, numbers.extras.link_mass, numbers.params);
}

void WorldCore::set_equality(std::size_t index, const EqualityConstraint& equality) {
  ModelEdit(own_model()).set_equality(index, equality);
  system.tree.set_equalities(*model);
}

void WorldCore::aim_equality(std::size_t index, const EqualityConstraint& equality) {
  TreeEquality<double>& row = system.tree.equalities[index];
  row.ratio = equality.ratio;
  row.offset = equality.offset;
  row.max_force = equality.max_force;
  if (!equality.link_a.is_valid() || !equality.link_b.is_valid()) return;
  row.X_BA = model->link(equality.link_a).X_BL * equality.X_LA;
  row.X_BB = model->link(equality.link_b).X_BL * equality.X_LB;
}

template <class Change>
void WorldCore::edit_colliders(Change&& change) {
  Colliders<double>& colliders = system.colliders;
  const bool was_listed = colliders.search == PairSearch::kListed;
  const std::vector<CachedContact> kept = was_listed ? cached_contacts() : std::vector<CachedContact>();
  change(colliders);
  if (!was_listed) return;
  colliders.list_pairs(search_of(colliders.geoms.size()));
  let_resist_turning(view(0).params, colliders);
  cache_contacts(kept);
}

/// The impulses of equality constraints go too: their rows may be those of others now.
void WorldCore::forget_topology() {
  std::ranges::fill(state.equality_impulses(), 0.0);
  step_fits_ = false;
  forget_step();
}

void WorldCore::prepare_step() {
  if (step_fits_) return;
  step = StepWorkspace<double>(system);
  runge_kutta = RungeKutta<double>(system.tree);
  step_fits_ = true;
}

/// Where pairs are listed, nearly all manifolds are empty: the others are those of the last step, or must be looked
/// for.
void WorldCore::keep_start() {
  if (system.colliders.search == PairSearch::kSwept) return keep_all(before);
  before.assign(state.numbers().begin(), state.numbers().end());
  contacts_before_.clear();
  const std::span<const CachedManifold<double>> cache = cached_manifolds(std::as_const(state).contact_cache());
  const auto keep = [&](std::size_t place) {
    if (cache[place].used != 0) contacts_before_.push_back({place, cache[place]});
  };
  if (has_stepped && cache_is_of_step_) {
    for (const ContactPatch<double>& patch : step.contact.problem.patches) keep(patch.manifold);
  } else {
    for (std::size_t i = 0; i < cache.size(); ++i) keep(i);
  }
  cache_is_of_step_ = true;
}

void WorldCore::return_to_start() {
  if (system.colliders.search == PairSearch::kSwept) return put_back(false, before);
  std::ranges::copy(before, state.numbers().begin());
  state.resize_contact_cache(system.contact_numbers());
  const std::span<CachedManifold<double>> cache = cached_manifolds(state.contact_cache());
  for (const KeptManifold& kept : contacts_before_) cache[kept.place] = kept.manifold;
}

void WorldCore::forget_step() {
  has_stepped = false;
  step.contact.problem.points.clear();
  step.contact.problem.torsions.clear();
}

std::span<const double> WorldCore::living(const double* numbers, Each each, std::vector<double>& shown) const {
  if (num_gone == 0) return {numbers, state_layout()[each]};
  shown.clear();
  if (each == Each::kActuator || each == Each::kActivation) {
    for (std::size_t i = 0; i < nu(); ++i) {
      const Actuator& actuator = model->actuators()[i];
      const int place = each == Each::kActuator ? static_cast<int>(i) : actuator.iact;
      if (place >= 0 && !is_gone(actuator)) shown.push_back(numbers[place]);
    }
    return shown;
  }
  for (std::size_t b = 1; b < system.tree.bodies.size(); ++b) {
    if (gone_bodies_[b] != 0) continue;
    const TreeBody<double>& body = system.tree.bodies[b];
    const bool is_q = each == Each::kCoordinate;
    const double* first = numbers + (is_q ? body.iq : body.iv);
    shown.insert(shown.end(), first, first + (is_q ? configuration_size(body.type) : body.nv));
  }
  return shown;
}

// ---- the contact cache ------------------------------------------------------------------------------------------

std::vector<CachedContact> WorldCore::cached_contacts() const {
  const Colliders<double>& colliders = system.colliders;
  std::vector<CachedContact> found;
  const auto add = [&](CachedContact contact, std::size_t manifold) {
    const auto numbers = state.contact_cache().subspan(manifold * kManifoldNumbers<double>, kManifoldNumbers<double>);
    if (numbers[1] == 0) return;  // carries nothing
    std::ranges::copy(numbers, contact.numbers.begin());
    found.push_back(contact);
  };
  if (colliders.search == PairSearch::kSwept) {
    for (std::size_t i = 0; i < state.contact_cache().size() / kManifoldNumbers<double>; ++i) {
      add(contact_of(state.contact_cache()[i * kManifoldNumbers<double>], key_colliders_), i);
    }
    return found;
  }
  for (const ColliderPair& pair : colliders.pairs) {
    for (std::size_t k = 0; k < pair.manifolds; ++k) {
      add({.low = std::min(pair.a, pair.b), .high = std::max(pair.a, pair.b), .number = k}, pair.manifold + k);
    }
  }
  return found;
}

void WorldCore::cache_contacts(std::vector<CachedContact> contacts) {
  const Colliders<double>& colliders = system.colliders;
  std::ranges::sort(contacts, in_order);
  key_colliders_ = colliders.geoms.size();
  cache_is_of_step_ = false;
  const bool swept = colliders.search == PairSearch::kSwept;
  state.resize_contact_cache(swept ? contacts.size() * kManifoldNumbers<double> : system.contact_numbers());
  const auto put = [&](const CachedContact& contact, double key, std::size_t manifold) {
    const auto numbers = state.contact_cache().subspan(manifold * kManifoldNumbers<double>, kManifoldNumbers<double>);
    std::ranges::copy(contact.numbers, numbers.begin());
    numbers[0] = key;
  };
  for (std::size_t i = 0; swept && i < contacts.size(); ++i) put(contacts[i], key_of(contacts[i], key_colliders_), i);
  for (const ColliderPair& pair : colliders.pairs) {
    for (std::size_t k = 0; k < pair.manifolds; ++k) {
      const CachedContact which{.low = std::min(pair.a, pair.b), .high = std::max(pair.a, pair.b), .number = k};
      const auto found = std::ranges::lower_bound(contacts, which, in_order);
      if (found != contacts.end() && !in_order(which, *found)) put(*found, 0, pair.manifold + k);
    }
  }
}

void WorldCore::refresh_keys() {
  const std::size_t colliders = system.colliders.geoms.size();
  if (key_colliders_ == colliders) return;
  if (system.colliders.search == PairSearch::kSwept) {
    for (CachedManifold<double>& manifold : cached_manifolds(state.contact_cache())) {
      manifold.key = key_of(contact_of(manifold.key, key_colliders_), colliders);
    }
  }
  key_colliders_ = colliders;
}

std::pair<std::size_t, std::size_t> WorldCore::colliders_of(const ContactPatch<double>& patch) const {
  const Colliders<double>& colliders = system.colliders;
  if (colliders.search == PairSearch::kListed) {
    const ColliderPair& pair = colliders.pairs[patch.pair];
    return {pair.a, pair.b};
  }
  const std::size_t first = patch.manifold * kManifoldNumbers<double>;
  const CachedContact contact = contact_of(state.contact_cache()[first], key_colliders_);
  const std::optional<ColliderPair> pair = colliders.pair_of(contact.low, contact.high);
  return {pair->a, pair->b};
}

}  // namespace manyhands
