// manyhands._core.envs.PythonBatch: environments written in Python, for trainers.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "manyhands/base/hash.h"
#include "manyhands/envs/env_batch.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::copied;
using SharedRows = nb::ndarray<float, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using SharedColumn = nb::ndarray<float, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using SharedFlags = nb::ndarray<bool, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// A batch whose worlds a Python object steps: it writes what it observes into arrays that both share.
/// It refers to that object weakly: a strong reference would close a cycle that Python's garbage collector cannot see,
/// for an environment's class knows its module, and that the model, whose trainer keeps this batch.
class PythonBatch final : public EnvBatch {
 public:
  PythonBatch(EnvSpec spec, nb::weakref host, SharedRows observation, SharedRows achieved, SharedRows desired,
              SharedColumn reward, SharedFlags success, SharedFlags terminated, SharedFlags truncated)
      : spec_(std::move(spec)),
        host_(std::move(host)),
        observation_(std::move(observation)),
        achieved_(std::move(achieved)),
        desired_(std::move(desired)),
        reward_(std::move(reward)),
        success_(std::move(success)),
        terminated_(std::move(terminated)),
        truncated_(std::move(truncated)) {
    const std::size_t n = reward_.shape(0);
    for (const std::size_t rows : {observation_.shape(0), achieved_.shape(0), desired_.shape(0), success_.shape(0),
                                   terminated_.shape(0), truncated_.shape(0)}) {
      if (rows != n) throw std::invalid_argument(spec_.id + ": the arrays are of different lengths");
    }
    if (achieved_.shape(1) != desired_.shape(1)) throw std::invalid_argument(spec_.id + ": goals of different lengths");
    spec_.observation_dim = static_cast<int>(observation_.shape(1));
    spec_.goal_dim = static_cast<int>(desired_.shape(1));
  }

  [[nodiscard]] const EnvSpec& spec() const override { return spec_; }
  [[nodiscard]] int num_envs() const override { return static_cast<int>(reward_.shape(0)); }

  void reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> seeds) override {
    const nb::gil_scoped_acquire acquire;
    const auto n = static_cast<std::size_t>(num_envs());
    std::vector<std::uint8_t> all(n, 1);
    std::vector<std::uint64_t> none(n, 0);
    if (!mask.empty()) std::ranges::copy(mask, all.begin());
    if (!seeds.empty()) std::ranges::copy(seeds, none.begin());
    host().attr("reset")(bindings::copied_bools(all), copied(none.data(), {n}));
  }

  void step(std::span<const float> action) override {
    const nb::gil_scoped_acquire acquire;
    const auto n = static_cast<std::size_t>(num_envs());
    host().attr("step")(copied(action.data(), {n, static_cast<std::size_t>(spec_.action_dim)}));
  }

  [[nodiscard]] std::span<const float> observation() const override { return span(observation_); }
  [[nodiscard]] std::span<const float> achieved_goal() const override { return span(achieved_); }
  [[nodiscard]] std::span<const float> desired_goal() const override { return span(desired_); }
  [[nodiscard]] std::span<const float> reward() const override { return span(reward_); }
  [[nodiscard]] std::span<const std::uint8_t> is_success() const override { return bytes(success_); }
  [[nodiscard]] std::span<const std::uint8_t> terminated() const override { return bytes(terminated_); }
  [[nodiscard]] std::span<const std::uint8_t> truncated() const override { return bytes(truncated_); }

  void compute_reward(std::span<const float> achieved, std::span<const float> desired,
                      std::span<float> reward) const override {
    const nb::gil_scoped_acquire acquire;
    const std::size_t k = reward.size(), dim = static_cast<std::size_t>(spec_.goal_dim);
    const auto given = nb::cast<nb::ndarray<const float, nb::ndim<1>, nb::c_contig, nb::device::cpu>>(
        host().attr("compute_reward")(copied(achieved.data(), {k, dim}), copied(desired.data(), {k, dim})));
    if (given.shape(0) != k) {
      throw std::invalid_argument(spec_.id + ": compute_reward gave " + std::to_string(given.shape(0)) +
                                  " rewards for " + std::to_string(k) + " pairs of goals");
    }
    std::copy_n(given.data(), k, reward.data());
  }

  [[nodiscard]] std::vector<std::uint8_t> snapshot() const override { throw no_snapshot(); }
  void restore(std::span<const std::uint8_t> /*snapshot*/) override { throw no_snapshot(); }

  /// Of what is observed: a Python environment shows no more of its state.
  [[nodiscard]] std::uint64_t state_hash() const override {
    Hash hash;
    for (const std::span<const float> rows : {observation(), achieved_goal(), desired_goal()}) {
      for (const float x : rows) hash.add(x);
    }
    return hash.value();
  }

 private:
  [[nodiscard]] nb::object host() const {
    nb::object host = host_();
    if (host.is_none()) throw std::logic_error(spec_.id + ": the object that steps its worlds is gone");
    return host;
  }
  template <class Array>
  [[nodiscard]] static std::span<const float> span(const Array& array) {
    return {array.data(), array.size()};
  }
  [[nodiscard]] static std::span<const std::uint8_t> bytes(const SharedFlags& flags) {
    static_assert(sizeof(bool) == 1);
    return {reinterpret_cast<const std::uint8_t*>(flags.data()), flags.size()};
  }
  [[nodiscard]] std::logic_error no_snapshot() const {
    return std::logic_error(spec_.id + " is written in Python and has no snapshots");
  }

  EnvSpec spec_;
  nb::weakref host_;
  SharedRows observation_, achieved_, desired_;
  SharedColumn reward_;
  SharedFlags success_, terminated_, truncated_;
};

}  // namespace

void bind_python_batch(nb::module_& m) {
  nb::module_ envs = nb::cast<nb::module_>(m.attr("envs"));
  nb::class_<PythonBatch, EnvBatch>(
      envs, "PythonBatch",
      "Worlds that `host` steps in Python: `host.reset(mask, seeds)`, `host.step(action)` and "
      "`host.compute_reward(achieved, desired)` (float32) are called, and write into the arrays given here. "
      "Who makes the batch keeps `host`, of which it has a weak reference.")
      .def(
          "__init__",
          [](PythonBatch* self, const std::string& id, int action_dim, int choices, int max_episode_steps,
             const nb::object& host, SharedRows observation, SharedRows achieved_goal, SharedRows desired_goal,
             SharedColumn reward, SharedFlags is_success, SharedFlags terminated, SharedFlags truncated) {
            const EnvSpec spec = {
                .id = id, .action_dim = action_dim, .choices = choices, .max_episode_steps = max_episode_steps};
            new (self) PythonBatch(spec, nb::weakref(host), std::move(observation), std::move(achieved_goal),
                                   std::move(desired_goal), std::move(reward), std::move(is_success),
                                   std::move(terminated), std::move(truncated));
          },
          "id"_a, "action_dim"_a, "choices"_a, "max_episode_steps"_a, "host"_a, "observation"_a, "achieved_goal"_a,
          "desired_goal"_a, "reward"_a, "is_success"_a, "terminated"_a, "truncated"_a,
          "The arrays are (n, observation_dim), (n, goal_dim) twice, and (n); `choices` is 0 but for discrete actions. "
          "Raises ValueError if they do not fit each other.");
}

}  // namespace manyhands
