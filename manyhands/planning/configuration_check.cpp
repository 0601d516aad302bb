#include "manyhands/planning/configuration_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "manyhands/math/instantiate.h"
#include "manyhands/planning/exact_check.h"
#include "manyhands/planning/lane_check.h"

namespace manyhands {

namespace {

constexpr int kWidth = width_v<NativeLanes>;
constexpr float kFinestSway = 0.5e-3f;  // below which a way that is not known to be free counts as blocked [m]
constexpr float kWorthExact = 0.01f;    // below which exact distances are asked, not the halves of the way [m]

}  // namespace

/// One motion at a time.
struct ConfigurationCheck::Scratch {
  Scratch(const PlanningScene& s, std::optional<PathConstraints> k)
      : scene(s),
        keep(std::move(k)),
        lanes(s),
        exact(s),
        sways{std::vector<float>(s.parts.size()), std::vector<float>(s.pairs.size())},
        fastest(s.size()),
        planned(s.size()) {}

  /// Of parts and pairs, where each coordinate changes by `fastest` at most per unit of t, and t by dt to either side.
  float set_sways(float dt) {
    float largest = 0;
    const auto sway = [&](const std::vector<float>& reach) {
      float sum = 0;
      for (std::size_t k = 0; k < fastest.size(); ++k) sum += reach[k] * fastest[k];
      largest = std::max(largest, sum * dt);
      return sum * dt;
    };
    for (std::size_t i = 0; i < scene.parts.size(); ++i) sways.part[i] = sway(scene.parts[i].reach);
    for (std::size_t i = 0; i < scene.pairs.size(); ++i) sways.pair[i] = sway(scene.pairs[i].reach);
    return largest;
  }

  void set_fastest(const MotionPiece& motion) {
    for (std::size_t k = 0; k < fastest.size(); ++k) fastest[k] = greatest_speed(motion, k);
  }

  void set_lanes(const MotionPiece& motion, const NativeLanes& t) {
    for (std::size_t k = 0; k < scene.size(); ++k) lanes.coordinate(k) = coordinate_at(motion, k, t);
  }

  enum class Finding { kClear, kNear, kCollides };

  /// What exact distances say of the doubts about lane k: it is clear if all are more than the sways.
  [[nodiscard]] Finding look_exactly(int k) {
    for (std::size_t j = 0; j < planned.size(); ++j) planned[j] = static_cast<double>(lane(lanes.coordinate(j), k));
    exact.place(planned);
    Finding found = Finding::kClear;
    for (const Doubt<NativeLanes>& doubt : lanes.doubts()) {
      if (!lane(doubt.lanes, k)) continue;
      const bool is_pair = doubt.pair >= 0;
      const auto sway = static_cast<double>(is_pair ? sways.pair[static_cast<std::size_t>(doubt.pair)]
                                                    : sways.part[static_cast<std::size_t>(doubt.part)]);
      const double clear = scene.margin + sway;
      const double d = is_pair ? exact.distance(scene.pairs[static_cast<std::size_t>(doubt.pair)], clear)
                               : exact.distance(doubt.part, doubt.obstacle, clear);
      if (d < scene.margin) return Finding::kCollides;
      if (d < clear) found = Finding::kNear;
    }
    return found;
  }

  /// Looks at the middles of parts of the way, `half` to either side of each; those that remain open are replaced by
  /// their halves. False once one collides.
  [[nodiscard]] bool look_at(const MotionPiece& motion, float half, bool ask_exact) {
    halves.clear();
    for (std::size_t first = 0; first < open.size(); first += kWidth) {
      const std::size_t count = std::min<std::size_t>(kWidth, open.size() - first);
      std::array<float, kWidth> t{};
      for (std::size_t k = 0; k < kWidth; ++k) t[k] = open[first + std::min(k, count - 1)];
      set_lanes(motion, load<NativeLanes>(t.data()));
      lanes.look(sways, mask_t<NativeLanes>(true));
      if (any(lanes.hit())) return false;
      const mask_t<NativeLanes>& doubtful = lanes.doubtful();
      if (none(doubtful)) continue;
      for (std::size_t k = 0; k < count; ++k) {
        if (!lane(doubtful, static_cast<int>(k))) continue;
        const Finding found = ask_exact ? look_exactly(static_cast<int>(k)) : Finding::kNear;
        if (found == Finding::kCollides) return false;
        if (found == Finding::kClear) continue;
        halves.push_back(t[k] - half / 2);
        halves.push_back(t[k] + half / 2);
      }
    }
    std::swap(open, halves);
    return true;
  }

  const PlanningScene& scene;
  std::optional<PathConstraints> keep;
  LaneCheck<NativeLanes> lanes;
  internal::ExactCheck exact;
  Sways sways;
  std::vector<float> fastest;  // (n)
  std::vector<double> planned;
  std::vector<float> open, halves;  // middles of parts of the way
  std::vector<float> linear, square;
};

ConfigurationCheck::ConfigurationCheck(const PlanningScene& scene, std::optional<PathConstraints> keep)
    : scratch_(std::make_unique<Scratch>(scene, std::move(keep))) {
  scratch_->linear.resize(scene.size());
  scratch_->square.assign(scene.size(), 0.0f);
}
ConfigurationCheck::~ConfigurationCheck() = default;
ConfigurationCheck::ConfigurationCheck(ConfigurationCheck&&) noexcept = default;

PathConstraints* ConfigurationCheck::constraints() { return scratch_->keep ? &*scratch_->keep : nullptr; }

bool ConfigurationCheck::is_free(const MotionPiece& motion) {
  Scratch& s = *scratch_;
  if (s.keep && !s.keep->hold(motion)) return false;
  s.set_fastest(motion);
  float half = 0.5f / kWidth;
  s.open.clear();
  for (int k = 0; k < kWidth; ++k) s.open.push_back((static_cast<float>(2 * k) + 1) * half);
  while (!s.open.empty()) {
    const float sway = s.set_sways(half);
    if (!s.look_at(motion, half, sway < kWorthExact)) return false;
    if (sway < kFinestSway) return s.open.empty();
    half /= 2;
  }
  return true;
}

bool ConfigurationCheck::is_free(std::span<const float> a, std::span<const float> b) {
  Scratch& s = *scratch_;
  for (std::size_t k = 0; k < s.linear.size(); ++k) s.linear[k] = b[k] - a[k];
  return is_free({a, s.linear, s.square});
}

std::vector<std::uint8_t> ConfigurationCheck::are_free(std::span<const double> rows) {
  Scratch& s = *scratch_;
  const std::size_t n = s.scene.size(), count = rows.size() / n;
  std::ranges::fill(s.fastest, 0.0f);
  s.set_sways(0);
  std::vector<std::uint8_t> found(count, 1);
  for (std::size_t first = 0; first < count; first += kWidth) {
    const std::size_t together = std::min<std::size_t>(kWidth, count - first);
    for (std::size_t k = 0; k < kWidth; ++k) {
      const double* row = &rows[(first + std::min(k, together - 1)) * n];
      for (std::size_t j = 0; j < n; ++j)
        set_lane(s.lanes.coordinate(j), static_cast<int>(k), static_cast<float>(row[j]));
    }
    s.lanes.look(s.sways, mask_t<NativeLanes>(false));
    const mask_t<NativeLanes>& doubtful = s.lanes.doubtful();
    for (std::size_t k = 0; k < together; ++k) {
      const int i = static_cast<int>(k);
      found[first + k] =
          !lane(s.lanes.hit(), i) && (!lane(doubtful, i) || s.look_exactly(i) == Scratch::Finding::kClear);
    }
  }
  return found;
}

Encounter ConfigurationCheck::nearest(std::span<const double> planned) {
  scratch_->exact.place(planned);
  return scratch_->exact.nearest(std::numeric_limits<double>::infinity());
}

std::optional<Encounter> ConfigurationCheck::encounter(std::span<const double> planned) {
  scratch_->exact.place(planned);
  Encounter found = scratch_->exact.nearest(scratch_->scene.margin);
  if (found.a.empty()) return {};
  return found;
}

}  // namespace manyhands
