#include "manyhands/physics/collision/broad/broad_phase.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "manyhands/math/lanes.h"

namespace manyhands {
namespace {

using Wide = Lanes<float, 16>;
constexpr std::size_t kWide = width_v<Wide>;
constexpr float kEndless = std::numeric_limits<float>::infinity();

double component(const Vec3<double>& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// A float not above x, or not below: by at most two roundings.
float rounded_down(double x) {
  return static_cast<float>(x - std::abs(x) * 0x1p-23) - std::numeric_limits<float>::min();
}
float rounded_up(double x) { return static_cast<float>(x + std::abs(x) * 0x1p-23) + std::numeric_limits<float>::min(); }

/// The low end as a key for sorting: bounds with a NaN go last.
double sort_key(const Aabb<double>& bounds, int axis) {
  const double low = component(bounds.low, axis);
  return std::isnan(low) ? std::numeric_limits<double>::infinity() : low;
}

/// The axis along which the centres of the finite bounds vary most; the current one unless another is clearly better.
int widest_axis(std::span<const Aabb<double>> bounds, std::span<const std::uint32_t> geoms, int current) {
  std::array<double, 3> sum{}, square{};
  double count = 0;
  for (const std::uint32_t g : geoms) {
    const Vec3<double> centre = 0.5 * (bounds[g].low + bounds[g].high);
    if (!is_finite(squared_norm(centre))) continue;
    count += 1;
    for (std::size_t i = 0; i < 3; ++i) {
      const double x = component(centre, static_cast<int>(i));
      sum[i] += x;
      square[i] += x * x;
    }
  }
  int best = std::max(current, 0);
  const auto variance = [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    return count > 0 ? square[k] / count - (sum[k] / count) * (sum[k] / count) : 0.0;
  };
  for (int i = 0; i < 3; ++i) {
    if (variance(i) > (best == current ? 1.5 : 1.0) * variance(best)) best = i;
  }
  return best;
}

}  // namespace

BroadPhase::BroadPhase(const std::vector<bool>& is_static) : count_(is_static.size() + 1) {
  for (std::size_t g = 0; g < is_static.size(); ++g) {
    (is_static[g] ? static_ : moving_).geom.push_back(static_cast<std::uint32_t>(g));
  }
  moving_.reserve();
  static_.reserve();
}

void BroadPhase::Sorted::reserve() {
  key.resize(geom.size());
  for (auto* ends : {&low, &high, &low_1, &high_1, &low_2, &high_2}) ends->assign(geom.size() + kWide, kEndless);
}

void BroadPhase::Sorted::sort(std::span<const Aabb<double>> bounds, int axis, bool afresh) {
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    return sort_key(bounds[a], axis) < sort_key(bounds[b], axis);
  };
  for (std::size_t k = 0; k < geom.size(); ++k) key[k] = sort_key(bounds[geom[k]], axis);
  // Little changes in a step, so that insertion is nearly linear; where much has, it gives up.
  std::size_t moves_left = afresh ? 0 : 16 * geom.size();
  for (std::size_t k = 1; k < geom.size() && moves_left > 0; ++k) {
    const double k_key = key[k];
    const std::uint32_t g = geom[k];
    std::size_t i = k;
    for (; i > 0 && key[i - 1] > k_key; --i) {
      key[i] = key[i - 1];
      geom[i] = geom[i - 1];
    }
    key[i] = k_key;
    geom[i] = g;
    moves_left -= std::min(moves_left, k - i);
  }
  if (moves_left == 0) std::sort(geom.begin(), geom.end(), before);

  const int axis_1 = (axis + 1) % 3, axis_2 = (axis + 2) % 3;
  for (std::size_t k = 0; k < geom.size(); ++k) {
    const Aabb<double>& b = bounds[geom[k]];
    low[k] = rounded_down(sort_key(b, axis));
    high[k] = rounded_up(component(b.high, axis));
    low_1[k] = rounded_down(component(b.low, axis_1));
    high_1[k] = rounded_up(component(b.high, axis_1));
    low_2[k] = rounded_down(component(b.low, axis_2));
    high_2[k] = rounded_up(component(b.high, axis_2));
  }
}

/// Adds the pairs of of.geom[which] with all among.geom from the first on that begin before its bounds end.
void BroadPhase::find(std::span<const Aabb<double>> bounds, const Sorted& among, std::size_t first, const Sorted& of,
                      std::size_t which) {
  const std::uint32_t g = of.geom[which];
  const Wide high(of.high[which]), low_1(of.low_1[which]), high_1(of.high_1[which]), low_2(of.low_2[which]),
      high_2(of.high_2[which]);
  for (std::size_t k = first; k < among.geom.size() && among.low[k] <= of.high[which]; k += kWide) {
    const auto hit = (load<Wide>(&among.low[k]) <= high) & (load<Wide>(&among.low_1[k]) <= high_1) &
                     (load<Wide>(&among.high_1[k]) >= low_1) & (load<Wide>(&among.low_2[k]) <= high_2) &
                     (load<Wide>(&among.high_2[k]) >= low_2);
    if (none(hit)) continue;
    const std::size_t end = std::min(kWide, among.geom.size() - k);
    for (std::size_t i = 0; i < end; ++i) {
      if (!lane(hit, static_cast<int>(i))) continue;
      const std::uint32_t other = among.geom[k + i];
      if (overlap(bounds[g], bounds[other])) pairs_.push_back({std::min(g, other), std::max(g, other)});
    }
  }
}

/// By counting, first by b, then by a.
void BroadPhase::sort_pairs() {
  scratch_.resize(std::max(scratch_.capacity(), pairs_.capacity()));
  const auto pass = [&](auto part, const std::vector<NearPair>& from, std::size_t n, NearPair* to) {
    std::fill(count_.begin(), count_.end(), 0);
    for (std::size_t k = 0; k < n; ++k) ++count_[part(from[k]) + 1];
    for (std::size_t g = 1; g < count_.size(); ++g) count_[g] += count_[g - 1];
    for (std::size_t k = 0; k < n; ++k) to[count_[part(from[k])]++] = from[k];
  };
  pass([](const NearPair& p) { return p.b; }, pairs_, pairs_.size(), scratch_.data());
  pass([](const NearPair& p) { return p.a; }, scratch_, pairs_.size(), pairs_.data());
}

std::span<const NearPair> BroadPhase::update(std::span<const Aabb<double>> bounds) {
  if (bounds.size() + 1 != count_.size()) {
    throw std::invalid_argument("BroadPhase::update: " + std::to_string(bounds.size()) + " bounds for " +
                                std::to_string(count_.size() - 1) + " geoms; give the bounds of every geom");
  }
  const int axis = widest_axis(bounds, moving_.geom, axis_);
  moving_.sort(bounds, axis, axis != axis_);
  static_.sort(bounds, axis, axis != axis_);
  axis_ = axis;

  pairs_.clear();
  // Of two that overlap along the axis one begins first, or both at once; the sorted order decides between movers.
  std::size_t begins_after = 0;
  for (std::size_t k = 0; k < moving_.geom.size(); ++k) {
    find(bounds, moving_, k + 1, moving_, k);
    while (begins_after < static_.geom.size() && static_.low[begins_after] < moving_.low[k]) ++begins_after;
    find(bounds, static_, begins_after, moving_, k);
  }
  begins_after = 0;
  for (std::size_t k = 0; k < static_.geom.size(); ++k) {
    while (begins_after < moving_.geom.size() && moving_.low[begins_after] <= static_.low[k]) ++begins_after;
    find(bounds, moving_, begins_after, static_, k);
  }
  sort_pairs();
  return pairs_;
}

}  // namespace manyhands
