// The model's kinematic tree in the precision of a kernel.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "manyhands/math/spatial.h"
#include "manyhands/model/insertion.h"
#include "manyhands/model/model.h"
#include "manyhands/physics/dynamics/params.h"
#include "manyhands/physics/dynamics/yielding.h"

namespace manyhands {

class StartMobility;

/// Numbers of a mocap body's pose: x y z [m], quaternion xyzw.
inline constexpr std::size_t kPoseNumbers = 7;

/// How a joint frame is turned in its parent: robots are full of quarter turns, which cost no products.
enum class Turn {
  kNone,
  kQuarters,  ///< every axis of F is plus or minus one of the parent's
  kGeneral,
};

/// What a kernel reads of one body: uniform, the same for every world.
template <Real R>
struct TreeBody {
  int parent{};  ///< 0 is the world
  JointType type{};
  int iq{}, iv{}, nv{};
  Turn turn{};
  bool shifted{};  ///< whether F's origin is off the parent's
  std::array<std::int8_t, 3>
      axes{};  ///< for kQuarters, F's x, y and z: 1, 2, 3 for the parent's x, y, z, minus if reversed
  Transform<R> X_PF = Transform<R>::identity();
  R gyration{};   ///< square of its radius of gyration about the centre of mass [m^2]
  int lift = -1;  ///< index of its part that gravity compensation carries; -1 without one
};

/// A drive of the model as kernels read it.
template <Real R>
struct TreeActuator {
  ActuatorType type{};
  std::size_t law{};        ///< the dof that it drives; of tendons and sites nv more than the length
  std::size_t q{};          ///< the coordinate it measures; of tendons and sites the length
  R scale = 1, offset = 0;  ///< scale ctrl + offset is its command
  R period{};               ///< of a position servo whose length is an angle: its error is taken within half of it
  R middle_force{};         ///< about which its bounds lie
  bool is_shared{};         ///< whether another bounded drive acts on the same dof or length
  std::array<R, 3> gain{}, bias{};  ///< of kAffine
  ActivationType activation{};
  int act = -1;  ///< index of its activation
  R time_constant{}, least_act{}, most_act{};
  bool early{};  ///< whether its command is the activation at the step's end

  [[nodiscard]] bool is_scaled() const { return scale != 1 || offset != 0; }
};

enum class LengthType {
  kJoints,    ///< the sum of coefficient q over joints
  kPath,      ///< the way from point to point
  kCoupling,  ///< (b - reference_b) - polynomial(a - reference_a), of two other lengths
  kSite,      ///< where an actuator's site is from its reference
};

/// What a dof does to one end of a segment: sign -1 where it moves the first.
template <Real R>
struct TreeLever {
  std::size_t dof{}, entry{};  ///< the entry of J to which it adds
  R sign{};
};

/// A straight part of a path between points of two bodies.
template <Real R>
struct TreeSegment {
  std::size_t body_a{}, body_b{};
  Vec3<R> p_A{}, p_B{};  ///< in the bodies' frames [m]
  R share{};             ///< what of it counts as length
  std::vector<TreeLever<R>> levers{};
};

/// A wrench at a site S of body A, against one at R of body B, along which an actuator acts (see ActuatorSite).
template <Real R>
struct TreeSite {
  std::size_t body_a{}, body_b{};
  Transform<R> X_AS = Transform<R>::identity(), X_BR = Transform<R>::identity();
  bool has_reference{};
  Vec3<R> force{}, torque{};  ///< in the axes of R, without it of S
  std::vector<TreeLever<R>> levers{};
};

/// A number that follows from q, and moves by J v: the length of a tendon, what couples two of them, what limits that
/// give way hold in bounds, or where a site is.
template <Real R>
struct TreeLength {
  LengthType type{};
  std::vector<int> dofs{};                        ///< on which it depends, ascending: the entries of J
  std::size_t J{};                                ///< the first of them in Workspace::length_J
  std::vector<int> q{};                           ///< of kJoints: their coordinates
  std::vector<R> weights{};                       ///< of kJoints: their coefficients
  std::vector<TreeSegment<R>> segments{};         ///< of kPath
  int a = -1, b = -1;                             ///< of kCoupling: the lengths; without a it counts as 0
  std::vector<int> in_a{}, in_b{};                ///< of kCoupling, by entry: its place among those of a and b, or -1
  std::array<R, 5> polynomial{};                  ///< of kCoupling
  R reference_a{}, reference_b{}, max_force{};    ///< of kCoupling
  std::optional<TreeCompliance<R>> compliance{};  ///< of couplings and limits that give way
  R mobility{};                                   ///< W of the compliance
  int limited = -1;    ///< whose limits give way by this length: a dof, or nv more than a tendon; else -1
  bool stops = true;   ///< whether it has limits that hold exactly, as tendons may
  TreeSite<R> site{};  ///< of kSite
};

/// An equality constraint of the model between two bodies, or two dofs, as kernels read it.
template <Real R>
struct TreeEquality {
  EqualityType type{};
  std::size_t body_a{}, body_b{};                                                 ///< the rows' dofs lie between them
  Transform<R> X_BA = Transform<R>::identity(), X_BB = Transform<R>::identity();  ///< the frames on their bodies
  std::size_t dof_a{}, dof_b{}, q_a{}, q_b{};                                     ///< of kJoint and kGear
  R ratio{}, offset{}, max_force{};
  std::size_t row{};                              ///< its first row of three
  bool turns{};                                   ///< whether three rows of rotation follow the first three
  std::optional<TreeCompliance<R>> compliance{};  ///< what gives way is a force, and no row
  R linear{}, angular{};                          ///< W of the compliance; of joints the first [1/kg, 1/(kg m^2)]
  R arm{};                                        ///< of the compliance: how a rotation counts as an error [m/rad]

  [[nodiscard]] bool joins_bodies() const { return type != EqualityType::kJoint && type != EqualityType::kGear; }
};

/// A link in a medium: see drag.h.
template <Real R>
struct TreeDrag {
  std::size_t body{};
  Transform<R> X_BK = Transform<R>::identity();  ///< the box of its inertia
  R linear{}, angular{};                         ///< drag per velocity [N s/m, N m s/rad]
  Vec3<R> per_speed{}, per_rate{};               ///< and how that grows with it, by axis
};

/// The uniform part of a model for kernels of real type R.
template <Real R>
struct Tree {
  explicit Tree(const Model& model);
  /// As if no constraint gave way.
  [[nodiscard]] static Tree rigid(const Model& model) { return Tree(model, nullptr); }

  /// Whether nothing but joints fills M: then it takes in others as they are.
  [[nodiscard]] bool is_plain() const;
  /// Takes in the tree of a part that `ModelEdit::insert` put into the model. Both are plain.
  void insert(const Tree& part, const Insertion& at);
  /// Takes over the model's equality constraints anew.
  void set_equalities(const Model& model);
  /// Of dofs, and behind them of lengths.
  [[nodiscard]] int num_laws() const { return nv + static_cast<int>(lengths.size()); }
  /// Takes over the model's medium, and the links that it drags on.
  void set_medium(const Model& model);
  /// The dofs that move the body, leaves first.
  [[nodiscard]] std::span<const int> path_of(std::size_t body) const {
    return std::span(path).subspan(path_begin[body], path_begin[body + 1] - path_begin[body]);
  }
  /// Widens the ranges of dofs until no equality constraint leaves its own and no two overlap in part.
  void join_clusters();

  int nb{};  ///< bodies, the world included
  int nq{}, nv{};
  std::vector<TreeBody<R>> bodies;         ///< (nb)
  std::vector<int> dof_parent;             ///< (nv) next dof towards the root, or -1
  std::vector<int> M_parent;               ///< (nv) the same in M's pattern, in which tendons join branches: entry
                                           ///< (i, j) may be other than 0 where that way from i passes j
  std::vector<std::size_t> M_joined;       ///< entries of M, as stored, that only tendons fill
  std::vector<int> root_dof;               ///< (nv) first dof of the dof's tree; trees take consecutive dofs, and those
                                           ///< that tendons join are one
  std::vector<int> end_dof;                ///< (nv) one past the last dof of the dof's tree
  std::vector<int> last_dof;               ///< (nb) the body's last dof, or its next ancestor's; -1 if it never moves
  std::vector<int> path;                   ///< of each body: the dofs that move it, leaves first
  std::vector<std::size_t> path_begin;     ///< (nb + 1) where that begins
  std::vector<std::ptrdiff_t> M_row;       ///< (nv) M[M_row[i] + j] is entry (i, j <= i) within a tree; trees follow
                                           ///< each other, and nothing is stored between them
  std::size_t M_size{};                    ///< numbers in M
  std::vector<int> dofs_from_leaves;       ///< (nv) nv - 1, ..., 0
  std::vector<int> dof_q;                  ///< (nv) the coordinate that the dof integrates, or -1
  std::vector<std::uint8_t> dof_limited;   ///< (nv) whether the joint has position limits
  std::vector<std::uint8_t> dof_stops;     ///< (nv) whether these hold exactly; those that give way are lengths
  std::vector<TreeActuator<R>> actuators;  ///< (nu)
  std::vector<std::size_t> lifted_bodies;  ///< that gravity compensation acts on, in the order of Model::lifts
  std::vector<std::size_t> mocap_bodies;   ///< that a user moves
  std::vector<TreeDrag<R>> drags;          ///< of links that move, in a medium
  Vec3<R> wind{};                          ///< the medium's velocity [m/s]
  std::vector<TreeEquality<R>> equalities;
  std::vector<TreeLength<R>> lengths;  ///< of tendons, then of equality constraints between them, then of limits that
                                       ///< give way, then of actuators at sites
  std::size_t length_entries{};        ///< of J, over all lengths
  std::size_t equality_rows{};         ///< three for every equality constraint, six where it holds rotations
  std::vector<int>
      cluster_begin;  ///< (nv) first dof of the trees that equality constraints join to the dof's, as one range
  std::vector<int> cluster_end;  ///< (nv) one past their last
  std::vector<int> dof_drive;    ///< (nv, lengths) an actuator other than a force that acts on the dof or length, or -1

 private:
  /// `start`: null where nothing gives way.
  Tree(const Model& model, const StartMobility* start);
  void add_equalities(const Model& model, const StartMobility* start);
};

/// Rows of all equality constraints of a model: three each, six where they hold rotations.
[[nodiscard]] std::size_t equality_rows(const Model& model);

}  // namespace manyhands
