// A task of one's own: push the cube out of a ring about the origin, to wherever it is nearest. It says what is in the
// scene, where episodes start, what is observed and how far the goal is; the rest is there: thousands of worlds at
// once, every robot and control, seeds, threads, snapshots.
//
//   cmake --build --preset release --target own_task && build/release/examples/own_task
#include <cstdio>

#include "manyhands/envs/panda.h"
#include "manyhands/envs/task_batch.inl"
#include "manyhands/envs/tasks/push.h"

using namespace manyhands;

/// The goal is one number: how far out the cube is to be [m].
struct ClearTheMiddle {
  static constexpr std::size_t kObjects = 1, kGoalSize = 1, kObservationSize = 12;
  static constexpr bool kHasGripper = false;
  static constexpr int kMaxEpisodeSteps = 50;
  static constexpr double kDistanceThreshold = 0.01;

  Table table() const { return {}; }
  std::array<ObjectSpec, 1> objects() const { return {cube("object", 0.5)}; }
  TaskStart<1, 1> draw(NumpyRandom& random) const {
    const Vec3<double> p = draw_in_square(random, 0.1);
    return {.goal = {random.uniform(0.12, 0.16)}, .objects = {{{p.x, p.y, 0.02}}}};
  }
  template <Number T>
  void observe(const std::array<ObjectState<T>, 1>& objects, T* row) const {
    write_object(objects[0], row);
  }
  template <Number T>
  void achieve(const HandState<T>&, const std::array<ObjectState<T>, 1>& objects, T* goal) const {
    goal[0] = sqrt(fma(objects[0].p.x, objects[0].p.x, objects[0].p.y * objects[0].p.y));
  }
  template <Number T>
  T distance(const T* achieved, const T* desired) const {
    return max(desired[0] - achieved[0], T(real_t<T>(0)));
  }
};

int main() {
  constexpr int n = 256;
  TaskBatch<NativeLanes, ClearTheMiddle> envs({.id = "ClearTheMiddle"}, panda_arm(), ArmControl::kEndEffector,
                                              Reward::kSparse, n, {});
  std::vector<float> action(n * 3);
  for (int step = 0; step < envs.spec().max_episode_steps; ++step) {
    for (std::size_t i = 0; i < n; ++i) {  // down beside the cube, nearer to the middle, and out along x
      const float *row = &envs.observation()[i * 18], x = row[6] < 0 ? -1.0f : 1.0f, inside = x * (row[6] - row[0]);
      const bool low = inside > 0.035f && row[2] < 0.05f;
      action[3 * i] = low || inside > 0.07f ? x : -x;
      action[3 * i + 1] = 20 * (row[7] - row[1]);
      action[3 * i + 2] = 20 * ((low || inside > 0.05f ? 0.02f : 0.12f) - row[2]);
    }
    envs.step(action);
  }
  const auto solved = std::ranges::count(envs.is_success(), 1);
  std::printf("%td of %d worlds end with a clear middle\n", solved, n);
  return solved > n * 3 / 4 ? 0 : 1;
}
