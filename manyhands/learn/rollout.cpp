#include "manyhands/learn/rollout.h"

#include "manyhands/learn/parameters.h"

namespace manyhands::learn {

Rollout::Rollout(int length, int count, int state_dim, int action_dim, int advice_dim) : steps(length), worlds(count) {
  const int n = steps * worlds;
  state.setZero(state_dim, n);
  action.setZero(action_dim, n);
  advice.setZero(advice_dim, n);
  for (Vector<float>* v : {&log_probability, &value, &reward, &last_value, &advantage, &value_target}) v->setZero(n);
  ended.assign(static_cast<std::size_t>(n), 0);
}

void Rollout::set_advantages(const Vector<float>& value_now, float gamma, float lambda) {
  for (int w = 0; w < worlds; ++w) {
    float next_value = value_now[w], next_advantage = 0;
    for (int t = steps - 1; t >= 0; --t) {
      const int i = t * worlds + w;
      if (ended[static_cast<std::size_t>(i)] != 0) {
        next_value = last_value[i];
        next_advantage = 0;
      }
      advantage[i] = reward[i] + gamma * next_value - value[i] + gamma * lambda * next_advantage;
      value_target[i] = advantage[i] + value[i];
      next_value = value[i];
      next_advantage = advantage[i];
    }
  }
}

void Rollout::save(ArchiveWriter& out) const {
  out.value(filled);
  for (const Matrix<float>* m : {&state, &action, &advice}) out.array(floats(*m));
  for (const Vector<float>* v : {&log_probability, &value, &reward, &last_value}) out.array(floats(*v));
  out.array(std::span(ended));
}

void Rollout::load(ArchiveReader& in) {
  in.value(filled);
  in.check(filled >= 0 && filled <= steps, "a rollout has a wrong length");
  for (Matrix<float>* m : {&state, &action, &advice}) in.array(floats(*m));
  for (Vector<float>* v : {&log_probability, &value, &reward, &last_value}) in.array(floats(*v));
  in.array(std::span(ended));
}

}  // namespace manyhands::learn
