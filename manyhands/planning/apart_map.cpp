#include "manyhands/planning/apart_map.h"

#include <algorithm>
#include <cmath>

#include "manyhands/planning/exact_check.h"

namespace manyhands {

ApartMap::ApartMap(std::vector<Axis> axes) : axes_(std::move(axes)), open_((kCells + 1) * (kCells + 1)) {
  const Box all = whole();
  for (std::size_t i = 0; i < all.count[0]; ++i) {
    for (std::size_t j = 0; j < all.count[1]; ++j) open_[place(i + 1, j + 1)] = 1;
  }
}

ApartMap::Box ApartMap::whole() const { return {.count = {kCells, axes_.size() > 1 ? kCells : 1}}; }

double ApartMap::width(std::size_t axis) const { return (axes_[axis].upper - axes_[axis].lower) / kCells; }

double ApartMap::middle(const Box& box, std::size_t axis) const {
  return axes_[axis].lower +
         width(axis) * (static_cast<double>(box.first[axis]) + 0.5 * static_cast<double>(box.count[axis]));
}

double ApartMap::half_width(const Box& box, std::size_t axis) const {
  return 0.5 * width(axis) * static_cast<double>(box.count[axis]);
}

void ApartMap::set_apart(const Box& box) {
  for (std::size_t i = 0; i < box.count[0]; ++i) {
    for (std::size_t j = 0; j < box.count[1]; ++j) open_[place(box.first[0] + i + 1, box.first[1] + j + 1)] = 0;
  }
}

void ApartMap::finish() {
  for (std::size_t i = 1; i <= kCells; ++i) {
    for (std::size_t j = 1; j <= kCells; ++j)
      open_[place(i, j)] += open_[place(i - 1, j)] + open_[place(i, j - 1)] - open_[place(i - 1, j - 1)];
  }
}

bool ApartMap::is_apart(const std::array<float, 2>& low, const std::array<float, 2>& high) const {
  if (axes_.empty()) return false;
  std::array<std::size_t, 2> first{0, 0}, last{1, 1};
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const double from = static_cast<double>(low[axis]), to = static_cast<double>(high[axis]);
    if (from < axes_[axis].lower || to > axes_[axis].upper) return false;
    const auto cell = [&](double q) {
      return std::min(kCells - 1, static_cast<std::size_t>((q - axes_[axis].lower) / width(axis)));
    };
    first[axis] = cell(from);
    last[axis] = cell(to) + 1;
  }
  return open_[place(last[0], last[1])] - open_[place(first[0], last[1])] - open_[place(last[0], first[1])] +
             open_[place(first[0], first[1])] ==
         0;
}

ApartMap internal::apart_map(const PlanningScene& scene, const PartPair& pair, ExactCheck& exact) {
  constexpr std::size_t kMostJoints = 2;
  constexpr double kHair = 1e-5;        // that users and float may be outside of limits by [rad or m]
  constexpr double kFinestSway = 0.01;  // [m]
  std::vector<ApartMap::Axis> between;
  for (std::size_t k = 0; k < scene.size(); ++k) {
    if (pair.reach[k] == 0) continue;
    between.push_back({k, scene.lower[k] - kHair, scene.upper[k] + kHair});
    if (!std::isfinite(scene.lower[k]) || !std::isfinite(scene.upper[k])) return {};
  }
  if (between.size() > kMostJoints) return {};
  ApartMap map(between);
  std::vector<double> q = scene.planned(scene.q);
  std::vector<ApartMap::Box> boxes{map.whole()};
  while (!boxes.empty()) {
    ApartMap::Box box = boxes.back();
    boxes.pop_back();
    double sway = 0, most = 0;
    std::size_t widest = 0;
    for (std::size_t axis = 0; axis < between.size(); ++axis) {
      q[between[axis].coordinate] = map.middle(box, axis);
      const double own = static_cast<double>(pair.reach[between[axis].coordinate]) * map.half_width(box, axis);
      sway += own;
      if (box.count[axis] == 1 || own <= most) continue;
      most = own;
      widest = axis;
    }
    exact.place(q);
    const double needed = scene.margin + sway, d = exact.distance(pair, needed);
    if (d >= needed) map.set_apart(box);
    if (d >= needed || d <= scene.margin - sway || sway < kFinestSway || most == 0) continue;
    box.count[widest] /= 2;
    boxes.push_back(box);
    box.first[widest] += box.count[widest];
    boxes.push_back(box);
  }
  map.finish();
  return map;
}

}  // namespace manyhands
