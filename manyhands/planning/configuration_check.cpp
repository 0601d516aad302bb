#include "manyhands/planning/configuration_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "manyhands/math/instantiate.h"
#include "manyhands/planning/exact_check.h"
#include "manyhands/planning/lane_check.h"

namespace manyhands {

namespace {

constexpr int kWidth = width_v<NativeLanes>;
constexpr float kFinestSway = 0.5e-3f;  // below which a way that is not known to be free counts as blocked [m]
constexpr float kUnknown = 1e9f;        // how the speed of two that both move changes, relative to each other

}  // namespace

/// One motion at a time.
struct ConfigurationCheck::Scratch {
  Scratch(const PlanningScene& s, std::optional<PathConstraints> k)
      : scene(s), keep(std::move(k)), lanes(s), exact(s), fastest(s.size()), planned(s.size()) {
    for (std::vector<float>* list : {&sways.part_rate, &sways.part_bend}) list->resize(s.parts.size());
    for (std::vector<float>* list : {&sways.pair_rate, &sways.pair_bend}) list->resize(s.pairs.size());
  }

  void set_fastest(const MotionPiece& motion) {
    for (std::size_t k = 0; k < fastest.size(); ++k) fastest[k] = greatest_speed(motion, k);
  }

  void set_sways_of_parts(const MotionPiece& motion) {
    for (std::size_t i = 0; i < scene.parts.size(); ++i)
      std::tie(sways.part_rate[i], sways.part_bend[i]) = rate_and_bend(motion, scene.parts[i].reach);
  }

  void set_sways_of_pairs(const MotionPiece& motion) {
    for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
      std::tie(sways.pair_rate[i], sways.pair_bend[i]) = rate_and_bend(motion, scene.pairs[i].reach);
      if (scene.pairs[i].moves_both) sways.pair_bend[i] = kUnknown;
    }
  }

  /// A point p that joints in a row move has dp/dq_i dq_j = a_i x dp/dq_j, j after i, no longer than the reach of j:
  ///   |dp/dt|     <= sum_j reach_j |q_j'|
  ///   |d2p/dt2|   <= sum_j reach_j (|q_j'| (|q_j'| + 2 sum_i<j |q_i'|) + |q_j''|),   of which half counts with dt^2
  [[nodiscard]] std::pair<float, float> rate_and_bend(const MotionPiece& motion,
                                                      const std::vector<float>& reach) const {
    float rate = 0, bend = 0, turning = 0;
    for (std::size_t k = 0; k < fastest.size(); ++k) {
      if (reach[k] == 0) continue;
      rate += reach[k] * fastest[k];
      bend += reach[k] * (fastest[k] * (0.5f * fastest[k] + turning) + 0.5f * greatest_bend(motion, k));
      turning += fastest[k];
    }
    return {rate, bend};
  }

  void set_lanes(const MotionPiece& motion, const NativeLanes& t) {
    for (std::size_t k = 0; k < scene.size(); ++k) {
      lanes.coordinate(k) = coordinate_at(motion, k, t);
      lanes.slope(k) = fma(t, NativeLanes(2 * motion.square[k]), NativeLanes(motion.linear[k]));
    }
  }

  enum class Finding { kClear, kNear, kCollides };

  /// What exact distances say of the doubts about lane k: it is clear if all are more than the sways. Near an obstacle
  /// with the finest sway it counts as colliding.
  [[nodiscard]] Finding look_exactly(int k) {
    for (std::size_t j = 0; j < planned.size(); ++j) planned[j] = static_cast<double>(lane(lanes.coordinate(j), k));
    exact.place(planned);
    Finding found = Finding::kClear;
    for (const Doubt<NativeLanes>& doubt : lanes.doubts()) {
      if (!lane(doubt.lanes, k)) continue;
      const float sway = lane(doubt.sway, k);
      const double clear = scene.margin + static_cast<double>(sway);
      const double d = doubt.pair >= 0 ? exact.distance(scene.pairs[static_cast<std::size_t>(doubt.pair)], clear)
                                       : exact.distance(doubt.part, doubt.obstacle, clear);
      if (d < scene.margin || (d < clear && sway < kFinestSway)) return Finding::kCollides;
      if (d < clear) found = Finding::kNear;
    }
    return found;
  }

  /// Looks at the middles of parts of the way, dt to either side of each; those that remain open are replaced by their
  /// halves. False once one collides.
  [[nodiscard]] bool look_at(const MotionPiece& motion) {
    halves.clear();
    const std::size_t blocks = (open.size() + kWidth - 1) / kWidth;
    for (std::size_t block = 0; block < blocks; ++block) {
      // Lanes of a block are spread over the way: what collides shows early.
      std::array<float, kWidth> t{};
      for (std::size_t k = 0; k < kWidth; ++k) t[k] = open[std::min(block + k * blocks, open.size() - 1)];
      set_lanes(motion, load<NativeLanes>(t.data()));
      lanes.look(sways, mask_t<NativeLanes>(true));
      if (any(lanes.hit())) return false;
      const mask_t<NativeLanes> doubtful = lanes.undecided() | lanes.doubtful();
      if (none(doubtful)) continue;
      for (std::size_t k = 0; k < kWidth && block + k * blocks < open.size(); ++k) {
        const int i = static_cast<int>(k);
        if (!lane(doubtful, i)) continue;
        const Finding found = lane(lanes.undecided(), i) ? Finding::kNear : look_exactly(i);
        if (found == Finding::kCollides) return false;
        if (found == Finding::kClear) continue;
        halves.push_back(t[k] - sways.dt / 2);
        halves.push_back(t[k] + sways.dt / 2);
      }
    }
    std::swap(open, halves);
    return true;
  }

  /// Those that their maps do not keep apart all along.
  void find_pairs_to_look_at(const MotionPiece& motion) {
    pairs.clear();
    for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
      if (!stays_apart(scene.pairs[i].apart, motion)) pairs.push_back(i);
    }
  }

  [[nodiscard]] bool stays_apart(const ApartMap& map, const MotionPiece& motion) const {
    constexpr int kStretches = 16;
    constexpr float dt = 0.5f / kStretches;
    for (int stretch = 0; stretch < kStretches; ++stretch) {
      const float t = static_cast<float>(2 * stretch + 1) * dt;
      std::array<float, 2> low{}, high{};
      for (std::size_t axis = 0; axis < map.axes().size(); ++axis) {
        const std::size_t k = map.axes()[axis].coordinate;
        const float q = coordinate_at(motion, k, t);
        low[axis] = q - fastest[k] * dt;
        high[axis] = q + fastest[k] * dt;
      }
      if (!map.is_apart(low, high)) return false;
    }
    return true;
  }

  /// Of what is considered.
  [[nodiscard]] bool is_free(const MotionPiece& motion) {
    sways.dt = 0.5f / kWidth;
    open.clear();
    for (int k = 0; k < kWidth; ++k) open.push_back((static_cast<float>(2 * k) + 1) * sways.dt);
    while (!open.empty()) {
      if (!look_at(motion)) return false;
      sways.dt /= 2;
      lanes.consider_what_is_near();
    }
    return true;
  }

  const PlanningScene& scene;
  std::optional<PathConstraints> keep;
  LaneCheck<NativeLanes> lanes;
  internal::ExactCheck exact;
  Sways sways;
  std::vector<float> fastest;  // (n)
  std::vector<double> planned;
  std::vector<std::size_t> pairs;   // that are looked at
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
  // Most ways that are blocked are so by obstacles: pairs are looked at where none is.
  s.set_sways_of_parts(motion);
  s.lanes.consider_parts();
  if (!s.is_free(motion)) return false;
  s.set_sways_of_pairs(motion);
  s.find_pairs_to_look_at(motion);
  s.lanes.consider_pairs(s.pairs);
  return s.is_free(motion);
}

bool ConfigurationCheck::is_free(std::span<const float> a, std::span<const float> b) {
  Scratch& s = *scratch_;
  for (std::size_t k = 0; k < s.linear.size(); ++k) s.linear[k] = b[k] - a[k];
  return is_free({a, s.linear, s.square});
}

std::vector<std::uint8_t> ConfigurationCheck::are_free(std::span<const double> rows) {
  Scratch& s = *scratch_;
  const std::size_t n = s.scene.size(), count = rows.size() / n;
  s.sways.dt = 0;
  s.lanes.consider_all();
  std::vector<std::uint8_t> found(count, 1);
  for (std::size_t first = 0; first < count; first += kWidth) {
    const std::size_t together = std::min<std::size_t>(kWidth, count - first);
    for (std::size_t k = 0; k < kWidth; ++k) {
      const double* row = &rows[(first + std::min(k, together - 1)) * n];
      for (std::size_t j = 0; j < n; ++j)
        set_lane(s.lanes.coordinate(j), static_cast<int>(k), static_cast<float>(row[j]));
    }
    s.lanes.look(s.sways, mask_t<NativeLanes>(false));
    const mask_t<NativeLanes>& doubtful = s.lanes.doubtful();  // without sways nothing is undecided
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
