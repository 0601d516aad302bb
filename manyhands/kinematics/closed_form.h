// All configurations of a six-axis arm that bring its frame to a pose, in closed form.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "manyhands/kinematics/inverse_kinematics.h"
#include "manyhands/kinematics/screws.h"

namespace manyhands {

/// Arms of six joints that turn, whose second and third axes are parallel, and not the first, and
/// - whose last three axes meet in a point (a spherical wrist; Pieper, 1968), or
/// - whose fourth axis is parallel to these, too, while the fifth and the sixth meet.
///
/// Each equation is one of the subproblems of Paden and Kahan: the angle that turns a vector to another, or to where it
/// has a given component (Murray, Li, Sastry, 1994, section 3.3; Elias, Wen, IK-Geo, 2022).
class ClosedForm {
 public:
  static constexpr std::size_t kJoints = 6;
  using Angles = std::array<double, kJoints>;

  /// None if the joints that move the frame make no such arm. Throws ModelError as IkChain does.
  [[nodiscard]] static std::optional<ClosedForm> of(const Model& model, FrameId frame);

  /// The dofs of the joints, from the base out.
  [[nodiscard]] std::span<const std::size_t> dofs() const { return dofs_; }

  /// At most eight configurations, each once, with the frame at X_WF [rad, each in (-pi, pi]], whatever the limits;
  /// none out of reach. Of the many that lead to a singular pose those are given whose fourth joint, of a spherical
  /// wrist, or else sixth joint is at 0, as far as that is in reach.
  [[nodiscard]] std::vector<Angles> solve(const Transform<double>& X_WF) const;

  /// Those of them within the joints' limits, as configurations (nq): angles by whole turns as near to `start` (nq) as
  /// limits allow, everything else as near as these do; the nearest to it first. Throws std::invalid_argument if it has
  /// not nq numbers. `model` is that of `of`.
  [[nodiscard]] std::vector<std::vector<double>> within_limits(const Model& model, const Transform<double>& X_WF,
                                                               std::span<const double> start) const;

 private:
  struct Axis {
    Vec3<double> direction;  ///< unit
    Vec3<double> point;      ///< on it [m]
  };

  ClosedForm() = default;
  [[nodiscard]] bool find_kind();
  void solve_wrist(const Transform<double>& X, double q1, std::vector<Angles>& found) const;
  void solve_parallel(const Transform<double>& X, double q1, std::vector<Angles>& found) const;
  template <class Visit>
  void visit_elbow(const Vec3<double>& from, const Vec3<double>& to, const Visit& visit) const;

  std::array<Axis, kJoints> axes_{};  // at q = 0
  Transform<double> home_inverse_ = Transform<double>::identity();
  std::vector<std::size_t> dofs_{};
  Vec3<double> centre_{};   // where the last axes meet, at q = 0
  bool has_wrist_ = false;  // and all three of them do
};

}  // namespace manyhands
