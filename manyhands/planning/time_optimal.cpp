#include "manyhands/planning/time_optimal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "manyhands/planning/checks.h"
#include "manyhands/planning/path_limits.h"

namespace manyhands {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-9;     ///< by which bounds of x, relative to it, may cross
constexpr double kMostExcess = 1e-10;  ///< relative to a limit: less is within it
constexpr double kOvercorrection = 1.25;
constexpr int kMostRounds = 8;

/// Values of x = (ds/dt)^2.
struct Interval {
  double low = 0, high = kInfinity;

  /// Those with p x <= c.
  void cut(double p, double c) {
    if (p > 0) high = std::min(high, c / p);
    if (p < 0) low = std::max(low, c / p);
    if (p == 0 && c < 0) high = -kInfinity;
  }

  /// Whether there are any, once what rounding does to numbers of this size is mended.
  [[nodiscard]] bool mend(double size) {
    if (low > high && low - high <= kRounding * std::max(low, size)) low = high;
    return low <= high;
  }
};

/// offset + slope x, a bound of the next x.
struct Bound {
  double offset, slope;
};

/// What must hold in one interval, with limits scaled by `share`, sorted by what it says of the next x.
struct Stage {
  std::vector<Bound> upper, lower;
  Interval x;  ///< by what says nothing of the next

  void fill(const PathLimits& limits, std::size_t i, double share, const Interval& next) {
    upper.clear(), lower.clear();
    x = {};
    lower.push_back({next.low, 0});
    if (std::isfinite(next.high)) upper.push_back({next.high, 0});
    for (std::size_t check = 0; check < PathLimits::kChecks; ++check) {
      if (!PathLimits::is_solved(check)) continue;
      for (const PathRow& row : limits.rows_at(i, check)) {
        const double room = share * row.limit - row.offset;
        if (row.to == 0) {
          x.cut(row.from, room);
        } else {
          (row.to > 0 ? upper : lower).push_back({room / row.to, -row.from / row.to});
        }
      }
    }
  }

  /// The x for which there is a next one (Fourier and Motzkin's elimination).
  [[nodiscard]] Interval controllable() const {
    Interval found = x;
    for (const Bound& high : upper) {
      for (const Bound& low : lower) found.cut(low.slope - high.slope, high.offset - low.offset);
    }
    return found;
  }

  [[nodiscard]] double largest_next(double at) const {
    double most = kInfinity;
    for (const Bound& high : upper) most = std::min(most, high.offset + high.slope * at);
    return most;
  }
};

[[noreturn]] void fail(const std::string& what, double s) {
  throw std::invalid_argument(what + " at s = " + as_text(s) + " of the path");
}

/// Throws where the path's end allows less than `end_speed`: rows that say nothing of the x before are those of
/// velocity.
void require_end_speed(const PathLimits& limits, double end_speed) {
  double most = kInfinity;
  for (const PathRow& row : limits.rows_at(limits.intervals() - 1, PathLimits::kChecks - 1)) {
    if (row.from == 0 && row.to > 0) most = std::min(most, (row.limit - row.offset) / row.to);
  }
  if (end_speed * end_speed <= most) return;
  throw std::invalid_argument("end_speed is " + as_text(end_speed) + "; the limits allow at most " +
                              as_text(std::sqrt(most)) + " there");
}

/// The pass backward: at every grid point the x from which the end can be reached.
std::vector<Interval> controllable_sets(const PathLimits& limits, const TimeOptimalSettings& settings, double share,
                                        Stage& stage) {
  const std::size_t n = limits.intervals();
  std::vector<Interval> sets(n + 1);
  const double end = settings.end_speed * settings.end_speed;
  sets[n] = {end, end};
  for (std::size_t i = n; i-- > 0;) {
    stage.fill(limits, i, share, sets[i + 1]);
    sets[i] = stage.controllable();
    if (limits.rests[i]) sets[i].cut(1, 0);
    const double size = std::isfinite(sets[i + 1].high) ? sets[i + 1].high : 0;
    if (!sets[i].mend(size)) fail("the limits leave no way to go on", limits.s[i]);
    if (!std::isfinite(sets[i].high)) fail("nothing limits the speed", limits.s[i]);
  }
  return sets;
}

/// The pass forward: x at every grid point.
std::vector<double> fastest(const PathLimits& limits, const TimeOptimalSettings& settings, double share) {
  Stage stage;
  const std::vector<Interval> sets = controllable_sets(limits, settings, share, stage);
  std::vector<double> x(sets.size());
  const double start = settings.start_speed * settings.start_speed;
  x[0] = start;
  if (x[0] < sets[0].low - kRounding || x[0] > sets[0].high * (1 + kRounding)) {
    throw std::invalid_argument("start_speed is " + as_text(settings.start_speed) + "; the limits want " +
                                as_text(std::sqrt(sets[0].low)) + " to " + as_text(std::sqrt(sets[0].high)) + " there");
  }
  for (std::size_t i = 0; i < limits.intervals(); ++i) {
    stage.fill(limits, i, share, sets[i + 1]);
    x[i + 1] = std::clamp(stage.largest_next(x[i]), sets[i + 1].low, sets[i + 1].high);
    if (x[i] == 0 && x[i + 1] == 0) fail("the limits leave no force to set off with", limits.s[i]);
  }
  return x;
}

/// By how much, relative to a limit, the motion crosses one where the passes did not look.
double excess(const PathLimits& limits, const std::vector<double>& x) {
  double most = 0;
  for (std::size_t i = 0; i < limits.intervals(); ++i) {
    for (std::size_t check = 0; check < PathLimits::kChecks; ++check) {
      for (const PathRow& row : limits.rows_at(i, check)) {
        most = std::max(most, (row.offset + row.from * x[i] + row.to * x[i + 1]) / row.limit - 1);
      }
    }
  }
  return most;
}

/// The coefficients (2 order - 1, width) of p(from + speed t + acceleration t^2 / 2), p being a piece (order, width):
/// Horner's scheme with a polynomial for its argument.
std::vector<double> composed(std::span<const double> p, std::size_t width, double from, double speed,
                             double acceleration) {
  const std::size_t order = p.size() / width;
  std::vector<double> c((2 * order - 1) * width, 0.0);
  for (std::size_t j = order; j-- > 0;) {
    for (std::size_t k = 2 * order - 1; k-- > 0;) {
      for (std::size_t i = 0; i < width; ++i) {
        double sum = from * c[k * width + i];
        if (k >= 1) sum += speed * c[(k - 1) * width + i];
        if (k >= 2) sum += 0.5 * acceleration * c[(k - 2) * width + i];
        c[k * width + i] = sum + (k == 0 ? p[j * width + i] : 0);
      }
    }
  }
  return c;
}

Trajectory retimed(const Trajectory& path, const PathLimits& limits, const std::vector<double>& x) {
  std::vector<double> breaks{0.0}, coefficients;
  for (std::size_t i = 0; i < limits.intervals(); ++i) {
    const double ds = limits.s[i + 1] - limits.s[i], speed = std::sqrt(x[i]);
    breaks.push_back(breaks.back() + 2 * ds / (speed + std::sqrt(x[i + 1])));
    const std::size_t piece = limits.pieces[i];
    const std::vector<double> c = composed(path.piece(piece), path.width(), limits.s[i] - path.breaks()[piece], speed,
                                           (x[i + 1] - x[i]) / (2 * ds));
    coefficients.insert(coefficients.end(), c.begin(), c.end());
  }
  return {std::move(breaks), std::move(coefficients), path.width()};
}

void require_settings(const TimeOptimalSettings& settings) {
  if (settings.intervals < 2) throw std::invalid_argument("intervals is below 2");
  for (const auto& [name, speed] :
       {std::pair{"start_speed", settings.start_speed}, {"end_speed", settings.end_speed}}) {
    if (speed >= 0 && std::isfinite(speed)) continue;
    throw std::invalid_argument(std::string(name) + " is " + as_text(speed) + "; expected 0 or more");
  }
}

}  // namespace

Trajectory time_optimal(const Trajectory& path, const MotionLimits& limits, const TimeOptimalSettings& settings) {
  require_settings(settings);
  const PathLimits rows = path_limits(path, limits, settings.intervals);
  require_end_speed(rows, settings.end_speed);
  double share = 1;
  std::vector<double> x = fastest(rows, settings, share);
  for (int round = 1; round < kMostRounds; ++round) {
    const double over = excess(rows, x);
    if (over <= kMostExcess) break;
    share *= 1 - std::min(kOvercorrection * over, 0.5);
    x = fastest(rows, settings, share);
  }
  return retimed(path, rows, x);
}

}  // namespace manyhands
