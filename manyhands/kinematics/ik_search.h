// Inverse kinematics for many targets at once, from random starts where the first does not lead there.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "manyhands/kinematics/ik_goals.h"

namespace manyhands {

/// q (nq) with every joint of one degree of freedom within its limits.
[[nodiscard]] std::vector<double> within_limits(const Model& model, std::span<const double> q);

struct IkSearchSettings {
  IkSettings ik{};         ///< of one attempt
  int restarts = 100;      ///< attempts after the first: from near the target, if it has a position, then at random
  bool from_start = true;  ///< whether the first attempt begins at the start; if not, that of a chain of more than six
                           ///< dofs begins near the target, if it has a position: half the iterations of the Panda's
  std::uint64_t seed = 0;  ///< of those
};

/// Rows are targets. A target's row depends on it, the start and the settings, not on the other targets.
struct IkSolutions {
  std::vector<double> q;                               ///< (n, nq) the solution, or the nearest that was found
  std::vector<std::uint8_t> success;                   ///< (n) both errors are within tolerance
  std::vector<double> position_error, rotation_error;  ///< (n) at q [m], [rad]
  std::vector<int> attempts;                           ///< (n) how many were made
};

/// Whether a configuration q (nq) will do, beside reaching its target.
using IkFilter = std::function<bool(std::span<const double> q)>;

/// For each pose in `targets` (X_WF of the frame) a configuration that reaches it; the first attempt begins at
/// `start` (nq). Attempts run in float lanes, where the next begins as soon as one ends; what they find is finished in
/// lanes of double. With settings.ik.respect_limits, q lies within the limits of all joints of one degree of freedom;
/// coordinates that do not move the frame stay as near to `start` as these allow. An unreachable target has success 0
/// and the errors of the nearest pose found.
/// Cost: 10,000 reachable poses of the Panda's hand need two attempts each on average and 20 ms on one core with AVX2;
/// a pose that cannot be reached uses up all attempts, about 0.2 ms. The first restart of an `IkSearch` places 8192
/// configurations, once, in 2 ms.
///
/// Throws ModelError as IkChain does, std::invalid_argument if `start` has not nq numbers.
[[nodiscard]] IkSolutions search_ik(const Model& model, FrameId frame, std::span<const Transform<double>> targets,
                                    std::span<const double> start, const IkSearchSettings& settings = {});

/// The same for any goal: a position, a direction of an axis or a point at which it looks, with weights, and a posture
/// that is kept where the goal leaves room. Of several solutions the first is taken, not the one nearest to the
/// posture; to begin there makes it likely. Weights decide what remains of a goal that cannot be reached.
///
/// Throws as above, and std::invalid_argument for a goal that asks for nothing, a negative or infinite weight, an axis
/// that is not of unit length, or a posture that has not nq numbers.
[[nodiscard]] IkSolutions search_ik(const Model& model, FrameId frame, const IkGoal& goal,
                                    std::span<const IkTarget<double>> targets, std::span<const double> start,
                                    const IkSearchSettings& settings = {});

/// The same for one frame again and again: what depends on the model alone, more than half of a call, is made once. The
/// model is borrowed. Not for several threads at a time.
class IkSearch {
 public:
  /// Throws ModelError as IkChain does.
  IkSearch(const Model& model, FrameId frame);
  /// For targets in another frame: poses X_AF of the frame in A, directions in its axes, points from its origin.
  IkSearch(const Model& model, FrameId frame, FrameId relative_to);
  IkSearch(IkSearch&&) noexcept;
  IkSearch& operator=(IkSearch&&) noexcept;
  ~IkSearch();

  /// The dofs that are solved for.
  [[nodiscard]] const IkChain& chain() const;

  /// With `accepts`, a target's attempts go on until one of them reaches it and is accepted. If none is, success is 0,
  /// and the errors say whether it was reached. Throws std::invalid_argument as `search_ik` does.
  [[nodiscard]] IkSolutions find(const IkGoal& goal, std::span<const IkTarget<double>> targets,
                                 std::span<const double> start, const IkSearchSettings& settings = {},
                                 const IkFilter& accepts = {});

 private:
  struct Parts;

  std::unique_ptr<Parts> parts_;
};

}  // namespace manyhands
