#include "manyhands/learn/normaliser.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace manyhands::learn {

namespace {

/// The unit of differences within an observation [m].
constexpr float kNear = 0.02f;

}  // namespace

InputNormaliser::InputNormaliser(int observation_dim, int goal_dim, float clip, Relations relations,
                                 double least_deviation)
    : observation_dim_(observation_dim),
      goal_dim_(goal_dim),
      clip_(clip),
      least_deviation_(least_deviation),
      relations_(std::move(relations)) {
  relations_.require_fit(observation_dim, goal_dim);
  const int measured = observation_dim + 2 * goal_dim + relations_.rotation_dim(), fixed = relations_.difference_dim();
  running_mean_.setZero(measured);
  sum_of_squares_.setZero(measured);
  mean_.setZero(measured + fixed);
  scale_.setOnes(measured + fixed);
  scale_.tail(fixed).setConstant(1 / kNear);
  raw_.setZero(measured + fixed);
}

InputNormaliser::InputNormaliser(int observation_dim, int goal_dim, float clip, Relations relations,
                                 std::span<const float> mean, std::span<const float> scale)
    : InputNormaliser(observation_dim, goal_dim, clip, std::move(relations)) {
  if (mean.size() != static_cast<std::size_t>(dim()) || scale.size() != mean.size()) {
    throw std::invalid_argument("mean and scale are of " + std::to_string(mean.size()) + " and " +
                                std::to_string(scale.size()) + " inputs, not of " + std::to_string(dim()));
  }
  std::ranges::copy(mean, mean_.data());
  std::ranges::copy(scale, scale_.data());
}

void InputNormaliser::write_raw(const float* observation, const float* achieved_goal, const float* desired_goal,
                                float* x) const {
  x = std::copy_n(observation, observation_dim_, x);
  x = std::copy_n(desired_goal, goal_dim_, x);
  for (int i = 0; i < goal_dim_; ++i) *x++ = desired_goal[i] - achieved_goal[i];
  relations_.write(observation, desired_goal, x);
}

void InputNormaliser::add(const float* observation, const float* achieved_goal, const float* desired_goal) {
  write_raw(observation, achieved_goal, desired_goal, raw_.data());
  count_ += 1;
  for (Eigen::Index i = 0; i < running_mean_.size(); ++i) {
    const double before = raw_[i] - running_mean_[i];
    running_mean_[i] += before / count_;
    sum_of_squares_[i] += before * (raw_[i] - running_mean_[i]);
  }
}

void InputNormaliser::refresh() {
  if (count_ < 2) return;
  for (Eigen::Index i = 0; i < running_mean_.size(); ++i) {
    const double deviation = std::sqrt(sum_of_squares_[i] / count_);
    mean_[i] = static_cast<float>(running_mean_[i]);
    scale_[i] = static_cast<float>(1.0 / std::max(deviation, least_deviation_));
  }
}

void InputNormaliser::write(const float* observation, const float* achieved_goal, const float* desired_goal,
                            float* z) const {
  write_raw(observation, achieved_goal, desired_goal, z);
  for (Eigen::Index i = 0; i < mean_.size(); ++i) z[i] = std::clamp((z[i] - mean_[i]) * scale_[i], -clip_, clip_);
}

void InputNormaliser::save(ArchiveWriter& out) const {
  out.value(count_);
  out.array(std::span(running_mean_.data(), static_cast<std::size_t>(running_mean_.size())));
  out.array(std::span(sum_of_squares_.data(), static_cast<std::size_t>(sum_of_squares_.size())));
  out.array(std::span(mean_.data(), static_cast<std::size_t>(dim())));
  out.array(std::span(scale_.data(), static_cast<std::size_t>(dim())));
}

void InputNormaliser::load(ArchiveReader& in) {
  in.value(count_);
  in.array(std::span(running_mean_.data(), static_cast<std::size_t>(running_mean_.size())));
  in.array(std::span(sum_of_squares_.data(), static_cast<std::size_t>(sum_of_squares_.size())));
  in.array(std::span(mean_.data(), static_cast<std::size_t>(dim())));
  in.array(std::span(scale_.data(), static_cast<std::size_t>(dim())));
}

}  // namespace manyhands::learn
