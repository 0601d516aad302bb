// Nanoseconds per arm and core of the dynamics on the Panda, for every number type.
//
// Each call treats 128 arms in random states. The results of the timed calls are compared with those of the scalar
// float run: a wrong result is marked, however fast it came.
#include <functional>
#include <map>
#include <random>

#include "benchmarks/support.h"
#include "manyhands/base/assets.h"
#include "manyhands/model/io/urdf/urdf.h"
#include "manyhands/physics/step/step.h"

namespace benchmarks {

namespace {

using namespace manyhands;

constexpr std::size_t kArms = 128;
constexpr int kSteps = 20;
constexpr double kTimeStep = 0.002;  // [s]

/// Random states within the joint limits, arm by arm, the same for every number type.
struct RandomArms {
  explicit RandomArms(const Model& model) : nq(static_cast<std::size_t>(model.nq())) {
    std::mt19937_64 random(1);
    const auto uniform = [&](double low, double high) {
      return static_cast<float>(std::uniform_real_distribution<double>(low, high)(random));
    };
    const ParamsStorage<double> params(model);
    for (std::size_t arm = 0; arm < kArms; ++arm) {
      for (std::size_t i = 0; i < nq; ++i) {
        q.push_back(uniform(params.lower[i], params.upper[i]));
        v.push_back(uniform(-1, 1));
        a.push_back(uniform(-5, 5));
        target.push_back(q.back() + uniform(-0.05F, 0.05F));
      }
    }
  }

  std::size_t nq;
  std::vector<float> q, v, a, target;  // (arms, nq)
};

/// Rows of arms as blocks of lanes: (blocks, columns).
template <Number T>
std::vector<T> pack(const std::vector<float>& rows, std::size_t columns) {
  constexpr std::size_t kWidth = width_v<T>;
  std::vector<T> blocks(rows.size() / kWidth, T(real_t<T>(0)));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t arm = i / columns, column = i % columns;
    set_lane(blocks[arm / kWidth * columns + column], static_cast<int>(arm % kWidth), static_cast<real_t<T>>(rows[i]));
  }
  return blocks;
}

/// What is timed, and the results it leaves behind.
template <Number T>
class Dynamics {
  using R = real_t<T>;

 public:
  Dynamics(const Model& model, const RandomArms& arms)
      : tree_(model),
        system_(tree_),
        free_system_(tree_),
        params_(model),
        free_params_(model),
        ws_(system_),
        nq_(arms.nq),
        q_(pack<T>(arms.q, nq_)),
        v_(pack<T>(arms.v, nq_)),
        a_(pack<T>(arms.a, nq_)),
        target_(pack<T>(arms.target, nq_)),
        state_(model, 0) {
    std::ranges::fill(free_system_.tree.dof_limited, 0);
    std::ranges::fill(free_params_.motor_max_force, R(0));
    std::ranges::fill(params_.motor_kp, R(0.1));
    std::ranges::fill(params_.motor_kd, R(1));
    std::ranges::fill(params_.motor_max_force, R(87));
  }

  void forward_kinematics() {
    for_each_block(7 * nq_, [&](std::size_t in, T* out) {
      manyhands::forward_kinematics(tree_, &q_[in], ws_.dynamics);
      for (std::size_t b = 1; b <= nq_; ++b) {
        const Mat3<T>& R_WB = ws_.dynamics.R_WB[b];
        const Vec3<T>& p = ws_.dynamics.p_OB[b];
        for (const T& number : {R_WB.x.x, R_WB.x.y, R_WB.x.z, R_WB.z.z, p.x, p.y, p.z}) *out++ = number;
      }
    });
  }
  void rnea() {
    for_each_block(nq_, [&](std::size_t in, T* out) {
      manyhands::rnea(tree_, params_, &q_[in], &v_[in], &a_[in], out, ws_.dynamics);
    });
  }
  void aba() {
    for_each_block(nq_, [&](std::size_t in, T* out) {
      manyhands::aba(tree_, params_, &q_[in], &v_[in], &a_[in], out, ws_.dynamics);
    });
  }
  void crba() {
    for_each_block(tree_.M_size, [&](std::size_t in, T* out) {
      manyhands::crba(tree_, params_, &q_[in], ws_.dynamics);
      std::ranges::copy(ws_.dynamics.M, out);
    });
  }
  void bias_and_mass_matrix() {
    for_each_block(tree_.M_size + nq_, [&](std::size_t in, T* out) {
      manyhands::bias_and_mass_matrix(tree_, params_, &q_[in], &v_[in], ws_.dynamics);
      std::ranges::copy(ws_.dynamics.M, out);
      std::ranges::copy(ws_.dynamics.bias, out + ws_.dynamics.M.size());
    });
  }
  void free_steps() { steps(free_system_, free_params_); }
  void motor_steps() { steps(system_, params_); }

  [[nodiscard]] Results results() const { return unpack<T>(results_, columns_); }

 private:
  template <class Body>
  void for_each_block(std::size_t columns, Body&& body) {
    columns_ = columns;
    results_.resize(kArms / width_v<T> * columns);
    for (std::size_t b = 0; b < kArms / width_v<T>; ++b) body(b * nq_, &results_[b * columns]);
    consume(results_.data());
  }

  void steps(const System<R>& system, const Params<R>& params) {
    for_each_block(2 * nq_, [&](std::size_t in, T* out) {
      std::ranges::fill(state_.numbers(), T(R(0)));
      std::copy_n(&q_[in], nq_, state_.q());
      std::copy_n(&v_[in], nq_, state_.v());
      std::copy_n(&target_[in], nq_, state_.target_q());
      for (int k = 0; k < kSteps; ++k) step(system, params, static_cast<R>(kTimeStep), state_, ws_);
      std::copy_n(state_.q(), nq_, out);
      std::copy_n(state_.v(), nq_, out + nq_);
    });
  }

  Tree<R> tree_;
  System<R> system_, free_system_;  // the second without joint limits
  ParamsStorage<R> params_, free_params_;
  StepWorkspace<T> ws_;
  std::size_t nq_;
  std::vector<T> q_, v_, a_, target_;
  StateStorage<T> state_;
  std::vector<T> results_;
  std::size_t columns_ = 0;
};

struct Kind {
  const char* name;
  int calls;         // per arm
  double tolerance;  // of double against float, relative
};
// Twenty steps double the float's rounding errors many times over where a motor's or limit's state changes.
constexpr std::array<Kind, 7> kKinds{{{"forward kinematics", 1, 1e-5},
                                      {"RNEA", 1, 1e-5},
                                      {"ABA", 1, 1e-3},
                                      {"CRBA", 1, 1e-5},
                                      {"bias and mass matrix", 1, 1e-5},
                                      {"free step", kSteps, 1e-2},
                                      {"motor step", kSteps, 1e-2}}};

template <Number T>
void call(Dynamics<T>& dynamics, std::size_t kind) {
  using Method = void (Dynamics<T>::*)();
  constexpr std::array<Method, 7> kMethods{
      &Dynamics<T>::forward_kinematics,   &Dynamics<T>::rnea,       &Dynamics<T>::aba,        &Dynamics<T>::crba,
      &Dynamics<T>::bias_and_mass_matrix, &Dynamics<T>::free_steps, &Dynamics<T>::motor_steps};
  (dynamics.*kMethods[kind])();
}

template <Number T>
void report(const Kind& kind, const Timing& timing, const Results& results, const Results& reference) {
  const double to_ns = 1e9 / static_cast<double>(kArms) / kind.calls;
  print({kind.name, number_name<T>(), 1, timing.cpu * to_ns, "ns/arm", timing.wall * to_ns, timing.variation,
         results.hash, compare<T>(results, reference, kind.tolerance)});
}

void run(const Settings& settings) {
  UrdfOptions options;
  options.load_meshes = false;
  const Model model = load_urdf(asset_path("panda/panda.urdf"), options).model;
  const RandomArms arms(model);
  Dynamics<float> scalar(model, arms);
  Dynamics<double> reference(model, arms);
  Dynamics<Lanes4> lanes4(model, arms);
  Dynamics<Lanes8> lanes8(model, arms);
  Dynamics<Lanes16> lanes16(model, arms);
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
    std::array<std::function<void()>, 5> calls{[&] { call(reference, kind); }, [&] { call(scalar, kind); },
                                               [&] { call(lanes4, kind); }, [&] { call(lanes8, kind); },
                                               [&] { call(lanes16, kind); }};
    const std::vector<Timing> timings = time_in_turns<std::function<void()>>(settings, calls);
    const Results expected = scalar.results();
    report<double>(kKinds[kind], timings[0], reference.results(), expected);
    report<float>(kKinds[kind], timings[1], expected, expected);
    report<Lanes4>(kKinds[kind], timings[2], lanes4.results(), expected);
    report<Lanes8>(kKinds[kind], timings[3], lanes8.results(), expected);
    report<Lanes16>(kKinds[kind], timings[4], lanes16.results(), expected);
  }
}

}  // namespace

}  // namespace benchmarks

int main(int argc, char** argv) {
  benchmarks::run(benchmarks::parse(argc, argv, "Nanoseconds per arm and core of the dynamics on the Panda."));
  return 0;
}
