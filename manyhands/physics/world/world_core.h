// What a World holds of one model: made anew when its parts change. Internal to World.
#pragma once

#include <memory>

#include "manyhands/model/compose.h"
#include "manyhands/physics/dynamics/energy.h"
#include "manyhands/physics/step/runge_kutta.h"
#include "manyhands/physics/world/parameters.h"
#include "manyhands/physics/world/snapshot.h"

namespace manyhands {

/// A block of one world, and what it shares with no other. A copy is another world in the same state.
struct WorldCore : WorldBlock<double> {
  explicit WorldCore(std::shared_ptr<const Model> shared_model);

  /// Poses and velocities of all bodies in the present state.
  [[nodiscard]] const Workspace<double>& placed() const;
  void moved() { is_placed = false; }
  /// What a step found is gone: contacts and reactions are those of no step.
  void forget_step();

  /// The colliders that a contact patch of the last step lies between, A first.
  [[nodiscard]] std::pair<std::size_t, std::size_t> colliders_of(const ContactPatch<double>& patch) const;

  [[nodiscard]] std::size_t nq() const { return static_cast<std::size_t>(model->nq()); }
  [[nodiscard]] std::size_t nv() const { return static_cast<std::size_t>(model->nv()); }
  [[nodiscard]] std::size_t nu() const { return static_cast<std::size_t>(model->nu()); }

  std::shared_ptr<const Model> model;
  System<double> system;
  std::vector<double> before;  ///< the state from which the last step went, as keep_all writes it
  StepWorkspace<double> step;
  RungeKutta<double> runge_kutta;
  std::vector<Force<double>> external_before;  ///< on links in the last step, about the world's origin
  bool has_stepped = false;                    ///< whether `step` and `before` tell of a step
  mutable bool is_placed = false;
  mutable Workspace<double> scratch;                   ///< holds `placed` while is_placed
  mutable std::optional<std::uint64_t> fingerprint{};  ///< of the model, once it is asked for

 private:
  WorldCore(std::shared_ptr<const Model> shared_model, System<double> shared_system);
};

/// Carries what survives from one core to the next: motion, commands, warm starts and parameters of parts that both
/// have. `map` tells where each part of `from` is in `to`.
void carry(const WorldCore& from, const PartMap& map, WorldCore& to);

}  // namespace manyhands
