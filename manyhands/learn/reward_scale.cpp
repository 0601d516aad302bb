#include "manyhands/learn/reward_scale.h"

#include <algorithm>
#include <cmath>

#include "manyhands/learn/parameters.h"

namespace manyhands::learn {

namespace {
constexpr double kLeastReturnDeviation = 1e-4;  // of returns: what hardly differs is not blown up
}  // namespace

RewardScale::RewardScale(int worlds, float gamma, bool on)
    : on_(on), gamma_(gamma), running_(Vector<float>::Zero(worlds)) {}

void RewardScale::add(std::span<const float> reward) {
  for (Eigen::Index w = 0; w < running_.size(); ++w) {
    running_[w] = gamma_ * running_[w] + reward[static_cast<std::size_t>(w)];
    count_ += 1;
    const double before = static_cast<double>(running_[w]) - mean_;
    mean_ += before / count_;
    sum_of_squares_ += before * (static_cast<double>(running_[w]) - mean_);
  }
}

float RewardScale::scale() const {
  if (!on_ || count_ < 2) return 1;
  return static_cast<float>(1 / std::max(std::sqrt(sum_of_squares_ / count_), kLeastReturnDeviation));
}

void RewardScale::save(ArchiveWriter& out) const {
  out.array(floats(running_));
  out.value(count_);
  out.value(mean_);
  out.value(sum_of_squares_);
}

void RewardScale::load(ArchiveReader& in) {
  in.array(floats(running_));
  in.value(count_);
  in.value(mean_);
  in.value(sum_of_squares_);
}

}  // namespace manyhands::learn
