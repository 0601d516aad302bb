// Gradient steps per second of the learner, and its products beside Eigen's, by the thread's own clock.
#include <algorithm>
#include <cstdio>
#include <initializer_list>

#include "benchmarks/support.h"
#include "manyhands/learn/agent.h"
#include "manyhands/learn/product.h"

namespace benchmarks {

namespace {

using namespace manyhands::learn;

/// The least seconds of a few tries of `repeat` calls, per call.
template <class Body>
double seconds_per_call(int repeat, Body&& body) {
  double least = 1e9;
  for (int attempt = 0; attempt < 5; ++attempt) {
    const double begin = thread_seconds();
    for (int i = 0; i < repeat; ++i) body();
    least = std::min(least, (thread_seconds() - begin) / repeat);
  }
  return least;
}

/// One step of TD3 (two critics, the policy every second time) on random transitions, one thread.
void time_gradient_steps(const std::vector<int>& layers, int batch_size) {
  constexpr int kState = 24, kAction = 4;
  TrainerConfig config;
  config.hidden_layers = layers;
  config.batch_size = batch_size;
  config.num_critics = config.policy_delay = 2;
  config.target_noise = 0.2f;
  Agent agent(kState, kAction, config);
  Halves halves(1);
  for (int half = 0; half < 2; ++half) {
    agent.half(half).state.setRandom();
    agent.half(half).next_state.setRandom();
    agent.half(half).action.setRandom();
  }
  const double seconds = seconds_per_call(100, [&] { agent.update(halves, {.low = -1, .high = 1}); });
  std::printf("%zu layers of %3d, batch %4d   %7.0f gradient steps/s\n", layers.size(), layers[0], batch_size,
              1 / seconds);
}

/// The three products of a hidden layer of n units for half a mini-batch.
void time_products(int n, int batch) {
  Matrix<float> weight = Matrix<float>::Random(n, n), x = Matrix<float>::Random(n, batch), y = x, gradient = weight;
  std::vector<float> panel;
  const double flop = 2.0 * n * n * batch;
  const auto print = [&](const char* name, double ours, double eigens) {
    std::printf("%-10s %3d x %3d x %3d   ours %6.1f, Eigen %6.1f GFLOP/s\n", name, n, batch, n, flop / ours / 1e9,
                flop / eigens / 1e9);
  };
  const Operand<float> w{weight.data(), 1, n}, wt{weight.data(), n, 1}, xs{x.data(), 1, n}, xt{x.data(), n, 1};
  print("forward", seconds_per_call(200, [&] { multiply(n, batch, n, w, xs, y.data(), n, AsIs{}, panel); }),
        seconds_per_call(200, [&] { y.noalias() = weight * x; }));
  print("backward", seconds_per_call(200, [&] { multiply(n, batch, n, wt, xs, y.data(), n, AsIs{}, panel); }),
        seconds_per_call(200, [&] { y.noalias() = weight.transpose() * x; }));
  print("gradient", seconds_per_call(200, [&] { multiply(n, n, batch, xs, xt, gradient.data(), n, AsIs{}, panel); }),
        seconds_per_call(200, [&] { gradient.noalias() = x * x.transpose(); }));
}

}  // namespace

}  // namespace benchmarks

int main() {
  for (const int n : {64, 128, 256}) benchmarks::time_products(n, 128);
  benchmarks::time_gradient_steps({64, 64}, 256);
  benchmarks::time_gradient_steps({128, 128}, 256);
  benchmarks::time_gradient_steps({128, 128, 128}, 512);
  benchmarks::time_gradient_steps({256, 256, 256}, 256);
}
