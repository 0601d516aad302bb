// A policy that ships with the Python package acts in C++: environments and network step 256 worlds at a time.
//
//   cmake --build --preset release --target trained_policy
//   build/release/examples/trained_policy [FILE.onnx]
#include <chrono>
#include <cstdio>
#include <exception>

#include "manyhands/base/assets.h"
#include "manyhands/envs/make.h"
#include "manyhands/learn/policy_file.h"
#include "manyhands/learn/policy_runner.h"

using namespace manyhands;

int main(int argc, char** argv) try {
  const auto shipped = asset_root().parent_path() / "python/manyhands/policies/PandaPush-v3.onnx";
  const learn::Policy policy = learn::read_policy(argc > 1 ? argv[1] : shipped);
  const learn::PolicyRunner runner(policy);
  const auto envs = make_env_batch(policy.env_id, 256);
  const auto begin = std::chrono::steady_clock::now();
  const learn::EvalResult result = runner.evaluate(*envs, 1000, 2'000'000'000);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  std::printf("%s: success %.1f %% of %d episodes in %.2f s, %.1f steps each\n", policy.env_id.c_str(),
              100 * result.success_rate, result.episodes, seconds.count(), result.mean_length);
  return result.success_rate > 0.8 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "trained_policy: %s\n", error.what());
  return 2;
}
