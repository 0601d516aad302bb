#include "manyhands/planning/cartesian.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "manyhands/planning/checks.h"

namespace manyhands {

namespace {

constexpr double kSlack = 1e-9;  ///< by which a law may miss the first or last pose, in poses

void require_law(const Trajectory& law, std::size_t poses) {
  if (poses < 2) throw std::invalid_argument("a Cartesian motion needs two poses or more");
  if (law.width() != 1) {
    throw std::invalid_argument("law has the width " + std::to_string(law.width()) + "; expected 1");
  }
  const auto last = static_cast<double>(poses - 1);
  double first_s = 0, last_s = 0, v = 0, a = 0;
  law.sample_piece(0, 0, &first_s, &v, &a);
  law.sample_piece(law.pieces() - 1, law.duration() - law.breaks()[law.pieces() - 1], &last_s, &v, &a);
  if (std::abs(first_s) <= kSlack && std::abs(last_s - last) <= kSlack * last) return;
  throw std::invalid_argument("law goes from " + as_text(first_s) + " to " + as_text(last_s) + "; expected from 0 to " +
                              as_text(last) + ", k at pose k");
}

}  // namespace

CartesianTrajectory::CartesianTrajectory(const std::vector<Transform<double>>& poses, Trajectory law,
                                         CartesianPath path)
    : path_(path), law_(std::move(law)) {
  require_law(law_, poses.size());
  for (std::size_t k = 0; k + 1 < poses.size(); ++k) {
    const Transform<double>&from = poses[k], &to = poses[k + 1];
    const Mat3<double> back = transpose(from.R);
    Motion<double> step = log6(Transform<double>{back * to.R, back * (to.p - from.p)});
    if (path == CartesianPath::kStraight) step.v = to.p - from.p;
    segments_.push_back({from, step});
  }
}

CartesianSample CartesianTrajectory::sample(double t) const {
  double s = 0, v = 0, a = 0;
  law_.sample(std::span(&t, 1), std::span(&s, 1), std::span(&v, 1), std::span(&a, 1));
  const double k = std::clamp(std::floor(s), 0.0, static_cast<double>(segments_.size() - 1));
  const auto& [start, step] = segments_[static_cast<std::size_t>(k)];
  const Motion<double> twist{(s - k) * step.w, (s - k) * step.v};
  CartesianSample found{};
  Vec3<double> direction = step.v;  // of the origin, world axes
  if (path_ == CartesianPath::kScrew) {
    found.X = start * exp6(twist);
    direction = found.X.R * step.v;
  } else {
    found.X = {start.R * to_matrix(quat_from_rotation_vector(twist.w)), start.p + twist.v};
  }
  const Vec3<double> axis = start.R * step.w;
  found.V = {v * axis, v * direction};
  found.A = {a * axis, a * direction};
  if (path_ == CartesianPath::kScrew) found.A.v = found.A.v + cross(found.V.w, found.V.v);
  return found;
}

}  // namespace manyhands
