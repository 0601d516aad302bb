// Models out of models: puts the parts of one into the builder of another, all of them or some.
#pragma once

#include <cstdint>

#include "manyhands/model/model_builder.h"

namespace manyhands {

/// Where the parts of a model have gone: for each one its index in the builder, or -1 where it was left out.
struct PartMap {
  std::vector<int> links, joints, geoms, actuators, tendons;

  /// The way through this map and then through `next`.
  [[nodiscard]] PartMap then(const PartMap& next) const;
};

struct AppendOptions {
  Transform<double> X_WM = Transform<double>::identity();  ///< where the model's world frame comes to lie, in `onto`
  std::string prefix{};                                    ///< goes before the name of every part
  std::span<const std::uint8_t> left_out{};                ///< (links) 1 for links that stay behind; empty: none
  LinkId onto{0};                                          ///< the builder's link that stands for the model's world
};

/// Adds copies of the model's parts; its world becomes the builder's, or the link `onto`, to which bases are fixed by
/// joints 'BASE_mount'. What hangs on the world is moved by X_WM: bases, geoms and joint frames, and for free bodies in
/// the world where they start, so that their q stays a pose in the world. A link that is left out takes along its
/// joint, geoms, tendons, equality constraints, actuators and what hangs on it; keyframes stay behind too. Gravity,
/// time step and the rules of contact are the builder's. Throws ModelError if a name is taken, or if there is no link
/// `onto`.
PartMap append(ModelBuilder& builder, const Model& model, const AppendOptions& options = {});

/// A builder that holds the model, its gravity, time step and rules of contact.
[[nodiscard]] ModelBuilder builder_of(const Model& model);

/// The pairs of links of one tree that have colliding geoms and do not move as one.
[[nodiscard]] std::vector<std::pair<LinkId, LinkId>> self_collisions(const Model& model);

/// Excludes contact between links of one tree: what `ContactRules::self_collision = false` says of the model alone, for
/// one that joins a world in which other robots may touch themselves.
void exclude_self_collision(ModelBuilder& builder, const Model& model, const PartMap& map);

}  // namespace manyhands
