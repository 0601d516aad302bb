#include "manyhands/model/io/inertia_repair.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>

#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace {

constexpr double kTolerance = 1e-6;  // relative: files hold rounded numbers

/// How far the moments are from keeping the triangle inequality; it implies that none is negative.
double violation(const Vec3<double>& m) { return std::max({m.x - m.y - m.z, m.y - m.x - m.z, m.z - m.x - m.y}); }

double largest(const Vec3<double>& m) { return std::max({std::abs(m.x), std::abs(m.y), std::abs(m.z)}); }

Eigen::Matrix3d to_eigen(const SymMat3<double>& I) {
  Eigen::Matrix3d matrix;
  matrix << I.xx, I.xy, I.xz, I.xy, I.yy, I.yz, I.xz, I.yz, I.zz;
  return matrix;
}

/// The inertia of these principal moments, 0 or more, about the columns of `axes`.
SymMat3<double> with_moments(const Eigen::Matrix3d& axes, const Vec3<double>& moments) {
  const Eigen::Vector3d roots(std::sqrt(moments.x), std::sqrt(moments.y), std::sqrt(moments.z));
  const Eigen::Matrix3d half = axes * roots.asDiagonal();
  const Eigen::Matrix3d whole = half * half.transpose();
  return {whole(0, 0), whole(1, 1), whole(2, 2), whole(0, 1), whole(0, 2), whole(1, 2)};
}

std::string format(const Vec3<double>& m) {
  return format_number(m.x) + " " + format_number(m.y) + " " + format_number(m.z);
}

}  // namespace

// The allowed moments form a cone of three planes n.m >= 0, n = (1, 1, -1) and so on, that meet in three edges: the
// nearest point is the point itself, or its projection on a plane or on an edge, or the tip.
Vec3<double> nearest_principal_moments(const Vec3<double>& moments) {
  if (violation(moments) <= 0) return moments;
  constexpr std::array<Vec3<double>, 3> kPlanes{{{1, 1, -1}, {1, -1, 1}, {-1, 1, 1}}};
  constexpr std::array<Vec3<double>, 3> kEdges{{{0, 1, 1}, {1, 0, 1}, {1, 1, 0}}};
  Vec3<double> best = Vec3<double>::zero();
  const auto consider = [&](const Vec3<double>& candidate) {
    const bool allowed = violation(candidate) <= 1e-12 * largest(candidate);
    if (allowed && norm(candidate - moments) < norm(best - moments)) best = candidate;
  };
  for (const Vec3<double>& n : kPlanes) consider(moments - (dot(n, moments) / 3) * n);
  for (const Vec3<double>& e : kEdges) consider(std::max(dot(e, moments) / 2, 0.0) * e);
  return {std::max(best.x, 0.0), std::max(best.y, 0.0), std::max(best.z, 0.0)};
}

void bound_principal_moments(SymMat3<double>& inertia, double least) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(to_eigen(inertia));
  const Eigen::Vector3d& m = solver.eigenvalues();  // ascending
  if (m[0] >= least) return;
  inertia = with_moments(solver.eigenvectors(), {least, std::max(m[1], least), std::max(m[2], least)});
}

std::optional<std::string> repair_inertial(Inertial& inertial) {
  std::string done;
  if (inertial.mass < 0) {
    done = "mass " + format_number(inertial.mass) + " kg is negative; 0 taken";
    inertial.mass = 0;
  }
  SymMat3<double>& I = inertial.inertia;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(to_eigen(I));
  const Eigen::Vector3d& values = solver.eigenvalues();
  const Vec3<double> moments{values[0], values[1], values[2]};
  const bool positive =
      std::min({I.xx, I.yy, I.zz, moments.x}) >= -1e-12 * largest(moments) && std::min({I.xx, I.yy, I.zz}) >= 0;
  if (!positive || violation(moments) > kTolerance * largest(moments)) {
    const Vec3<double> nearest = nearest_principal_moments(moments);
    I = with_moments(solver.eigenvectors(), nearest);
    if (!done.empty()) done += "; ";
    done += "no rigid body has the principal moments of inertia " + format(moments) +
            " kg m^2; the nearest possible, " + format(nearest) + ", taken";
  }
  return done.empty() ? std::nullopt : std::optional(done);
}

}  // namespace manyhands::io
