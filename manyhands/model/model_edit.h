// Changes a compiled model in place, at a cost that does not depend on the parts left alone.
#pragma once

#include "manyhands/model/insertion.h"
#include "manyhands/model/model.h"

namespace manyhands {

/// For the owner of a model that nobody else holds. Keyframes are dropped when their sizes no longer fit.
class ModelEdit {
 public:
  explicit ModelEdit(Model& model) : model_(model) {}

  /// Takes in the parts of another model, as if both had been built together: its world is the same world, its bodies
  /// stand behind those that hang on the world in the same way, and its parts behind the others of their kind. Gravity,
  /// time step and the rules of contact stay. Throws ModelError, and changes nothing, if a name is taken.
  Insertion insert(const Model& part);

  /// Takes away the names of a link, and of its joint, geoms and frames: they are not found any more, and their names
  /// are free. The parts stay where they are until the model is built anew without them.
  void forget(LinkId link);

  /// Equality constraints between parts that are there; what is compiled of them is to be made anew.
  void add_equality(const EqualityConstraint& equality);
  void set_equality(std::size_t index, const EqualityConstraint& equality) { model_.equalities_[index] = equality; }
  void remove_equality(std::size_t index);
  /// Gives a link other mass properties, and the body that carries it.
  void set_inertial(LinkId link, const Inertial& inertial);
  /// Whether two links may touch, as far as exclusions go.
  void set_excluded(LinkId a, LinkId b, bool excluded);
  void set_contact_rules(const ContactRules& rules) { model_.contact_rules_ = rules; }

 private:
  void require_free_names(const Model& part) const;
  [[nodiscard]] Insertion places_for(const Model& part) const;
  void shift_old(const Insertion& at);
  void insert_links(const Model& part, const Insertion& at);
  void insert_joints_and_bodies(const Model& part, const Insertion& at);
  void insert_frames(const Model& part, const Insertion& at);
  void insert_geoms(const Model& part, const Insertion& at);
  void insert_couplings(const Model& part, const Insertion& at);
  void insert_sensors(const Model& part, const Insertion& at);

  Model& model_;
};

}  // namespace manyhands
