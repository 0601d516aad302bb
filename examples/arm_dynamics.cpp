// Kinematics and dynamics of the Panda from C++: one state in double, then thousands in SIMD lanes.
//
//   cmake --build --preset release --target arm_dynamics && build/release/examples/arm_dynamics
#include <chrono>
#include <cstdio>
#include <random>

#include "manyhands/base/assets.h"
#include "manyhands/model/io/urdf/urdf.h"
#include "manyhands/physics/dynamics/batch_dynamics.h"

namespace {

void print(const char* name, const std::vector<double>& values) {
  std::printf("%-22s", name);
  for (const double value : values) std::printf(" %9.4f", value);
  std::printf("\n");
}

}  // namespace

int main() {
  const auto [model, report] = manyhands::load_urdf(manyhands::asset_path("panda/panda.urdf"), {.load_meshes = false});
  std::printf("%s: %zu links, nq %d, nv %d\n%s", model.name().c_str(), model.links().size(), model.nq(), model.nv(),
              report.to_string().c_str());
  const auto nq = static_cast<std::size_t>(model.nq()), nv = static_cast<std::size_t>(model.nv());

  // One state: what holds the arm against gravity, and where its grasp target is.
  manyhands::BatchDynamics<double> dynamics(model);
  const std::vector<double> q{0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785, 0.02, 0.02}, rest(nv, 0.0);
  std::vector<double> tau(nv), position(3), quaternion(4);
  dynamics.rnea(1, q, rest, rest, tau);
  dynamics.frame_pose(1, q, model.frame_id("panda_grasptarget"), position, quaternion);
  print("holding torque [N m]", tau);
  print("grasp target [m]", position);

  // Many states: the accelerations of every row, some at once.
  constexpr std::size_t kRows = 100'000;
  manyhands::BatchDynamics<float> lanes(model);
  std::mt19937 random(0);
  std::uniform_real_distribution<float> number(-1.0f, 1.0f);
  std::vector<float> q_rows(kRows * nq), v_rows(kRows * nv), tau_rows(kRows * nv), a_rows(kRows * nv);
  for (auto* rows : {&q_rows, &v_rows, &tau_rows}) {
    for (float& x : *rows) x = number(random);
  }
  const auto start = std::chrono::steady_clock::now();
  lanes.aba(kRows, q_rows, v_rows, tau_rows, a_rows);
  const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - start;
  std::printf("forward dynamics of %zu arms, %d at once: %.3f us each\n", kRows, lanes.width(),
              time.count() / static_cast<double>(kRows));
}
