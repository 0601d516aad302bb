#include "manyhands/learn/normaliser.h"

#include <algorithm>
#include <cmath>

namespace manyhands::learn {

namespace {

/// A feature that hardly moves is noise: it is not blown up beyond this standard deviation.
constexpr double kLeastDeviation = 1e-2;

}  // namespace

InputNormaliser::InputNormaliser(int observation_dim, int goal_dim, float clip)
    : observation_dim_(observation_dim), goal_dim_(goal_dim), clip_(clip) {
  const int dim = observation_dim + 2 * goal_dim;
  running_mean_.setZero(dim);
  sum_of_squares_.setZero(dim);
  mean_.setZero(dim);
  scale_.setOnes(dim);
  raw_.setZero(dim);
}

void InputNormaliser::add(const float* observation, const float* achieved_goal, const float* desired_goal) {
  std::copy_n(observation, observation_dim_, raw_.data());
  std::copy_n(desired_goal, goal_dim_, raw_.data() + observation_dim_);
  for (int i = 0; i < goal_dim_; ++i) raw_[observation_dim_ + goal_dim_ + i] = desired_goal[i] - achieved_goal[i];
  count_ += 1;
  for (Eigen::Index i = 0; i < raw_.size(); ++i) {
    const double before = raw_[i] - running_mean_[i];
    running_mean_[i] += before / count_;
    sum_of_squares_[i] += before * (raw_[i] - running_mean_[i]);
  }
}

void InputNormaliser::refresh() {
  if (count_ < 2) return;
  for (Eigen::Index i = 0; i < mean_.size(); ++i) {
    const double deviation = std::sqrt(sum_of_squares_[i] / count_);
    mean_[i] = static_cast<float>(running_mean_[i]);
    scale_[i] = static_cast<float>(1.0 / std::max(deviation, kLeastDeviation));
  }
}

void InputNormaliser::write(const float* observation, const float* achieved_goal, const float* desired_goal,
                            float* z) const {
  const auto normal = [&](float x, int i) { return std::clamp((x - mean_[i]) * scale_[i], -clip_, clip_); };
  const int no = observation_dim_, ng = goal_dim_;
  for (int i = 0; i < no; ++i) z[i] = normal(observation[i], i);
  for (int i = 0; i < ng; ++i) z[no + i] = normal(desired_goal[i], no + i);
  for (int i = 0; i < ng; ++i) z[no + ng + i] = normal(desired_goal[i] - achieved_goal[i], no + ng + i);
}

void InputNormaliser::save(ArchiveWriter& out) const {
  out.value(count_);
  out.array(std::span(running_mean_.data(), static_cast<std::size_t>(dim())));
  out.array(std::span(sum_of_squares_.data(), static_cast<std::size_t>(dim())));
  out.array(std::span(mean_.data(), static_cast<std::size_t>(dim())));
  out.array(std::span(scale_.data(), static_cast<std::size_t>(dim())));
}

void InputNormaliser::load(ArchiveReader& in) {
  in.value(count_);
  in.array(std::span(running_mean_.data(), static_cast<std::size_t>(dim())));
  in.array(std::span(sum_of_squares_.data(), static_cast<std::size_t>(dim())));
  in.array(std::span(mean_.data(), static_cast<std::size_t>(dim())));
  in.array(std::span(scale_.data(), static_cast<std::size_t>(dim())));
}

}  // namespace manyhands::learn
