// Goals of inverse kinematics that ask for less than a pose, and a posture to keep where they leave room.
#pragma once

#include <limits>
#include <vector>

#include "manyhands/base/index.h"
#include "manyhands/kinematics/inverse_kinematics.h"

namespace manyhands {

/// What a goal says of a frame's orientation.
enum class IkOrientation {
  kFull,       ///< all of it
  kFree,       ///< nothing
  kAxisAlong,  ///< an axis of the frame has a direction; the spin about it is free
  kAxisAt,     ///< an axis of the frame, from its origin, passes through a point; the spin about it is free
};

/// A goal, the same for all targets of a search.
struct IkGoal {
  IkOrientation orientation = IkOrientation::kFull;
  Vec3<double> axis{0, 0, 1};     ///< of the frame, of unit length, for kAxisAlong and kAxisAt
  double position_weight = 1;     ///< of a metre; 0 leaves the position free
  double rotation_weight = 1;     ///< of a radian; both count where not all can be had
  std::vector<double> posture{};  ///< (nq) to stay near; empty without one
};

/// Where a goal is: in the world, or in the base of the chain.
template <Number T>
struct IkTarget {
  Transform<T> X_WF;  ///< its rotation for kFull only
  Vec3<T> toward;     ///< for kAxisAlong a direction of unit length, for kAxisAt a point [m]
};

namespace internal {

inline constexpr double kPostureGain = 0.5;       ///< share of the way to the posture in one step
inline constexpr double kLongestPull = 0.5;       ///< of the posture on a joint in one step [rad or m]
inline constexpr double kNearer = 1 - 1e-6;       ///< how far a step must bring the distance down, or it has settled
inline constexpr double kProgress = 0.9;          ///< to what share the error must fall while patience lasts
inline constexpr double kNearestToLookAt = 1e-6;  ///< a point nearer than that has no direction [m]

/// The smallest rotation that takes the unit vector a to b, as a rotation vector.
template <Number T>
MANYHANDS_INLINE Vec3<T> rotation_between(const Vec3<T>& a, const Vec3<T>& b) {
  const T zero = constant<T>(0), one = constant<T>(1);
  const T w = one + dot(a, b);
  const auto opposite = w < T(8 * std::numeric_limits<real_t<T>>::epsilon());  // any half turn about a normal of a
  const Vec3<T> normal = select(abs(a.x) < constant<T>(0.7), Vec3<T>{zero, a.z, -a.y}, Vec3<T>{-a.z, zero, a.x});
  const Vec3<T> u = select(opposite, normal, cross(a, b));
  return rotation_vector(normalized(Quat<T>{u.x, u.y, u.z, select(opposite, zero, w)}));
}

/// A goal made linear at a pose of the frame: e = row(J) dq, weighted. Directions that the goal leaves free are filled
/// with ones, so that the system has a solution there, which is 0.
template <Number T>
struct GoalEquations {
  Motion<T> e;      ///< error, angular first
  Vec3<T> axis{};   ///< in the world
  Vec3<T> lever{};  ///< of kAxisAt: direction over distance, by which the origin's velocity turns the direction [1/m]
  T wp{}, wr{};
  IkOrientation orientation{};
  bool places{};  ///< whether the position counts

  MANYHANDS_INLINE GoalEquations(const IkGoal& goal, const IkTarget<T>& target, const Transform<T>& X_WF)
      : wp(constant<T>(goal.position_weight)),
        wr(constant<T>(goal.rotation_weight)),
        orientation(goal.orientation),
        places(goal.position_weight > 0) {
    if (orientation == IkOrientation::kFull) {
      e = pose_error(target.X_WF, X_WF);
    } else {
      e = {Vec3<T>::zero(), target.X_WF.p - X_WF.p};
      if (orientation != IkOrientation::kFree) point(goal, target, X_WF);
    }
    e = {wr * e.w, wp * e.v};
  }

  /// The row of a dof that moves the frame by J, at its origin in world axes.
  [[nodiscard]] MANYHANDS_INLINE Motion<T> row(const Motion<T>& J) const {
    const Vec3<T> v = wp * J.v;
    if (orientation == IkOrientation::kFull) return {wr * J.w, v};
    if (orientation == IkOrientation::kFree) return {Vec3<T>::zero(), v};
    const Vec3<T> turn = orientation == IkOrientation::kAxisAt ? J.w + cross(lever, J.v) : J.w;
    return {wr * fma(-dot(axis, turn), axis, turn), v};
  }

  MANYHANDS_INLINE void fill_free(SymMat6<T>& A) const {
    const Mat3<T> one = Mat3<T>::identity();
    const Vec3<T> none = Vec3<T>::zero();
    if (orientation == IkOrientation::kAxisAlong || orientation == IkOrientation::kAxisAt)
      A.add_outer_product({axis, none});
    if (orientation == IkOrientation::kFree)
      for (const Vec3<T>& n : {one.x, one.y, one.z}) A.add_outer_product({n, none});
    if (!places)
      for (const Vec3<T>& n : {one.x, one.y, one.z}) A.add_outer_product({none, n});
  }

 private:
  MANYHANDS_INLINE void point(const IkGoal& goal, const IkTarget<T>& target, const Transform<T>& X_WF) {
    axis = X_WF.R * broadcast<T>(goal.axis);
    Vec3<T> direction = target.toward;
    if (orientation == IkOrientation::kAxisAt) {
      const Vec3<T> way = target.toward - X_WF.p;
      const T distance = norm(way), least = constant<T>(kNearestToLookAt);
      const T inverse = constant<T>(1) / max(distance, least);
      direction = select(distance < least, -axis, inverse * way);
      lever = inverse * direction;
    }
    e.w = rotation_between(axis, direction);
  }
};

/// A posture's part in a solve: a step towards it wherever the goal is reached, and the nearest q that reaches it,
/// which the workspace keeps. So limits and curvature that take a step off the goal cost that step only.
template <Number T>
class PostureSearch {
 public:
  MANYHANDS_INLINE PostureSearch(const IkGoal& goal, const Tree<real_t<T>>& tree, const IkChain& chain, T* q,
                                 Workspace<T>& ws)
      : goal_(goal), tree_(tree), chain_(chain), q_(q), kept_(ws.u.data()) {}

  [[nodiscard]] bool is_wanted() const { return !goal_.posture.empty(); }

  /// Keeps q where it reaches the goal and is nearer than before; whether the solve goes on from there.
  MANYHANDS_INLINE mask_t<T> keep(const mask_t<T>& active, const mask_t<T>& reached) {
    T distance = constant<T>(0);
    for (const std::size_t i : chain_.dofs) distance = distance + square(way(i));
    const mask_t<T> nearer(active & reached & (distance < constant<T>(square(kNearer)) * distance_));
    distance_ = select(nearer, distance, distance_);
    for (const std::size_t i : chain_.dofs) kept_[i] = select(nearer, q_[index(tree_.dof_q[i])], kept_[i]);
    pulls_ = reached;
    return mask_t<T>(nearer | !reached);
  }

  /// Where it pulls in this step.
  [[nodiscard]] MANYHANDS_INLINE const mask_t<T>& pulls() const { return pulls_; }

  /// Of dof i in this step.
  [[nodiscard]] MANYHANDS_INLINE T pull(std::size_t i) const {
    const T longest = constant<T>(kLongestPull), zero = constant<T>(0);
    return select(pulls_, clamp(constant<T>(kPostureGain) * way(i), -longest, longest), zero);
  }

  /// Lane k begins anew.
  void forget(int k) { set_lane(distance_, k, std::numeric_limits<real_t<T>>::infinity()); }

  /// Lane k of q becomes what is kept, if anything is.
  bool take_kept(int k) {
    if (!is_wanted() || !is_finite(lane(distance_, k))) return false;
    for (const std::size_t i : chain_.dofs) set_lane(q_[index(tree_.dof_q[i])], k, lane(kept_[i], k));
    return true;
  }

  MANYHANDS_INLINE void take_kept() {
    const mask_t<T> any_kept(distance_ < constant<T>(std::numeric_limits<double>::infinity()));
    for (const std::size_t i : chain_.dofs) {
      T& qi = q_[index(tree_.dof_q[i])];
      qi = select(any_kept, kept_[i], qi);
    }
  }

 private:
  [[nodiscard]] MANYHANDS_INLINE T way(std::size_t i) const {
    const std::size_t j = index(tree_.dof_q[i]);
    return constant<T>(goal_.posture[j]) - q_[j];
  }

  const IkGoal& goal_;
  const Tree<real_t<T>>& tree_;
  const IkChain& chain_;
  T* q_;
  T* kept_;  // (nv)
  T distance_ = constant<T>(std::numeric_limits<double>::infinity());
  mask_t<T> pulls_{false};
};

}  // namespace internal

/// A solve in progress. `look`, then `step` those that go on; again, until none does.
///
/// Where the goal is reached a posture pulls in the null space, dq = z + J^T (J J^T + lambda 1)^-1 (e - J z) with
/// z = gain (posture - q), as long as that brings q nearer to it. Errors of what the goal leaves free are 0.
template <Number T, Number P>
class GoalSolve {
 public:
  /// `q` (nq) is where the solve begins and what it moves; `target` may change between solves of a lane.
  MANYHANDS_INLINE GoalSolve(const Tree<real_t<T>>& tree, const Params<P>& params, const IkChain& chain,
                             const IkSettings& settings, const IkGoal& goal, const IkTarget<T>& target, T* q,
                             Workspace<T>& ws)
      : tree_(tree),
        params_(params),
        chain_(chain),
        settings_(settings),
        goal_(goal),
        target_(target),
        q_(q),
        ws_(ws),
        X_BF_(broadcast<real_t<T>>(chain.X_BF)),
        position_tolerance_(constant<T>(square(goal.position_weight * settings.position_tolerance))),
        rotation_tolerance_(constant<T>(square(goal.rotation_weight * settings.rotation_tolerance))),
        equations_(goal, target, Transform<T>::identity()),
        posture_(goal, tree, chain, q, ws) {}

  /// How far q is from the goal.
  MANYHANDS_INLINE void look() {
    const Transform<T> X_WF = place_chain(tree_, chain_, X_BF_, q_, ws_);
    p_OF_ = X_WF.p - ws_.p_WO[chain_.body.index()];
    if (chain_.base) {
      equations_ = internal::GoalEquations<T>(goal_, target_in_world(), X_WF);
      p_QF_ = X_WF.p - ws_.p_WO[chain_.base->body.index()];
    } else {
      equations_ = internal::GoalEquations<T>(goal_, target_, X_WF);
    }
    rotation2_ = squared_norm(equations_.e.w);
    position2_ = squared_norm(equations_.e.v);
    if (settings_.patience > 0) judge();
  }

  [[nodiscard]] MANYHANDS_INLINE mask_t<T> reached() const {
    return mask_t<T>((position2_ <= position_tolerance_) & (rotation2_ <= rotation_tolerance_));
  }

  /// The weighted errors' squares, summed.
  [[nodiscard]] MANYHANDS_INLINE T error2() const { return rotation2_ + position2_; }

  /// Moves the lanes in `active`; which of them go on.
  MANYHANDS_INLINE mask_t<T> step(const mask_t<T>& active) {
    const mask_t<T> arrived = reached();
    const mask_t<T> goes_on = posture_.is_wanted() ? posture_.keep(active, arrived) : mask_t<T>(!arrived);
    const T damping = constant<T>(settings_.damping), error_damping = constant<T>(settings_.error_damping);
    SymMat6<T> damped = SymMat6<T>::diagonal(fma(error_damping, error2(), damping));
    equations_.fill_free(damped);
    const auto row = [&](std::size_t i) { return equations_.row(column(i)); };
    internal::take_damped_step(tree_, params_, chain_, settings_, active, damped, equations_.e, row, posture_,
                               ws_.A.data(), q_);
    return mask_t<T>(active & goes_on & !stuck_);
  }

  /// Lane k begins anew.
  void restart(int k) {
    using R = real_t<T>;
    set_lane(looks_, k, R(0));
    posture_.forget(k);
  }

  /// How far q was when it was looked at last.
  [[nodiscard]] MANYHANDS_INLINE IkResult<T> result() const {
    const T position_error = equations_.places ? norm(equations_.e.v) / equations_.wp : constant<T>(0);
    const T rotation_error = norm(equations_.e.w) / equations_.wr;
    const mask_t<T> success((position_error <= constant<T>(settings_.position_tolerance)) &
                            (rotation_error <= constant<T>(settings_.rotation_tolerance)));
    return {success, position_error, rotation_error};
  }

  /// Takes the configuration that is nearest to the posture, where one was wanted, and says how far q is.
  MANYHANDS_INLINE IkResult<T> finish() {
    if (posture_.is_wanted()) posture_.take_kept();
    look();
    return result();
  }

  /// Whether lane k has been at the goal with a posture wanted, and its q then.
  bool take_kept(int k) { return posture_.take_kept(k); }

 private:
  /// Of the chain's base, where that is now.
  [[nodiscard]] MANYHANDS_INLINE IkTarget<T> target_in_world() const {
    const Transform<T> X_WA = frame_pose(chain_.base->body, broadcast<real_t<T>>(chain_.base->X_BF), ws_);
    const Vec3<T> toward = X_WA.R * target_.toward;
    return {X_WA * target_.X_WF, goal_.orientation == IkOrientation::kAxisAt ? toward + X_WA.p : toward};
  }

  /// How dof i moves the frame, at its origin in world axes; as seen from the chain's base, if there is one.
  [[nodiscard]] MANYHANDS_INLINE Motion<T> column(std::size_t i) const {
    if (!chain_.base || chain_.base->moved_by[i] == 0) return at_point(ws_.S[i], p_OF_);
    return Motion<T>::zero() - at_point(ws_.S[i], p_QF_);
  }

  /// Every `patience` looks.
  MANYHANDS_INLINE void judge() {
    const mask_t<T> due(looks_ >= constant<T>(settings_.patience));
    stuck_ = mask_t<T>(due & (error2() > constant<T>(square(internal::kProgress)) * milestone2_) & !reached());
    const mask_t<T> begins(looks_ <= constant<T>(0));
    milestone2_ = select(mask_t<T>(due | begins), error2(), milestone2_);
    looks_ = select(due, constant<T>(1), looks_ + constant<T>(1));
  }

  const Tree<real_t<T>>& tree_;
  const Params<P>& params_;
  const IkChain& chain_;
  const IkSettings& settings_;
  const IkGoal& goal_;
  const IkTarget<T>& target_;
  T* q_;
  Workspace<T>& ws_;
  Transform<real_t<T>> X_BF_;
  T position_tolerance_, rotation_tolerance_;  // squared, weighted
  internal::GoalEquations<T> equations_;
  internal::PostureSearch<T> posture_;
  Vec3<T> p_OF_ = Vec3<T>::zero(), p_QF_ = Vec3<T>::zero();  // from the origins of the frame's and the base's tree
  T rotation2_{}, position2_{};
  T milestone2_ = constant<T>(0), looks_ = constant<T>(0);  // error2 when progress was last judged, looks since
  mask_t<T> stuck_{false};
};

/// As `solve_ik`, for any goal.
template <Number T, Number P>
MANYHANDS_INLINE IkResult<T> solve_goal(const Tree<real_t<T>>& tree, const Params<P>& params, const IkChain& chain,
                                        const IkSettings& settings, const IkGoal& goal, const IkTarget<T>& target, T* q,
                                        Workspace<T>& ws) {
  GoalSolve<T, P> solve(tree, params, chain, settings, goal, target, q, ws);
  iterate(mask_t<T>(true), settings.max_iterations, [&](const mask_t<T>& active) {
    solve.look();
    return solve.step(active);
  });
  return solve.finish();
}

}  // namespace manyhands
