#include "manyhands/planning/path_shortening.h"

#include <algorithm>
#include <cmath>

#include "manyhands/math/philox.h"

namespace manyhands {

namespace {

using Row = std::span<const float>;

/// A path that is being shortened.
class Shortening {
 public:
  Shortening(ConfigurationCheck& check, std::vector<float> rows, std::size_t n, const Deadline& deadline)
      : check_(check), rows_(std::move(rows)), n_(n), deadline_(deadline) {}

  /// From each waypoint to the last that can be reached straight.
  void leave_out() {
    for (std::size_t i = 0; i + 2 < count(); ++i) {
      for (std::size_t j = count() - 1; j > i + 1 && !deadline_.has_passed(); --j) {
        if (!check_.is_free(row(i), row(j))) continue;
        erase(i + 1, j);
        break;
      }
    }
  }

  /// Straight from one random point of the path to another; whether that is free, and shorter.
  bool cut(RandomStream& random) {
    measure();
    const float a = random.uniform(0.0f, lengths_.back()), b = random.uniform(0.0f, lengths_.back());
    const auto [i, from] = point_at(std::min(a, b));
    const auto [j, to] = point_at(std::max(a, b));
    if (i == j) return false;
    const std::optional<std::vector<float>> between = way_between(check_, from, to);
    if (!between) return false;
    std::vector<float> way = from;
    way.insert(way.end(), between->begin(), between->end());
    way.insert(way.end(), to.begin(), to.end());
    if (!between->empty() && path_length(way, n_) > static_cast<double>(std::abs(b - a))) return false;
    erase(i + 1, j + 1);
    insert(i + 1, way);
    return true;
  }

  [[nodiscard]] std::size_t count() const { return rows_.size() / n_; }
  [[nodiscard]] std::vector<float> take() { return std::move(rows_); }

 private:
  [[nodiscard]] Row row(std::size_t i) const { return Row(rows_).subspan(i * n_, n_); }
  [[nodiscard]] std::ptrdiff_t place(std::size_t i) const { return static_cast<std::ptrdiff_t>(i * n_); }
  void erase(std::size_t first, std::size_t last) {
    rows_.erase(rows_.begin() + place(first), rows_.begin() + place(last));
  }
  void insert(std::size_t i, const std::vector<float>& q) {
    rows_.insert(rows_.begin() + place(i), q.begin(), q.end());
  }

  void measure() {
    lengths_.assign(1, 0.0f);
    for (std::size_t i = 0; i + 1 < count(); ++i)
      lengths_.push_back(lengths_.back() + static_cast<float>(path_length(Row(rows_).subspan(i * n_, 2 * n_), n_)));
  }

  /// The edge on which a point at that length lies, and the point.
  [[nodiscard]] std::pair<std::size_t, std::vector<float>> point_at(float length) const {
    const auto after = std::ranges::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, length);
    const auto i = static_cast<std::size_t>(after - lengths_.begin()) - 1;
    const float edge = lengths_[i + 1] - lengths_[i], share = edge > 0 ? (length - lengths_[i]) / edge : 0;
    std::vector<float> q(row(i).begin(), row(i).end());
    for (std::size_t k = 0; k < n_; ++k) q[k] += share * (row(i + 1)[k] - q[k]);
    return {i, q};
  }

  ConfigurationCheck& check_;
  std::vector<float> rows_;
  std::size_t n_;
  const Deadline& deadline_;
  std::vector<float> lengths_;  // of the path up to each waypoint
};

using Numbers = std::vector<double>;

/// The corner at q between edges along the unit vectors u and v, blended from `reach` before it to `reach` after it:
/// q(s) = q - reach u + u s + (v - u) s^2 / (4 reach).
bool is_blend_free(ConfigurationCheck& check, std::span<const double> q, const Numbers& u, const Numbers& v,
                   double reach) {
  std::vector<float> start, linear, square;
  for (std::size_t k = 0; k < q.size(); ++k) {
    start.push_back(static_cast<float>(q[k] - reach * u[k]));
    linear.push_back(static_cast<float>(2 * reach * u[k]));
    square.push_back(static_cast<float>(reach * (v[k] - u[k])));
  }
  return check.is_free({start, linear, square});
}

}  // namespace

double path_length(std::span<const float> rows, std::size_t n) {
  double length = 0;
  for (std::size_t i = 0; i + n < rows.size(); i += n) {
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) sum += std::pow(static_cast<double>(rows[i + n + k] - rows[i + k]), 2);
    length += std::sqrt(sum);
  }
  return length;
}

std::vector<float> shortened(ConfigurationCheck& check, std::vector<float> rows, std::size_t n,
                             const ShorteningSettings& settings, const Deadline& deadline) {
  Shortening path(check, std::move(rows), n, deadline);
  path.leave_out();
  RandomStream random(settings.seed, 1, 0);
  int failures = 0;
  for (int i = 0; i < settings.attempts && path.count() > 2 && failures < settings.most_failures; ++i) {
    if (deadline.has_passed()) break;
    failures = path.cut(random) ? 0 : failures + 1;
  }
  path.leave_out();
  return path.take();
}

Trajectory blended(ConfigurationCheck& check, std::span<const double> rows, std::size_t n, double reach,
                   const Deadline& deadline) {
  const std::size_t m = rows.size() / n;
  std::vector<Numbers> along(m - 1, Numbers(n));  // unit vectors of the edges
  Numbers length(m - 1);
  for (std::size_t i = 0; i + 1 < m; ++i) {
    for (std::size_t k = 0; k < n; ++k) along[i][k] = rows[(i + 1) * n + k] - rows[i * n + k];
    for (const double x : along[i]) length[i] += x * x;
    length[i] = std::sqrt(length[i]);
    for (double& x : along[i]) x /= length[i];
  }
  Numbers blend(m, 0.0);  // to either side of each waypoint
  constexpr int kHalvings = 6;
  for (std::size_t i = 1; i + 1 < m; ++i) {
    double asked = std::min({reach, length[i - 1] / 2, length[i] / 2});
    for (int h = 0; h < kHalvings && blend[i] == 0 && !deadline.has_passed(); ++h, asked /= 2) {
      if (is_blend_free(check, rows.subspan(i * n, n), along[i - 1], along[i], asked)) blend[i] = asked;
    }
  }
  Numbers breaks{0}, coefficients;
  const auto add = [&](double duration, const auto& start, const Numbers& slope, const auto& curvature) {
    if (duration <= 0) return;
    breaks.push_back(breaks.back() + duration);
    for (std::size_t k = 0; k < n; ++k) coefficients.push_back(start(k));
    coefficients.insert(coefficients.end(), slope.begin(), slope.end());
    for (std::size_t k = 0; k < n; ++k) coefficients.push_back(curvature(k));
  };
  for (std::size_t i = 0; i + 1 < m; ++i) {
    const auto straight = [&](std::size_t k) { return rows[i * n + k] + blend[i] * along[i][k]; };
    add(length[i] - blend[i] - blend[i + 1], straight, along[i], [](std::size_t) { return 0.0; });
    const auto bent = [&](std::size_t k) { return rows[(i + 1) * n + k] - blend[i + 1] * along[i][k]; };
    add(2 * blend[i + 1], bent, along[i],
        [&](std::size_t k) { return (along[i + 1][k] - along[i][k]) / (4 * blend[i + 1]); });
  }
  return {breaks, coefficients, n};
}

}  // namespace manyhands
