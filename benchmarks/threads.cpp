// What a second thread can bring on this machine: two "cores" may be two halves of one.
//
// Both threads do the same fixed work and share nothing: pure multiply-adds, and Reach batches of one thread each. The
// second is the most that a batch of two threads could reach.
#include <barrier>
#include <functional>
#include <random>
#include <thread>

#include "benchmarks/support.h"
#include "manyhands/envs/make.h"

namespace benchmarks {

namespace {

using namespace manyhands;

/// Enough independent chains to keep every multiplier busy.
constexpr int kChains = 12;

void multiply_add(int count) {
  std::array<NativeLanes, kChains> chains;
  chains.fill(NativeLanes(1.0F));
  const NativeLanes a(0.999F), b(0.001F);
  for (int i = 0; i < count; ++i) {
    for (NativeLanes& x : chains) x = fma(x, a, b);
  }
  consume(chains.data());
}

/// Wall seconds until `threads` threads have each done their work, all of them starting together.
double seconds_of(int threads, const std::function<void(int)>& work) {
  std::barrier start(threads);
  std::vector<double> begin(static_cast<std::size_t>(threads)), end(begin);
  const auto body = [&](int thread) {
    start.arrive_and_wait();
    begin[static_cast<std::size_t>(thread)] = wall_seconds();
    work(thread);
    end[static_cast<std::size_t>(thread)] = wall_seconds();
  };
  {
    std::vector<std::jthread> others;
    for (int thread = 1; thread < threads; ++thread) others.emplace_back(body, thread);
    body(0);
  }
  return *std::ranges::max_element(end) - *std::ranges::min_element(begin);
}

/// Rates of 1 and 2 threads at `units` of work a thread, measured in turns.
void compare_threads(const Settings& settings, const char* name, const char* unit, double units,
                     const std::function<void(int)>& work) {
  std::array<std::vector<double>, 2> seconds;
  seconds_of(2, work);
  for (int round = 0; round < settings.rounds; ++round) {
    for (int threads = 1; threads <= 2; ++threads) {
      seconds[static_cast<std::size_t>(threads - 1)].push_back(seconds_of(threads, work));
    }
  }
  for (int threads = 1; threads <= 2; ++threads) {
    const std::vector<double>& s = seconds[static_cast<std::size_t>(threads - 1)];
    const double rate = units * threads / median(s);
    print({name, number_name<NativeLanes>(), threads, rate, unit, rate, variation(s), 0, ""});
  }
}

void run(const Settings& settings) {
  const int count = static_cast<int>(settings.seconds * 1e8);
  compare_threads(settings, "multiply-add peak", "Gflop/s", 1e-9 * 2.0 * width_v<NativeLanes> * kChains * count,
                  [&](int) { multiply_add(count); });

  constexpr int kWorlds = 256;
  const int steps = std::max(1, static_cast<int>(settings.seconds * 500));
  std::array<std::unique_ptr<EnvBatch>, 2> batches;
  for (auto& batch : batches) batch = make_env_batch("PandaReach-v3", kWorlds, {.num_threads = 1});
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<float> action(static_cast<std::size_t>(kWorlds) * 3);
  for (float& a : action) a = uniform(random);
  compare_threads(settings, "Reach, one batch a thread", "env steps/s", static_cast<double>(kWorlds) * steps,
                  [&](int thread) {
                    for (int i = 0; i < steps; ++i) batches[static_cast<std::size_t>(thread)]->step(action);
                  });
}

}  // namespace

}  // namespace benchmarks

int main(int argc, char** argv) {
  benchmarks::run(benchmarks::parse(argc, argv, "What a second thread can bring on this machine."));
  return 0;
}
