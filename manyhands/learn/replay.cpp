#include "manyhands/learn/replay.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace manyhands::learn {

namespace {

/// Copies `n` floats and returns where the source goes on.
const float* take(const float* from, Eigen::Index n, float* to) {
  std::copy_n(from, n, to);
  return from + n;
}

float* put(std::span<const float> from, int begin, int n, float* to) { return std::copy_n(from.data() + begin, n, to); }

}  // namespace

ReplayBuffer::ReplayBuffer(const EnvSpec& spec, int capacity, int advice_dim, int privileged_dim,
                           const std::filesystem::path& folder)
    : spec_(spec), capacity_(capacity), advice_dim_(advice_dim), privileged_dim_(privileged_dim) {
  if (spec.max_episode_steps <= 0 || capacity < spec.max_episode_steps) {
    throw std::invalid_argument("ReplayBuffer: capacity " + std::to_string(capacity) + " cannot hold one episode of " +
                                std::to_string(spec.max_episode_steps) + " steps");
  }
  row_ = 2 * spec.observation_dim + 3 * spec.goal_dim + spec.action_dim + advice_dim + privileged_dim + 1;
  data_ = MemoryBlock(static_cast<std::size_t>(capacity) * static_cast<std::size_t>(row_) * sizeof(float), folder);
  steps_to_end_.resize(static_cast<std::size_t>(capacity));
  terminated_.resize(static_cast<std::size_t>(capacity));
}

void ReplayBuffer::add(const EpisodeView& episode) {
  const int no = spec_.observation_dim, ng = spec_.goal_dim, na = spec_.action_dim, length = episode.length;
  const auto has = [&](std::span<const float> rows, int count, int width) {
    return rows.size() == static_cast<std::size_t>(count) * static_cast<std::size_t>(width);
  };
  if (length <= 0 || length > capacity_ || !has(episode.observation, length + 1, no) ||
      !has(episode.achieved_goal, length + 1, ng) || !has(episode.desired_goal, 1, ng) ||
      !has(episode.action, length, na) || !has(episode.reward, length, 1) ||
      !has(episode.advice, length, advice_dim_) ||
      (privileged_dim_ > 0 && !has(episode.randomized, 1, privileged_dim_))) {
    throw std::invalid_argument("ReplayBuffer::add: the arrays do not fit an episode of " + std::to_string(length) +
                                " steps of " + spec_.id);
  }
  for (int t = 0; t < length; ++t) {
    const auto at = static_cast<std::size_t>(next_);
    float* to = data_.as<float>() + at * static_cast<std::size_t>(row_);
    to = put(episode.observation, t * no, no, to);
    to = put(episode.achieved_goal, t * ng, ng, to);
    to = put(episode.observation, (t + 1) * no, no, to);
    to = put(episode.achieved_goal, (t + 1) * ng, ng, to);
    to = put(episode.desired_goal, 0, ng, to);
    to = put(episode.action, t * na, na, to);
    to = put(episode.advice, t * advice_dim_, advice_dim_, to);
    to = put(episode.randomized, 0, privileged_dim_, to);
    const float reward = episode.reward[static_cast<std::size_t>(t)];
    *to = reward;
    steps_to_end_[at] = length - 1 - t;
    terminated_[at] = episode.terminated && t == length - 1;
    lowest_reward_ = std::min(lowest_reward_, reward);
    highest_reward_ = std::max(highest_reward_, reward);
    if (terminated_[at]) success_reward_ = std::min(success_reward_, reward);
    next_ = (next_ + 1) % capacity_;
    size_ = std::min(size_ + 1, capacity_);
  }
}

Minibatch ReplayBuffer::make_minibatch(int n, const Returns& returns) const {
  Minibatch batch;
  batch.returns = returns;
  for (Matrix<float>* m : {&batch.observation, &batch.next_observation}) m->setZero(spec_.observation_dim, n);
  for (Matrix<float>* m : {&batch.achieved_goal, &batch.next_achieved_goal, &batch.desired_goal}) {
    m->setZero(spec_.goal_dim, n);
  }
  batch.action.setZero(spec_.action_dim, n);
  batch.advice.setZero(advice_dim_, n);
  batch.randomized.setZero(privileged_dim_, n);
  batch.reward.setZero(n);
  batch.discount.setZero(n);
  batch.at.assign(static_cast<std::size_t>(n), 0);
  for (Matrix<float>* m : {&batch.step_achieved, &batch.step_goal}) m->setZero(spec_.goal_dim, n * returns.steps);
  batch.step_reward.setZero(n * returns.steps);
  return batch;
}

void ReplayBuffer::sample(const EnvBatch& task, const Hindsight& hindsight, Random random, Minibatch& batch) const {
  const int n = batch.size();
  batch.relabelled = static_cast<int>(std::lround(hindsight.fraction * n));
  for (int i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(random.below(static_cast<std::uint32_t>(size_)));
    batch.at[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(at);
    copy(at, i, batch);
    if (i >= batch.relabelled) continue;
    const std::uint32_t ahead = random.below(static_cast<std::uint32_t>(steps_to_end_[at]) + 1);
    take(next_achieved(later(at, ahead)), spec_.goal_dim, batch.desired_goal.col(i).data());
  }
  if (batch.relabelled > 0) reward_new_goals(task, batch);
  for (int i = 0; i < n; ++i) follow(i, hindsight, batch);
}

const float* ReplayBuffer::next_achieved(std::size_t at) const {
  return row(at) + 2 * spec_.observation_dim + spec_.goal_dim;
}

std::size_t ReplayBuffer::later(std::size_t at, std::uint32_t steps) const {
  return (at + steps) % static_cast<std::size_t>(capacity_);
}

void ReplayBuffer::copy(std::size_t at, int column, Minibatch& batch) const {
  const float* from = row(at);
  for (Matrix<float>* m : {&batch.observation, &batch.achieved_goal, &batch.next_observation, &batch.next_achieved_goal,
                           &batch.desired_goal, &batch.action, &batch.advice, &batch.randomized}) {
    from = take(from, m->rows(), m->col(column).data());
  }
}

/// Fills step_reward for all steps of each relabelled column; beyond the episode's end with what nobody reads.
void ReplayBuffer::reward_new_goals(const EnvBatch& task, Minibatch& batch) const {
  const int ng = spec_.goal_dim, steps = batch.returns.steps;
  for (int i = 0; i < batch.relabelled; ++i) {
    const auto at = static_cast<std::size_t>(batch.at[static_cast<std::size_t>(i)]);
    for (int j = 0; j < steps; ++j) {
      const auto ahead = static_cast<std::uint32_t>(std::min(j, steps_to_end_[at]));
      take(next_achieved(later(at, ahead)), ng, batch.step_achieved.col(i * steps + j).data());
      batch.step_goal.col(i * steps + j) = batch.desired_goal.col(i);
    }
  }
  const auto rewards = static_cast<std::size_t>(batch.relabelled * steps);
  const std::size_t goals = rewards * static_cast<std::size_t>(ng);
  task.compute_reward({batch.step_achieved.data(), goals}, {batch.step_goal.data(), goals},
                      {batch.step_reward.data(), rewards});
}

/// Sums a column's rewards over its steps, and sets what comes after them.
void ReplayBuffer::follow(int column, const Hindsight& hindsight, Minibatch& batch) const {
  const Returns& returns = batch.returns;
  const auto begin = static_cast<std::size_t>(batch.at[static_cast<std::size_t>(column)]);
  const bool relabelled = column < batch.relabelled;
  const int last = std::min(returns.steps - 1, steps_to_end_[begin]);
  float sum = 0, discount = 1;
  bool done = false;
  std::size_t at = begin;
  for (int j = 0; j <= last && !done; ++j) {
    at = later(begin, static_cast<std::uint32_t>(j));
    const float reward = relabelled ? batch.step_reward[column * returns.steps + j] : row(at)[row_ - 1];
    sum += discount * reward;
    discount *= returns.gamma;
    done = relabelled ? hindsight.success_terminates && reward >= success_reward_ : terminated_[at] != 0;
  }
  batch.reward[column] = sum;
  batch.discount[column] = done ? 0 : discount;
  if (at == begin) return;
  const float* from = take(row(at) + spec_.observation_dim + spec_.goal_dim, spec_.observation_dim,
                           batch.next_observation.col(column).data());
  take(from, spec_.goal_dim, batch.next_achieved_goal.col(column).data());
}

void ReplayBuffer::save(ArchiveWriter& out) const {
  const auto n = static_cast<std::size_t>(size_);
  out.value(capacity_);
  out.value(advice_dim_);
  out.value(privileged_dim_);
  out.value(size_);
  out.value(next_);
  out.value(lowest_reward_);
  out.value(highest_reward_);
  out.value(success_reward_);
  out.array(std::span(data_.as<float>(), n * static_cast<std::size_t>(row_)));
  out.array(std::span(steps_to_end_).first(n));
  out.array(std::span(terminated_).first(n));
}

void ReplayBuffer::load(ArchiveReader& in) {
  in.expect("replay capacity", capacity_);
  in.expect("advice length", advice_dim_);
  in.expect("number of values that critics alone see", privileged_dim_);
  in.value(size_);
  in.value(next_);
  in.check(size_ >= 0 && size_ <= capacity_ && next_ >= 0 && next_ < capacity_, "replay indices out of range");
  in.value(lowest_reward_);
  in.value(highest_reward_);
  in.value(success_reward_);
  const auto n = static_cast<std::size_t>(size_);
  in.array(std::span(data_.as<float>(), n * static_cast<std::size_t>(row_)));
  in.array(std::span(steps_to_end_).first(n));
  in.array(std::span(terminated_).first(n));
  for (const std::int32_t steps : std::span(steps_to_end_).first(n)) {
    in.check(steps >= 0 && steps < spec_.max_episode_steps, "a replay episode is longer than the task's");
  }
}

}  // namespace manyhands::learn
