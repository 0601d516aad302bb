// What a World holds of one model; it grows with the model in place. Internal to World.
#pragma once

#include <map>
#include <memory>

#include "manyhands/model/compose.h"
#include "manyhands/model/model_edit.h"
#include "manyhands/physics/collision/queries/queries.h"
#include "manyhands/physics/dynamics/energy.h"
#include "manyhands/physics/step/energy_balance.h"
#include "manyhands/physics/step/runge_kutta.h"
#include "manyhands/physics/world/parameters.h"
#include "manyhands/physics/world/snapshot.h"

namespace manyhands {

/// A manifold of the contact cache that carried something, by its colliders.
struct CachedContact {
  std::size_t low{}, high{}, number{};  ///< colliders, low < high; which of the manifolds between them
  std::array<double, kManifoldNumbers<double>> numbers{};
};

/// A block of one world, and what it shares with no other. A copy is another world in the same state.
///
/// Edits cost what they touch. Added parts join the model, the tree, the colliders and all numbers in place. Removed
/// ones lose their names and meet no query, but keep their places until they are swept out (`World::core`). What a step
/// needs besides is made anew before the next step.
struct WorldCore : WorldBlock<double> {
  explicit WorldCore(std::shared_ptr<const Model> shared_model);
  explicit WorldCore(Model own_model);

  /// Poses and velocities of all bodies in the present state.
  [[nodiscard]] const Workspace<double>& placed() const;
  /// The same with the lengths of tendons.
  [[nodiscard]] const Workspace<double>& placed_lengths() const;
  /// Of all colliding geoms; what was removed meets nothing.
  [[nodiscard]] const GeomPlaces& placed_geoms() const;
  void moved() {
    is_placed = false;
    geom_places_.clear();
  }
  /// What a step found is gone: contacts and reactions are those of no step.
  void forget_step();
  /// Makes `step` and `runge_kutta` fit the model.
  void prepare_step();
  /// Writes down the state from which a step goes, and goes back to it.
  void keep_start();
  void return_to_start();

  /// Takes in the parts of a model, and from now on goes by the rules. Throws ModelError, and changes nothing, if a
  /// name is taken.
  void insert(const Model& part, ContactRules rules);
  /// Removes a link, its joint and its geoms; not what hangs on it.
  void remove(LinkId link);
  [[nodiscard]] bool is_gone(LinkId link) const { return link.index() < gone_.size() && gone_[link.index()] != 0; }
  [[nodiscard]] bool is_gone(const Actuator& actuator) const;
  [[nodiscard]] const std::vector<std::uint8_t>& gone() const { return gone_; }  ///< (some links) 1 where removed
  /// Gives a link other mass properties, in the model too.
  void set_inertial(LinkId link, const Inertial& inertial);
  /// Adds an equality constraint, or takes one away, in the model alone: the core is to be made anew.
  void add_equality(const EqualityConstraint& equality) { ModelEdit(own_model()).add_equality(equality); }
  void remove_equality(std::size_t index) { ModelEdit(own_model()).remove_equality(index); }
  /// Gives the constraint of that index other numbers; what it joins stays.
  void set_equality(std::size_t index, const EqualityConstraint& equality);
  /// The same for steps alone.
  void aim_equality(std::size_t index, const EqualityConstraint& equality);
  /// Puts a link that is welded to the world elsewhere, once the core is rebuilt (`World::rebuild`).
  void place_root(LinkId link, const Transform<double>& X_WL) {
    new_places[link] = X_WL;
    forget_step();
  }
  /// The ids of `World::model`, which has nothing that was removed, for those of `model`, and back.
  [[nodiscard]] LinkId shown(LinkId id) const;
  [[nodiscard]] GeomId shown(GeomId id) const;
  [[nodiscard]] LinkId hidden(LinkId shown_id) const;
  [[nodiscard]] GeomId hidden(GeomId shown_id) const;
  /// Whether two links may touch, as far as exclusions go.
  void set_excluded(LinkId a, LinkId b, bool excluded);
  /// Makes the numbers of q, v, tau, ctrl or act those of the parts that are there: in `shown`, where some were
  /// removed.
  [[nodiscard]] std::span<const double> living(const double* numbers, Each each, std::vector<double>& shown) const;

  [[nodiscard]] std::vector<CachedContact> cached_contacts() const;
  void cache_contacts(std::vector<CachedContact> contacts);
  /// Makes the keys of the contact cache fit the colliders.
  void refresh_keys();
  /// The colliders that a contact patch of the last step lies between, A first.
  [[nodiscard]] std::pair<std::size_t, std::size_t> colliders_of(const ContactPatch<double>& patch) const;

  [[nodiscard]] int num_geoms() const { return shown(GeomId(model->geoms().size())).value(); }  ///< that are there
  [[nodiscard]] std::size_t nq() const { return static_cast<std::size_t>(model->nq()); }
  [[nodiscard]] std::size_t nv() const { return static_cast<std::size_t>(model->nv()); }
  [[nodiscard]] std::size_t nu() const { return static_cast<std::size_t>(model->nu()); }
  /// q (nq) and v (nv) from which the last step went. In a world that grows there is room between them.
  [[nodiscard]] const double* q_before() const { return before.data(); }
  [[nodiscard]] const double* v_before() const { return before.data() + (state.v() - state.q()); }

  std::shared_ptr<const Model> model;
  System<double> system;
  std::vector<double> before;  ///< the state from which the last step went, but for contacts: see `v_before`
  StepWorkspace<double> step;
  EnergyBalance<double> balance{};
  RungeKutta<double> runge_kutta;
  std::vector<Force<double>> external_before;      ///< on links in the last step, about the world's origin
  std::map<LinkId, Transform<double>> new_places;  ///< of `place_root`
  std::size_t num_gone = 0;                        ///< links that were removed
  bool has_stepped = false;                        ///< whether `step` and `before` tell of a step
  mutable bool is_placed = false;
  mutable Workspace<double> scratch;             ///< holds `placed` while is_placed
  mutable std::optional<SnapshotOwner> owner{};  ///< what snapshots are of, once one is asked for

 private:
  /// A manifold of the contact cache, and its place there.
  struct KeptManifold {
    std::size_t place{};
    CachedManifold<double> manifold{};
  };

  WorldCore(std::shared_ptr<const Model> shared_model, System<double> shared_system);

  [[nodiscard]] Model& own_model();
  void place_from(std::size_t body) const;
  template <class Change>
  void edit_colliders(Change&& change);
  void forget_topology();

  std::vector<KeptManifold> contacts_before_;  // of the contact cache: those that carried something
  bool cache_is_of_step_ = false;              // whether what the cache holds are the contacts of the last step
  bool owns_model_ = false;                    // whether `model` was made here, as one that may change
  bool step_fits_ = true;
  std::size_t key_colliders_;  // for how many colliders the keys of the contact cache were made
  std::vector<std::uint8_t> gone_, gone_geoms_, gone_bodies_;  // 1 where removed; parts added since may be missing
  mutable GeomPlaces geom_places_;
};

/// Carries what survives from one core to the next: motion, commands, warm starts and parameters of parts that both
/// have. `map` tells where each part of `from` is in `to`.
void carry(const WorldCore& from, const PartMap& map, WorldCore& to);

}  // namespace manyhands
