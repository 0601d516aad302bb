// The model's colliding geoms and the pairs of them that may touch: uniform, the same for every world.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "manyhands/math/vec3.h"
#include "manyhands/model/insertion.h"
#include "manyhands/model/model.h"
#include "manyhands/physics/collision/surface/triangle_mesh.h"

namespace manyhands {

/// One colliding geom as kernels read it.
template <Real R>
struct Collider {
  ShapeType type{};    ///< a mesh that moves is its convex hull
  std::size_t geom{};  ///< index in Model::geoms() and in the geom arrays of Params
  std::size_t body{};
  std::size_t root{};       ///< Model::root_link of its link: alike for all parts of one mechanism
  std::size_t neighbour{};  ///< the body that a joint joins to this one towards the world
  std::size_t link{};
  std::size_t base{};  ///< on a body that hangs on the world: the link it is mounted on, 0 where it floats
  CollisionFilter filter{};
  bool is_still{};  ///< whether no joint moves it: on the world, or on a body that a user moves
  bool turned{};    ///< whether the shape's axes differ from the body's
  Transform<R> X_BG = Transform<R>::identity();
  R offset{};  ///< of its origin from the body's [m]
  SurfaceMaterial surface{};
  bool yields{};  ///< whether its surface gives way by a compliance
  R mobility{};   ///< of its link at the model's start, where surfaces do [1/kg]
  R margin{};
  std::shared_ptr<const ConvexPolyhedron> hull{};     ///< of a convex shape
  std::shared_ptr<const TriangleMesh> mesh{};         ///< of a mesh
  std::shared_ptr<const HeightField> height_field{};  ///< of a height field
  R radius{};                ///< of a sphere about the origin that holds the mesh, hull or height field [m]
  Vec3<R> centre{}, half{};  ///< of the box along the geom's axes that holds the hull [m]
};

/// Two geoms that may touch: A stands before B in the order sphere, capsule, cylinder, box, convex, plane, mesh, height
/// field.
struct ColliderPair {
  std::size_t a{}, b{};       ///< indices in Colliders::geoms
  std::size_t manifold{};     ///< the first of its manifolds in a list of all pairs'
  std::size_t manifolds = 1;  ///< how many it may have: more than one against meshes and height fields
  bool torsion{};             ///< whether its surfaces resist spinning or rolling
  int surface = -1;           ///< index in Colliders::surfaces where the pair has its own, else -1
};

enum class PairSearch {
  kListed,  ///< all pairs are known beforehand, and each is looked at in every step
  kSwept,   ///< a broad phase finds the pairs of each step: for one world with many geoms
};

/// Every colliding geom and, where they are listed, every pair that the model's rules let touch, sorted by shapes so
/// that a batch treats pairs of one kind together.
template <Real R>
struct Colliders {
  Colliders() = default;  ///< none
  explicit Colliders(const Model& model, PairSearch search = PairSearch::kListed);

  /// Takes in the colliders of a part that `ModelEdit::insert` put into `model`; pairs are listed by `list_pairs`.
  void insert(const Colliders& part, const Insertion& at, const Model& model);
  /// Lists the pairs anew, or none where a broad phase finds them.
  void list_pairs(PairSearch pair_search);
  /// Whether geoms of two links may touch, as far as exclusions go; see `list_pairs`.
  void set_excluded(LinkId a, LinkId b, bool excluded);

  /// The pair of two geoms, if they may touch.
  [[nodiscard]] std::optional<ColliderPair> pair_of(std::size_t a, std::size_t b) const;

  std::vector<Collider<R>> geoms;
  std::vector<int> collider_of;  ///< (geoms of the model) the index of each that collides, else -1
  PairSearch search = PairSearch::kListed;
  std::vector<ColliderPair> pairs;        ///< where they are listed
  std::vector<SurfaceMaterial> surfaces;  ///< of explicit pairs
  std::size_t num_manifolds{};            ///< of all pairs together
  ContactRules rules;

 private:
  [[nodiscard]] bool may_touch(std::size_t a, std::size_t b) const;

  std::vector<std::uint64_t> excluded_;                  // pairs of links, sorted
  std::vector<std::pair<std::uint64_t, int>> explicit_;  // pairs of colliders and their surface or -1, sorted
};

}  // namespace manyhands
