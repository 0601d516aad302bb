// manyhands._core.learn: the trainer.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "bindings/pickling.h"
#include "manyhands/envs/env_batch.h"
#include "manyhands/envs/experts/expert.h"
#include "manyhands/learn/archive.h"
#include "manyhands/learn/policy_archive.h"
#include "manyhands/learn/share.h"
#include "manyhands/learn/trainer.h"
#include "manyhands/learn/trainer_config.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::as_span;
using bindings::copied;
using States = bindings::Array<float, 2>;
using learn::Algorithm;
using learn::EvalResult;
using learn::HiddenActivation;
using learn::Policy;
using learn::PolicyOutput;
using learn::Trainer;
using learn::TrainerConfig;
using learn::TrainMetrics;

/// Enumerators are texts in Python, as in recipes.
template <class E>
using Names = std::vector<std::pair<E, const char*>>;

const Names<Algorithm>& names(Algorithm) {
  static const Names<Algorithm> all = {
      {Algorithm::kTd3, "TD3"}, {Algorithm::kSac, "SAC"}, {Algorithm::kPpo, "PPO"}, {Algorithm::kDagger, "DAgger"}};
  return all;
}
const Names<HiddenActivation>& names(HiddenActivation) {
  static const Names<HiddenActivation> all = {{HiddenActivation::kRelu, "relu"}, {HiddenActivation::kTanh, "tanh"}};
  return all;
}
const Names<PolicyOutput>& names(PolicyOutput) {
  static const Names<PolicyOutput> all = {
      {PolicyOutput::kTanh, "tanh"}, {PolicyOutput::kClip, "clip"}, {PolicyOutput::kIndex, "index"}};
  return all;
}

template <class E>
const char* text_of(E value) {
  return std::ranges::find(names(value), value, &std::pair<E, const char*>::first)->second;
}

template <class E>
E from_text(const char* setting, const std::string& text) {
  std::string known;
  for (const auto& [value, name] : names(E{})) {
    if (text == name) return value;
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  throw std::invalid_argument(std::string(setting) + " is '" + text + "', expected one of " + known);
}

/// Calls visit(name, member, meaning) for everything that can be set.
template <class Visit>
void visit_settings(Visit&& visit) {
  using C = TrainerConfig;
  visit("algorithm", &C::algorithm,
        "TD3 (DDPG with its defaults), SAC (with quantiles TQC), PPO, or DAgger, from pictures too.");
  visit("seed", &C::seed, "Of networks, exploration, sampling and episodes.");
  visit("num_threads", &C::num_threads, "1 or 2 are used for gradient steps; the results are the same bits.");
  visit("hidden_layers", &C::hidden_layers, "Units of each hidden layer, of actor and critics alike.");
  visit("activation", &C::activation, "Of hidden layers: relu or tanh.");
  visit("num_critics", &C::num_critics, "1: DDPG; more: the smallest of their values is the target (TD3, SAC).");
  visit("batch_size", &C::batch_size, "Transitions per gradient step, even.");
  visit("gamma", &C::gamma, "Discount per environment step, in [0, 1).");
  visit("return_steps", &C::return_steps, "Rewards that are summed before the critics tell the rest (n-step returns).");
  visit("target_rate", &C::target_rate, "Polyak rate of the target networks, in (0, 1].");
  visit("actor_learning_rate", &C::actor_learning_rate, "Adam's step size for the policy.");
  visit("critic_learning_rate", &C::critic_learning_rate, "Adam's step size for the critics.");
  visit("learning_rate_half_life", &C::learning_rate_half_life,
        "Gradient steps after which learning rates are half as large; 0: they stay.");
  visit("policy_delay", &C::policy_delay, "Critic steps per policy (and target) step; TD3: 2.");
  visit("average_policy", &C::average_policy, "Act by the policy's target network, a running mean of its weights.");
  visit("target_noise", &C::target_noise, "Standard deviation of the smoothing noise on target actions; TD3: 0.2.");
  visit("target_noise_clip", &C::target_noise_clip, "Its largest magnitude.");
  visit("action_penalty", &C::action_penalty, "Weight of |action|^2 in the policy's loss.");
  visit("num_quantiles", &C::num_quantiles, "Of the return, that a critic gives; 1: its mean; TQC: 25.");
  visit("dropped_quantiles", &C::dropped_quantiles, "The largest of each critic that a target leaves out; TQC: 2.");
  visit("temperature", &C::temperature, "SAC: weight of the policy's entropy beside the return, at first.");
  visit("learned_temperature", &C::learned_temperature,
        "SAC: the temperature follows so that the entropy becomes `target_entropy`.");
  visit("target_entropy", &C::target_entropy, "SAC: of the policy; 0: -action_dim.");
  visit("cloning_weight", &C::cloning_weight,
        "In the policy's loss, of |action - the expert's|^2 where the goal is the task's.");
  visit("cloning_filter", &C::cloning_filter,
        "Only where the first critic prefers the expert's action to the policy's.");
  visit("differences", &C::differences,
        "Pairs (i, k): the network also sees o[i:i+3] - o[k:k+3] of an observation o, as fine as 2 cm.");
  visit("cloning_half_life", &C::cloning_half_life,
        "Gradient steps after which cloning_weight counts half as much; 0: it stays.");
  visit("initial_std", &C::initial_std, "PPO: standard deviation of the actions that are drawn, at first.");
  visit("cube_rotation", &C::cube_rotation,
        "Where in an observation the quaternion of a cube is that the goal wants: the network also sees the rotation "
        "between the two, and how the cube lies whichever of its faces is which. -1: there is none.");
  visit("input_clip", &C::input_clip, "Largest normalised network input, in standard deviations.");
  visit("privileged_critic", &C::privileged_critic,
        "Critics see what the environment has randomised, too; the policy does not.");
  visit("rollout_steps", &C::rollout_steps, "PPO: environment steps of every world between updates.");
  visit("epochs", &C::epochs, "PPO: how often an update goes through them.");
  visit("gae_lambda", &C::gae_lambda, "PPO: of the advantages, in [0, 1].");
  visit("clip_range", &C::clip_range, "PPO: by which a probability may change in one update, as a part of it.");
  visit("entropy_weight", &C::entropy_weight, "PPO: in the loss, of -entropy.");
  visit("value_weight", &C::value_weight, "PPO: in the loss, of the squared error of the value.");
  visit("max_gradient_norm", &C::max_gradient_norm,
        "PPO: of policy and value together; longer gradients are shortened.");
  visit("scale_rewards", &C::scale_rewards, "PPO: by the standard deviation of the discounted return so far.");
  visit("channels", &C::channels,
        "DAgger from pictures: of the layers that see: 4 x 4 pixels, then 3 x 3 of the layer below.");
  visit("frame_stack", &C::frame_stack, "DAgger from pictures: pictures of each camera that are seen, the last ones.");
  visit("shift", &C::shift, "DAgger from pictures: in learning, pictures are moved by up to so many pixels.");
  visit("state_weight", &C::state_weight,
        "DAgger from pictures: in the loss, of the squared error of the state, which the network is asked to tell.");
  visit("updates_per_iteration", &C::updates_per_iteration, "Gradient steps after each step of the batch.");
  visit("replay_capacity", &C::replay_capacity, "Transitions.");
  visit("replay_folder", &C::replay_folder,
        "The replay lies in a file there, which goes when training ends, rather than in memory; empty: in memory.");
  visit("warmup_transitions", &C::warmup_transitions,
        "In the replay before learning starts; until then actions are random.");
  visit("hindsight_fraction", &C::hindsight_fraction,
        "Of a mini-batch gets a goal achieved later in the same episode; 0: no hindsight.");
  visit("success_terminates", &C::success_terminates, "Whether the task ends an episode at its goal.");
  visit("expert_rate", &C::expert_rate,
        "Share of the worlds in which the expert acts; if not 0, in all of them until learning.");
  visit("exploration_noise", &C::exploration_noise, "Standard deviation of the noise on actions.");
  visit("random_action_rate", &C::random_action_rate, "Probability of a uniform action instead.");
  visit("round_steps", &C::round_steps, "Of worlds elsewhere: steps of each under one policy.");
  visit("evaluation_interval", &C::evaluation_interval, "Iterations between evaluations.");
  visit("evaluation_episodes", &C::evaluation_episodes, "Episodes of each.");
  visit("stop_success_rate", &C::stop_success_rate, "An evaluation at or above this counts towards stopping.");
  visit("stop_streak", &C::stop_streak, "This many in a row end the training; 0: never.");
}

template <class M>
using Member = std::remove_cvref_t<decltype(std::declval<TrainerConfig&>().*std::declval<M>())>;

void bind_config(nb::module_& m) {
  auto config = nb::class_<TrainerConfig>(m, "TrainerConfig", "Everything that can be set about training.");
  config.def(nb::init<>(), "The defaults.")
      .def_prop_ro("wants_expert", &TrainerConfig::wants_expert, "Whether a setting asks for the task's expert.")
      .def("validate", &TrainerConfig::validate, "Raises ValueError naming the first setting that makes no sense.")
      .def(
          "to_dict",
          [](const TrainerConfig& self) {
            nb::dict settings;
            visit_settings([&](const char* name, auto member, const char*) {
              if constexpr (std::is_enum_v<Member<decltype(member)>>) {
                settings[name] = text_of(self.*member);
              } else {
                settings[name] = nb::cast(self.*member);
              }
            });
            return settings;
          },
          nb::sig("def to_dict(self) -> dict[str, int | float | bool | str | list[int]]"), "All settings by name.");
  visit_settings([&](const char* name, auto member, const char* meaning) {
    using E = Member<decltype(member)>;
    if constexpr (std::is_enum_v<E>) {
      config.def_prop_rw(
          name, [member](const TrainerConfig& self) { return text_of(self.*member); },
          [member, name](TrainerConfig& self, const std::string& text) { self.*member = from_text<E>(name, text); },
          meaning);
    } else {
      config.def_rw(name, member, meaning);
    }
  });
}

void bind_results(nb::module_& m) {
  nb::class_<TrainMetrics>(m, "TrainMetrics",
                           "Where training stands. Counters run from the beginning, across checkpoints; losses are "
                           "means over the last `advance`; seconds are of this process.")
      .def_ro("iterations", &TrainMetrics::iterations)
      .def_ro("env_steps", &TrainMetrics::env_steps)
      .def_ro("gradient_steps", &TrainMetrics::gradient_steps)
      .def_ro("episodes", &TrainMetrics::episodes)
      .def_ro("success_rate", &TrainMetrics::success_rate, "Of the last 100 training episodes, which explore.")
      .def_ro("critic_loss", &TrainMetrics::critic_loss)
      .def_ro("q_mean", &TrainMetrics::q_mean)
      .def_ro("policy_q_mean", &TrainMetrics::policy_q_mean)
      .def_ro("entropy", &TrainMetrics::entropy, "Of the policy: PPO, SAC.")
      .def_ro("mean_return", &TrainMetrics::mean_return, "Undiscounted, of the last 100 training episodes.")
      .def_ro("evaluation_success_rate", &TrainMetrics::evaluation_success_rate, "Of the last periodic evaluation.")
      .def_ro("evaluations", &TrainMetrics::evaluations)
      .def_ro("streak", &TrainMetrics::streak, "Evaluations in a row, up to now, that were good enough.")
      .def_ro("solved", &TrainMetrics::solved, "`advance` does nothing more.")
      .def_ro("collect_seconds", &TrainMetrics::collect_seconds)
      .def_ro("learn_seconds", &TrainMetrics::learn_seconds)
      .def_ro("evaluate_seconds", &TrainMetrics::evaluate_seconds);

  nb::class_<EvalResult>(m, "EvalResult", "Means over the episodes of an evaluation.")
      .def("__repr__",
           [](const EvalResult& result) {
             return "<EvalResult: success " + std::to_string(100 * result.success_rate) + " % of " +
                    std::to_string(result.episodes) + " episodes>";
           })
      .def_ro("episodes", &EvalResult::episodes)
      .def_ro("success_rate", &EvalResult::success_rate, "Success at the last step of the episode.")
      .def_ro("mean_return", &EvalResult::mean_return, "Undiscounted.")
      .def_ro("mean_length", &EvalResult::mean_length, "Environment steps.");
}

nb::list layers(const Policy& policy) {
  nb::list list;
  for (const Policy::Layer& layer : policy.layers) {
    const auto outputs = static_cast<std::size_t>(layer.outputs), inputs = static_cast<std::size_t>(layer.inputs);
    list.append(nb::make_tuple(copied(layer.weight.data(), {outputs, inputs}), copied(layer.bias.data(), {outputs})));
  }
  return list;
}

nb::list eyes(const Policy& policy) {
  nb::list eyes;
  for (const std::vector<Policy::Kernels>& layers : policy.eyes) {
    nb::list list;
    std::size_t planes = static_cast<std::size_t>(policy.pictures.stack), below = 3;
    for (const Policy::Kernels& layer : layers) {
      const auto channels = static_cast<std::size_t>(layer.channels), kernel = static_cast<std::size_t>(layer.kernel);
      list.append(nb::make_tuple(copied(layer.weight.data(), {channels, planes, kernel, kernel, below}),
                                 copied(layer.bias.data(), {channels}), layer.stride));
      planes = 1;
      below = channels;
    }
    eyes.append(list);
  }
  return eyes;
}

void bind_policy(nb::module_& m) {
  auto bound = nb::class_<Policy>(
      m, "Policy",
      "The deterministic policy as arrays: y = W_L act(... act(W_1 z + b_1) ...) + b_L, of which `output` makes an "
      "action: tanh(y), clip(y, -1, 1) or the index of the largest; with z = clip((x - mean) * scale, -clip, clip) and "
      "x = [observation, desired_goal, desired_goal - "
      "achieved_goal, the rotation between a cube's pose and its goal and the cube's moments if there is one, "
      "observation[i:i+3] - observation[k:k+3] for each pair of differences].");
  bindings::pickle_by_fields(bound, [](const Policy& self) { self.validate(); });
  bound
      .def("__repr__",
           [](const Policy& self) {
             return "<Policy of '" + self.env_id + "': " + std::to_string(self.observation_dim) + " observations, " +
                    std::to_string(self.action_dim) + " actions>";
           })
      .def_ro("env_id", &Policy::env_id, "The environment it was learned in; empty if that is not known.")
      .def_ro("observation_dim", &Policy::observation_dim)
      .def_ro("goal_dim", &Policy::goal_dim)
      .def_ro("action_dim", &Policy::action_dim)
      .def_ro("clip", &Policy::clip)
      .def_prop_ro(
          "differences", [](const Policy& policy) { return policy.relations.differences; },
          "Pairs (i, k), one after the other.")
      .def_prop_ro(
          "cube_rotation", [](const Policy& policy) { return policy.relations.cube_rotation; },
          "Where in an observation a cube's quaternion is that the goal wants, or -1.")
      .def_prop_ro(
          "mean", [](const Policy& policy) { return copied(policy.mean.data(), {policy.mean.size()}); },
          nb::sig("def mean(self) -> numpy.typing.NDArray[numpy.float32]"), "(inputs)")
      .def_prop_ro(
          "scale", [](const Policy& policy) { return copied(policy.scale.data(), {policy.scale.size()}); },
          nb::sig("def scale(self) -> numpy.typing.NDArray[numpy.float32]"), "(inputs)")
      .def_prop_ro(
          "activation", [](const Policy& policy) { return text_of(policy.activation); }, "relu or tanh.")
      .def_prop_ro(
          "output", [](const Policy& policy) { return text_of(policy.output); }, "tanh, clip or index.")
      .def_prop_ro("layers", &layers,
                   nb::sig("def layers(self) -> list[tuple[numpy.typing.NDArray[numpy.float32], "
                           "numpy.typing.NDArray[numpy.float32]]]"),
                   "(weight (outputs, inputs), bias (outputs)) of each layer. With eyes the first acts on the features "
                   "of all eyes and z.")
      .def_prop_ro(
          "pictures",
          [](const Policy& policy) {
            return std::tuple(policy.pictures.stack, policy.pictures.height, policy.pictures.width);
          },
          "(frame stack, height, width) of what each eye sees.")
      .def_prop_ro(
          "eyes", &eyes,
          nb::sig("def eyes(self) -> list[list[tuple[numpy.typing.NDArray[numpy.float32], "
                  "numpy.typing.NDArray[numpy.float32], int]]]"),
          "Of each camera, for each convolution, which relu follows: (weight (channels, pictures, kernel, "
          "kernel, channels below), bias (channels), stride). They act on the pictures' bytes / 255 - 0.5; "
          "features are ordered place by place. x is then the first observation_dim numbers of an observation.");
}

nb::bytes bytes_of(const learn::Message& message) { return nb::bytes(message.data(), message.size()); }

learn::Message message_of(const nb::bytes& bytes) {
  const auto* data = static_cast<const std::byte*>(bytes.data());
  return {data, data + bytes.size()};
}

void bind_share(nb::module_& m) {
  nb::class_<learn::Share>(m, "Share", "Some of a training's worlds, apart from the trainer.")
      .def(nb::init<EnvBatch&, Expert*, const TrainerConfig&, int>(), "envs"_a, "expert"_a.none(), "config"_a,
           "first"_a, nb::keep_alive<1, 2>(), nb::keep_alive<1, 3>(),
           "Worlds first, ..., first + envs.num_envs - 1 of all.")
      .def(
          "run",
          [](learn::Share& share, const nb::bytes& order, const nb::bytes& place) {
            const learn::Message from = message_of(order), at = message_of(place);
            learn::Message result;
            {
              const nb::gil_scoped_release release;
              result = share.run(from, at);
            }
            return bytes_of(result);
          },
          "order"_a, "place"_a,
          "Does what a trainer's `order` says, from `place` on. What comes back, for `Trainer.receive`, depends on "
          "nothing else: it can be done again by another share of the same worlds. Raises CheckpointError if a "
          "message is not from a trainer like this.");
}

void bind_trainer(nb::module_& m) {
  using Release = nb::call_guard<nb::gil_scoped_release>;
  // NOLINTNEXTLINE(bugprone-throw-keyword-missing,bugprone-unused-raii): makes Python's type
  nb::exception<learn::CheckpointError>(m, "CheckpointError", PyExc_RuntimeError);
  // NOLINTNEXTLINE(bugprone-throw-keyword-missing,bugprone-unused-raii): makes Python's type
  nb::exception<learn::DivergenceError>(m, "DivergenceError", PyExc_RuntimeError);
  nb::class_<Trainer>(m, "Trainer", "Trains a policy on a batch of environments, by the algorithm of its config.")
      .def(nb::init<EnvBatch&, EnvBatch*, const TrainerConfig&, Expert*, const std::vector<Eye>&>(), "envs"_a,
           "evaluation"_a.none(), "config"_a, "expert"_a.none() = nb::none(), "eyes"_a = std::vector<Eye>{},
           nb::keep_alive<1, 2>(), nb::keep_alive<1, 3>(), nb::keep_alive<1, 5>(),
           "Trains on `envs`; `evaluation`, another batch of the same environment, serves the periodic evaluations "
           "that end the training (None: no evaluations). `expert` is needed by a config that wants one. "
           "Through `eyes` the policy sees, with DAgger. Raises ValueError if the config makes no sense.")
      .def("advance", &Trainer::advance, "iterations"_a, Release(),
           "Runs up to `iterations` more: each one step of the batch and `updates_per_iteration` gradient steps. Stops "
           "early when solved. Raises DivergenceError if the networks diverge.")
      .def("spread", &Trainer::spread, "shares"_a,
           "From now on all worlds run elsewhere, in shares of so many, see `Share`; to be called first. Instead of "
           "`advance` there are rounds: each share runs `order` from its `place` on, `receive` takes what they bring, "
           "and while they run the next order, `learn` learns from that. Raises ValueError if the algorithm cannot.")
      .def_prop_ro(
          "order", [](const Trainer& trainer) { return bytes_of(trainer.order()); }, "What all shares are to do now.")
      .def(
          "place", [](const Trainer& trainer, int share) { return bytes_of(trainer.place(share)); }, "share"_a,
          "Where a share's worlds are to begin.")
      .def(
          "receive",
          [](Trainer& trainer, const std::vector<nb::bytes>& results) {
            std::vector<learn::Message> messages;
            for (const nb::bytes& result : results) messages.push_back(message_of(result));
            const nb::gil_scoped_release release;
            trainer.receive(messages);
          },
          "results"_a,
          "Takes in what the shares brought, in their order, and makes the next order. Raises CheckpointError.")
      .def(
          "learn", [](Trainer& trainer) { return trainer.learn(); }, Release(),
          "The gradient steps and evaluations that are due after a round. Raises DivergenceError as `advance` does.")
      .def("metrics", &Trainer::metrics, "Where training stands.")
      .def("scale_rates", &Trainer::scale_rates, "scale"_a,
           "From now on learning rates are `scale` times the config's: for schedules, which checkpoints know nothing "
           "of. "
           "Raises ValueError unless it is finite and at least 0.")
      .def("evaluate", &Trainer::evaluate, "envs"_a, "episodes"_a, "first_seed"_a, Release(),
           "Runs the policy without noise; episode k starts from seed first_seed + k, whatever the size of `envs`.")
      .def("policy", &Trainer::policy, "The deterministic policy.")
      .def(
          "predict",
          [](Trainer& trainer, const States& observation, const States& achieved_goal, const States& desired_goal,
             bool draw) {
            const std::size_t n = observation.shape(0), dim = static_cast<std::size_t>(trainer.action_dim());
            std::vector<float> action(n * dim);
            trainer.predict(as_span(observation), as_span(achieved_goal), as_span(desired_goal), draw, action);
            return copied(action.data(), {n, dim});
          },
          "observation"_a, "achieved_goal"_a, "desired_goal"_a, "draw"_a = false,
          nb::sig("def predict(self, observation: numpy.typing.NDArray[numpy.float32], achieved_goal: "
                  "numpy.typing.NDArray[numpy.float32], desired_goal: numpy.typing.NDArray[numpy.float32], draw: bool "
                  "= False) -> numpy.typing.NDArray[numpy.float32]"),
          "Actions (n, action_dim) in n states, (n, observation_dim) and (n, goal_dim); with `draw` as in training, "
          "else "
          "the best.")
      .def("save", &Trainer::save, "path"_a, "with_replay"_a = true, Release(),
           "Writes everything from which training goes on exactly. The file appears whole or not at all. Raises "
           "CheckpointError.")
      .def("load", &Trainer::load, "path"_a, Release(),
           "Continues from a file of `save` by a trainer with the same task, number of worlds, networks and replay "
           "capacity. Returns whether the running episodes could be restored; if not, every world starts a new one. "
           "Raises CheckpointError and leaves the trainer as it was.");
}

}  // namespace

void bind_learn(nb::module_& m) {
  nb::module_ learn = m.def_submodule("learn", "Training of policies.");
  bind_config(learn);
  bind_results(learn);
  bind_policy(learn);
  bind_trainer(learn);
  bind_share(learn);
}

}  // namespace manyhands
