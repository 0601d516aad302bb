#include "manyhands/planning/steering.h"

#include <algorithm>
#include <cmath>

#include "manyhands/math/vec3.h"

namespace manyhands {

namespace {

constexpr float kLongestConstrainedStep = 0.5f;  // along constraints: longer ones rarely hold [rad or m]
constexpr float kShortestConstrainedStep = 0.01f;
constexpr float kProgress = 0.2f;  // of a step, by which it must lead nearer

float distance_between(std::span<const float> a, std::span<const float> b) {
  float sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += square(b[k] - a[k]);
  return std::sqrt(sum);
}

/// Sets `to` to the point a step away from `from`, or to the target if that is nearer; whether it is.
bool step_straight(std::span<const float> from, std::span<const float> target, float distance, float step,
                   std::span<float> to) {
  const bool arrives = distance <= step;
  for (std::size_t k = 0; k < to.size(); ++k)
    to[k] = arrives ? target[k] : from[k] + (step / distance) * (target[k] - from[k]);
  return arrives;
}

}  // namespace

Step step_towards(ConfigurationCheck& check, std::span<const float> from, std::span<const float> target, float range,
                  std::span<float> to) {
  const float far = distance_between(from, target);
  PathConstraints* constraints = check.constraints();
  if (constraints == nullptr) return step_straight(from, target, far, range, to) ? Step::kArrives : Step::kAdvances;
  for (float step = std::min(range, kLongestConstrainedStep); step >= kShortestConstrainedStep; step /= 2) {
    const bool would_arrive = step_straight(from, target, far, step, to);
    if (!constraints->project(to)) continue;
    const float left = distance_between(to, target);
    if (left > far - kProgress * std::min(step, far)) continue;
    if (constraints->hold(from, to)) return would_arrive && left == 0 ? Step::kArrives : Step::kAdvances;
  }
  return Step::kStuck;
}

std::optional<std::vector<float>> way_between(ConfigurationCheck& check, std::span<const float> a,
                                              std::span<const float> b) {
  const std::size_t n = a.size();
  std::vector<float> rows, from(a.begin(), a.end()), to(n);
  if (check.constraints() == nullptr) {
    if (!check.is_free(a, b)) return {};
    return rows;
  }
  for (;;) {
    const Step step = step_towards(check, from, b, kLongestConstrainedStep, to);
    if (step == Step::kStuck || !check.is_free(from, to)) return {};
    if (step == Step::kArrives) return rows;
    rows.insert(rows.end(), to.begin(), to.end());
    std::swap(from, to);
  }
}

}  // namespace manyhands
