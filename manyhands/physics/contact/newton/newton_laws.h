// The laws of contacts and equality constraints as Newton's method sees them: softened about the present impulses.
#pragma once

#include <vector>

#include "manyhands/physics/contact/newton/newton_context.h"

namespace manyhands::internal {

/// The impulse of three rows at their velocity u, and how it falls with u.
struct MultiplierLaw {
  Vec3<double> impulse = Vec3<double>::zero();
  Mat3<double> slope{Vec3<double>::zero(), Vec3<double>::zero(), Vec3<double>::zero()};  ///< -d impulse / d u
  Vec3<double> on_normal = Vec3<double>::zero();  ///< -d impulse / d u_n of the point, where sliding follows it
};

/// How the force on a patch falls with its motion: d f = -(vv dv + vw dw), d n = -(wv dv + ww dw).
struct PatchSlope {
  Mat3<double> vv, vw, wv, ww;
};

/// The force on a patch by which sliding follows a normal impulse: d force = -force (normal . d motion).
struct Following {
  std::size_t patch{};  ///< of those that take part
  Force<double> force;
  Motion<double> normal;  ///< as coefficients
};

/// Velocities of all rows that take part, in the order in which they do.
struct RowVelocities {
  std::vector<Vec3<double>> points, torsions, equalities;  ///< torsions: one for each point, 0 where it has none
};

/// Of the patches and equality constraints that take part, about their present impulses (n_0, y_0), the multipliers:
///   n = max(0, n_0 - (u_n + R n_0) / r_n),  y = P(y_0 - (u_t + R y_0) / r_t), P onto the disc of radius n.
/// Equality constraints are rows without bounds. R: what the contact yields by itself.
class NewtonLaws {
 public:
  std::vector<std::size_t> patches, equalities;  ///< that take part

  /// Softens the laws by a part of what gives way to their own impulses. `velocities`: what they are at dv = 0, less
  /// what the laws ask for.
  void begin(const NewtonContext& context, double softness, RowVelocities& velocities);

  /// J x, for x (nv).
  void multiply_J(const NewtonContext& context, const double* x, RowVelocities& velocities) const;

  /// The laws at `from` + t `change`.
  void evaluate(const NewtonContext& context, const RowVelocities& from, double t, const RowVelocities& change);

  /// x += J^T (impulses of the laws - present ones), for x (nv).
  void add_changes(const NewtonContext& context, double* x) const;

  /// Makes those of the laws the present ones.
  void apply(const NewtonContext& context) const;

  /// How patch k of those that take part answers to motion, but for what follows its normal impulses.
  [[nodiscard]] PatchSlope patch_slope(const NewtonContext& context, std::size_t k) const;

  /// Writes down all by which sliding follows normal impulses.
  void find_following(const NewtonContext& context, std::vector<Following>& following) const;

  /// The same of equality constraint k, whose rows are all in vv.
  [[nodiscard]] PatchSlope equality_slope(std::size_t k) const;

  [[nodiscard]] bool presses(std::size_t k) const { return presses_[k]; }  ///< whether patch k has any force

 private:
  struct Yield {
    double normal{}, tangent{};  ///< 1 / r of both; of torsion: about the normal, across it; 0: no such row
  };

  [[nodiscard]] Force<double> patch_change(const NewtonContext& context, std::size_t p) const;
  void evaluate_point(const NewtonContext& context, std::size_t i, std::size_t k, const Vec3<double>& u,
                      const Vec3<double>& w);
  void evaluate_torsion(const NewtonContext& context, std::size_t j, std::size_t k, const Vec3<double>& w);

  std::vector<std::size_t> first_;                  ///< (patches) of their points among those that take part
  std::vector<bool> presses_;                       ///< (patches)
  std::vector<Yield> point_yield_, torsion_yield_;  ///< (points)
  std::vector<MultiplierLaw> point_law_, torsion_law_;
  std::vector<Vec3<double>> equality_yield_, equality_change_;  ///< (equalities)
};

}  // namespace manyhands::internal
