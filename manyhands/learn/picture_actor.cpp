#include "manyhands/learn/picture_actor.h"

#include <algorithm>

namespace manyhands::learn {

void StateRow::write(const InputNormaliser& normaliser, const float* row, float* z) const {
  normaliser.write(row, row + observation_dim, row + observation_dim + goal_dim, z);
}

void StateRow::fill(const EnvBatch& envs, std::vector<float>& rows) const {
  rows.resize(static_cast<std::size_t>(envs.num_envs() * size()));
  for (int world = 0; world < envs.num_envs(); ++world) {
    float* to = rows.data() + world * size();
    to = std::copy_n(envs.observation().data() + world * observation_dim, observation_dim, to);
    to = std::copy_n(envs.achieved_goal().data() + world * goal_dim, goal_dim, to);
    std::copy_n(envs.desired_goal().data() + world * goal_dim, goal_dim, to);
  }
}

void PictureBatch::set(Eigen::Index sample, const PictureMemory& memory, int row, const StateRow& layout, int own,
                       const InputNormaliser& normaliser) {
  int number = 0;
  for (EncoderTape<float>& eye : tape.eyes) {
    eye.pictures[static_cast<std::size_t>(sample)] = memory.stack(row, number++);
  }
  layout.write(normaliser, memory.numbers(row), z.col(sample).data());
  std::copy_n(z.col(sample).data(), own, tape.own(sample, own));
}

PictureActor::PictureActor(const PictureNet<float>& net, const StateRow& layout, int own, int z_dim, int worlds,
                           int num_threads)
    : net_(net), layout_(layout), own_(own), worlds_(worlds), threads_(num_threads) {
  for (int half = 0; half < 2; ++half) {
    const int count = half == 0 ? worlds / 2 : worlds - worlds / 2;
    halves_[static_cast<std::size_t>(half)] = {net.make_tape(count), Matrix<float>::Zero(z_dim, count)};
  }
}

void PictureActor::act(const PictureMemory& memory, const InputNormaliser& normaliser,
                       std::span<const std::uint8_t> running, Matrix<float>& action) {
  threads_.run([&](int half) {
    PictureBatch& own = halves_[static_cast<std::size_t>(half)];
    const int first = half == 0 ? 0 : worlds_ / 2, newest = memory.size() - worlds_;
    for (int i = 0; i < own.tape.size(); ++i) {
      const bool is_wanted = running.empty() || running[static_cast<std::size_t>(first + i)] != 0;
      for (EncoderTape<float>& eye : own.tape.eyes) eye.pictures[static_cast<std::size_t>(i)].clear();
      if (is_wanted) own.set(i, memory, newest + first + i, layout_, own_, normaliser);
    }
    net_.forward(own.tape);
    action.middleCols(first, own.tape.size()) = own.tape.head.output().topRows(action.rows()).array().tanh();
  });
}

}  // namespace manyhands::learn
