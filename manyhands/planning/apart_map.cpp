#include "manyhands/planning/apart_map.h"

#include <algorithm>

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

}  // namespace manyhands
