// Every number by which the contact solver is tuned, with its unit and its reason.
#pragma once

#include "manyhands/math/number.h"

namespace manyhands {

/// How long the solver works. The worlds of a block share its iterations; one that has converged stays as it is.
struct SolverSettings {
  int max_iterations = 100;        ///< over all contacts; a few more where a joint's motor or limit changes state
  double tolerance = 1e-9;         ///< converged when an iteration changes no contact's velocity by more [m/s]
  int newton_steps = 10;           ///< at most, in double alone, where iterations gain too little
  double newton_tolerance = 1e-7;  ///< violation of the contact law that is not worth a Newton step [m/s]
};

/// What differs between double, where one world can afford to be exact, and float, where a block of worlds waits for
/// its slowest and the next step continues what this one leaves.
template <Real R>
struct SolverTraits;

template <>
struct SolverTraits<double> {  ///< solved to the end
  static constexpr SolverSettings kDefaults{};
  /// The least that is divided by: 1 / kSmallest is still far from overflow.
  static constexpr double kSmallest = 1e6 * std::numeric_limits<double>::min();
  /// Whether points that a step hardly reaches are left out of it: see far_points.h. In a block of worlds each has
  /// others.
  static constexpr bool kLeavesOut = true;
  /// Newton's method takes over where Gauss-Seidel has a long tail. It needs double: r = 1e-7 of the effective mass.
  static constexpr bool kRefines = true;
  /// Iterations between two looks at the joints: contacts that have not converged mislead them.
  static constexpr int kIterationsPerLook = 8;
  /// Newton steps towards the root of a sliding point in one visit: the next visit goes on from there.
  static constexpr int kSlideSteps = 2;
  /// Contacts whose trees have moved by less since their last visit, as a part of what the last iteration moved at
  /// most, are not visited: in a heap nearly all are at rest. 0: all are visited.
  static constexpr double kLittleMoved = 0.3;
  /// By how much a joint's impulse or velocity may contradict its state, relative to its size: rounding.
  static constexpr double kStateTolerance = 1e-12;
  /// What contacts leave unsettled is noise to the joints' states, up to so much [m/s]: as much as is worth no
  /// iteration. Friction that just holds would else let go and catch again until the search ends.
  static constexpr double kStateNoise = 1e-9;
  /// What gives way is no stiffer than this many times the inertia that it meets: more would leave M no digits.
  static constexpr double kStiffest = 1e8;
  /// Passes that make a held tendon rigid, each ten thousand times as much.
  static constexpr int kLengthPasses = 3;
  /// Relative changes of an impulse that its precision cannot resolve.
  static constexpr double kResolution = 1e-14;
  /// Equality rows of which the rows before leave a smaller part are redundant.
  static constexpr double kRedundancy = 1e-10;
  /// What is left of mobilities that cancel, as a part of them: where a contact's row is the sum of its patch's, or
  /// where equality constraints take away what moves it.
  static constexpr double kCancellation = 1e-10;
  /// What is left of the terms that an entry of J is summed of: 16 units of rounding, squared.
  static constexpr double kRounding = 256 * 2.220446049250313e-16 * 2.220446049250313e-16;
};

template <>
struct SolverTraits<float> {  ///< a few iterations: what a step of thousands of worlds can spend
  static constexpr SolverSettings kDefaults{.max_iterations = 10, .tolerance = 1e-6};
  static constexpr double kSmallest = 1e6 * std::numeric_limits<float>::min();
  static constexpr bool kLeavesOut = false;
  static constexpr bool kRefines = false;
  static constexpr int kIterationsPerLook = 2;
  static constexpr int kSlideSteps = 1;
  static constexpr double kLittleMoved = 0;
  static constexpr float kStateTolerance = 1e-5F;
  static constexpr float kStateNoise = 0;
  static constexpr double kStiffest = 1e4;
  static constexpr int kLengthPasses = 1;
  static constexpr float kResolution = 3e-7F;
  static constexpr float kRedundancy = 1e-4F;
  static constexpr float kCancellation = 2e-6F;
  static constexpr float kRounding = 256 * 1.1920929e-07F * 1.1920929e-07F;
};

namespace contact_settings {

// ---- what a step asks of positions ----------------------------------------------------------------------------------

/// How much of a joint limit's violation a step removes, as PyBullet does.
inline constexpr double kLimitRecovery = 0.2;
/// How much of a penetration a step removes, and the fastest that it pushes surfaces apart [m/s].
inline constexpr double kPenetrationRecovery = 0.2;
inline constexpr double kMaxPenetrationRecovery = 0.1;
/// The same of what a mocap body pushes, which is all that moves it [m/s].
inline constexpr double kMaxMocapRecovery = 1;
/// Surfaces this near count as touching [m], all alike. Without it the corners of a resting or gripped box, whose
/// distances differ by microns, would take turns in carrying it: on one corner a thing turns.
inline constexpr double kTouching = 3e-5;
/// Points farther apart than this [m] once the step has been taken need not take part in it.
inline constexpr double kFar = 1e-4;
/// The most that the curvature of a path counts for in a step [m/s]: where it were more, the step is too long to
/// follow.
inline constexpr double kMaxArc = 0.1;
/// An equality constraint that stands open closes no faster [m/s or rad/s], and a joint far outside its limits returns
/// no faster: it is not shot back.
inline constexpr double kMaxClosing = 1;
/// By what part of the mobility in any direction corrections yield, of surfaces that part and of equality constraints
/// that close: where joints move much less, as at a singular arm, or while something holds them, errors shrink more
/// slowly, by what joints can do without racing. What stands open by more than so many steps close may be out of
/// reach: there an arm at its limit would whirl.
inline constexpr double kOpeningYields = 0.1, kClosingYields = 0.01, kFarClosingYields = 1, kFarSteps = 10;
/// How often what equality constraints leave open is looked at again: of a free body's error 1e-7 stays.
inline constexpr int kClosingPasses = 6;

/// The mobility of a row that no joint moves, as a part of what joints move in other directions there: the square of
/// 1e-5, to which files give their axes.
inline constexpr double kImmovable = 1e-10;

/// The least mobility of a contact, in the same measure: where joints move it less it yields, or rounding would press
/// it beyond all digits. And what yields in the same measure is how fast surfaces that overlap part.
inline constexpr double kLeastMobility = 1e-8, kOpeningSoftness = 1e-6;

// ---- joints -------------------------------------------------------------------------------------------------------

/// The impulse that no drive exceeds: finite, because a held drive multiplies it by 0.
inline constexpr double kMaxImpulse = 1e30;
/// How stiffly motors and limits hold a dof of a tree that touches something, in multiples of its inertia: so stiff
/// that a held joint stays, and soft enough that a body between two held ones can be squeezed.
inline constexpr double kPenalty = 1e4;
/// Changes of state of all wrong dofs together without fewer being wrong, before they change one by one: then the
/// search is finite (Murty).
inline constexpr int kPatience = 6;
inline constexpr int kMaxStateChanges = 400;
/// A joint equality between dofs that motors hold anyway, where these agree with it to this [rad/s or m/s], is left
/// out.
inline constexpr double kAgreement = 1e-6;

// ---- the search for the joints' states once contacts take part -----------------------------------------------------

/// How often states may change in a step.
inline constexpr int kMaxLooks = 12;
/// After so many changes contacts get more iterations between two looks, whatever the precision.
inline constexpr int kEarlyLooks = 3, kIterationsPerLateLook = 8;
/// A search whose merit becomes so many times what it was has diverged.
inline constexpr double kDivergence = 1000;

// ---- what overlaps ------------------------------------------------------------------------------------------------

/// Corrections no faster than this [m/s or rad/s] may contradict each other: what it takes is little. Surfaces that
/// part no faster are not asked whether they can.
inline constexpr double kSlowCorrection = 0.02;
/// Where they part faster, a violation of the law by this part of that speed is worth no Newton step.
inline constexpr double kOpeningPrecision = 1e-2;
/// Visits of each contact, and the velocity [m/s] that is near enough.
inline constexpr int kOpeningPasses = 50;
inline constexpr double kOpeningTolerance = 1e-3;

// ---- what runs away -----------------------------------------------------------------------------------------------

/// Energy beyond what there can be that is still rounding, and not a solution that runs away; and the speed [m/s] at
/// which all may move at any time.
inline constexpr double kExcess = 1.05;
inline constexpr double kHarmlessSpeed = 0.01;
/// A solution is looked at where it moves something so many times as fast as anything was before, or as 1 rad/s or m/s.
/// Motors fling light fingers that drive other things: they are not meant.
inline constexpr double kSuspicious = 100;
/// Steps without demands after one that ran away, before they are made again.
inline constexpr int kCalmSteps = 32;

// ---- sliding ------------------------------------------------------------------------------------------------------

/// Less friction is none: its square is lost among the smallest numbers, or has no inverse.
inline constexpr double kLeastFriction = 1e-12;
/// By how much |y| may miss the rim of its cone, as a part of it.
inline constexpr double kSlideTolerance = 1e-14;
/// The least that 1 + slope . direction counts for: below 0 friction wedges the contact, and no impulse on the cone
/// keeps u_n at 0.
inline constexpr double kMinWedge = 0.05;

// ---- Newton's method in double: from a scan over towers, walls, arches and heavy on light, warm and cold -----------

/// Softness of contacts in an outer step, relative to the response to their own impulses: first, least and most.
inline constexpr double kFirstSoftness = 1e-4, kMinSoftness = 1e-7, kMaxSoftness = 0.1;
/// Factorisations in an outer step; in one after a step that gained little.
inline constexpr int kFactorisations = 5, kMaxFactorisations = 10;
/// Outer steps one after the other that are taken back before the best is kept, if it violates the law by no more than
/// so many times what is worth no step; and the same after more of them.
inline constexpr int kMaxFailures = 2, kManyFailures = 4;
inline constexpr double kNearEnough = 5, kBearable = 1000;
/// By how much an outer step reduces the defect of its own equations.
inline constexpr double kInnerGain = 1e-5;
/// One whose defect ends within so many times that is solved. If the violation is then no smaller, but less than so
/// many times what it was, the step was too soft; else it was too stiff.
inline constexpr double kSolved = 100, kSlow = 3;
/// Gauss-Seidel iterations between outer steps; the most after steps that were taken back.
inline constexpr int kIterationsBetween = 3, kMaxIterationsBetween = 48;
/// Iterations that promise to do within this many times those allowed are cheaper than outer steps.
inline constexpr double kNewtonPatience = 2;
/// All factorisations of a step may take so many times what all iterations may, or this many multiplications; fewer
/// are not worth it. Each takes as much as so many iterations besides; and a contact takes as much in an iteration
/// besides its rows.
inline constexpr double kNewtonShare = 2, kLittleWork = 2e7, kFewestFactorisations = 16, kNewtonOverhead = 8;
inline constexpr double kPointWork = 100;
/// Iterations that reduce the logarithm of the violation by less from look to look gain too little.
inline constexpr double kMinGain = 0.3;
/// Iterations that reduce it by more go on until they have converged, where the violation is no longer worth it, unless
/// what overlaps is asked to part: that is not known so precisely.
inline constexpr double kFastGain = 2;
/// An outer step that divides the violation by less gains little.
inline constexpr double kMinNewtonGain = 3;
/// Friction's dependence on the normal impulse makes Newton's matrix unsymmetric. Above this many sliding contacts it
/// costs too much, and the matrix goes without it: convergence is then linear where contacts slide.
inline constexpr std::size_t kMaxFollowing = 60;

}  // namespace contact_settings

}  // namespace manyhands
