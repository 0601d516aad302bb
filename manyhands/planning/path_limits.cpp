#include "manyhands/planning/path_limits.h"

#include <algorithm>
#include <cmath>

#include "manyhands/physics/dynamics/batch_dynamics.h"
#include "manyhands/planning/checks.h"

namespace manyhands {

namespace {

constexpr std::size_t kMostIntervals = 10'000;
constexpr double kSharp = 1e-6;  ///< of dq/ds: a larger jump, relative to the fastest joint of the path, is a corner

using Numbers = std::vector<double>;

/// q(s) and its derivatives by s at all checks of all intervals, (n checks, width) each.
struct PathPoints {
  Numbers q, dq, ddq;
};

void require_fit(const Trajectory& path, const MotionLimits& limits) {
  const std::size_t n = path.width();
  if (!limits.velocity.empty()) require_limits("velocity", limits.velocity, n);
  if (!limits.acceleration.empty()) require_limits("acceleration", limits.acceleration, n);
  if (limits.torque.empty()) return;
  require_limits("torque", limits.torque, n);
  if (limits.model == nullptr) throw std::invalid_argument("torque limits need a model");
  const auto nq = static_cast<std::size_t>(limits.model->nq()), nv = static_cast<std::size_t>(limits.model->nv());
  if (nq == n && nv == n) return;
  throw std::invalid_argument("the path has " + std::to_string(n) + " joints, the model nq = " + std::to_string(nq) +
                              " and nv = " + std::to_string(nv) + "; torque limits need them equal");
}

void set_grid(const Trajectory& path, std::size_t intervals, PathLimits& found) {
  const auto breaks = path.breaks();
  found.s.push_back(0);
  for (std::size_t k = 0; k < path.pieces(); ++k) {
    const double length = breaks[k + 1] - breaks[k];
    const double share = std::ceil(static_cast<double>(intervals) * length / path.duration());
    const auto parts = std::max<std::size_t>(2, static_cast<std::size_t>(share));
    for (std::size_t j = 1; j <= parts; ++j) {
      const bool last = j == parts;
      found.s.push_back(last ? breaks[k + 1]
                             : breaks[k] + length * static_cast<double>(j) / static_cast<double>(parts));
      found.pieces.push_back(k);
    }
    if (found.intervals() <= kMostIntervals) continue;
    throw std::invalid_argument("the path needs more than " + std::to_string(kMostIntervals) +
                                " intervals; give fewer, or a path of fewer pieces");
  }
}

PathPoints sample(const Trajectory& path, const PathLimits& grid) {
  const std::size_t n = path.width(), numbers = grid.intervals() * PathLimits::kChecks * n;
  PathPoints found{Numbers(numbers), Numbers(numbers), Numbers(numbers)};
  for (std::size_t i = 0, at = 0; i < grid.intervals(); ++i) {
    const double from = grid.s[i] - path.breaks()[grid.pieces[i]], length = grid.s[i + 1] - grid.s[i];
    for (std::size_t c = 0; c < PathLimits::kChecks; ++c, at += n) {
      const double f = static_cast<double>(c) / static_cast<double>(PathLimits::kChecks - 1);
      path.sample_piece(grid.pieces[i], from + f * length, &found.q[at], &found.dq[at], &found.ddq[at]);
    }
  }
  return found;
}

/// Finds the corners.
void find_rests(const PathPoints& points, std::size_t n, PathLimits& found) {
  double fastest = 0;
  for (const double x : points.dq) fastest = std::max(fastest, std::abs(x));
  if (fastest == 0) throw std::invalid_argument("the path has no length: nothing moves along it");
  const std::size_t stride = PathLimits::kChecks * n;
  found.rests.assign(found.s.size(), false);
  for (std::size_t i = 1; i < found.intervals(); ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const double jump = points.dq[i * stride + j] - points.dq[i * stride - n + j];
      if (std::abs(jump) > kSharp * fastest) found.rests[i] = true;
    }
  }
}

/// Both sides of |offset + a u + b x| <= limit, at the fraction f of an interval of length ds.
void append_both(double a, double b, double offset, double limit, double f, double ds, std::vector<PathRow>& rows) {
  const double half = a / (2 * ds);
  for (const double side : {1.0, -1.0}) {
    rows.push_back({side * ((1 - f) * b - half), side * (f * b + half), side * offset, limit});
  }
}

}  // namespace

PathLimits path_limits(const Trajectory& path, const MotionLimits& limits, std::size_t intervals) {
  require_fit(path, limits);
  PathLimits found;
  set_grid(path, intervals, found);
  const PathPoints points = sample(path, found);
  const std::size_t n = path.width(), count = points.q.size() / n;
  find_rests(points, n, found);

  Numbers along, bent, still;  // tau = along u + bent x + still
  if (!limits.torque.empty()) {
    const Numbers zero(points.q.size(), 0.0);
    for (Numbers* tau : {&along, &bent, &still}) tau->resize(points.q.size());
    BatchDynamics<double> dynamics(*limits.model);
    dynamics.rnea(count, points.q, zero, points.dq, along);
    dynamics.rnea(count, points.q, points.dq, points.ddq, bent);
    dynamics.rnea(count, points.q, zero, zero, still);
  }
  for (std::size_t point = 0; point < count; ++point) {
    const std::size_t i = point / PathLimits::kChecks, check = point % PathLimits::kChecks;
    const double f = static_cast<double>(check) / static_cast<double>(PathLimits::kChecks - 1);
    const double ds = found.s[i + 1] - found.s[i];
    for (std::size_t j = 0, at = point * n; j < n; ++j, ++at) {
      if (!limits.velocity.empty() && std::isfinite(limits.velocity[j])) {
        const double square = points.dq[at] * points.dq[at];
        found.rows.push_back({(1 - f) * square, f * square, 0, limits.velocity[j] * limits.velocity[j]});
      }
      if (!limits.acceleration.empty() && std::isfinite(limits.acceleration[j])) {
        append_both(points.dq[at], points.ddq[at], 0, limits.acceleration[j], f, ds, found.rows);
      }
      if (!limits.torque.empty() && std::isfinite(limits.torque[j])) {
        append_both(along[at] - still[at], bent[at] - still[at], still[at], limits.torque[j], f, ds, found.rows);
      }
    }
  }
  found.rows_per_check = found.rows.size() / count;
  if (found.rows.empty()) throw std::invalid_argument("nothing limits the motion; give a finite limit");
  return found;
}

}  // namespace manyhands
