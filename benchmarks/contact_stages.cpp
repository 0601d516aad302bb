// Substeps per second and core of a Panda in contact, and where their time goes.
//
// Before anything is timed, every scene runs for two seconds in double, scalar float and lanes: it must be what it
// claims to be, the lanes must have the bits of scalar float, and float must be near double.
#include <functional>

#include "benchmarks/contact_worlds.h"

namespace benchmarks {

namespace {

constexpr double kFloatNearDouble = 5e-4;  // [m], [rad] and their rates: cubes may tilt within the slack of touching

/// The largest difference between two runs' numbers.
double difference(const Results& a, const Results& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.numbers.size(); ++i) most = std::max(most, std::abs(a.numbers[i] - b.numbers[i]));
  return most;
}

/// Rates of one scene in every number type, and the stages in lanes.
class SceneRun {
 public:
  SceneRun(ContactScene scene, const Settings& settings)
      : scene_(scene),
        settings_(settings),
        model_(contact_model(cubes_of(scene))),
        starts_(contact_starts(scene, model_)) {}

  void run() {
    ContactWorlds<double> exact(scene_, model_, starts_);
    ContactWorlds<float> scalar(scene_, model_, starts_);
    ContactWorlds<NativeLanes> lanes(scene_, model_, starts_);
    const std::array seen{exact.observe(), scalar.observe(), lanes.observe()};
    reference_ = exact.results();
    scalar_ = scalar.results();
    lanes_ = lanes.results();
    std::vector<std::function<void()>> calls{[&] { exact.step(); }, [&] { scalar.step(); }, [&] { lanes.step(); }};
    const std::vector<Timing> timings = time_in_turns<std::function<void()>>(settings_, calls);
    report<double>(seen[0], timings[0], reference_);
    report<float>(seen[1], timings[1], scalar_);
    report<NativeLanes>(seen[2], timings[2], lanes_);
    report_stages(seen[2]);
  }

 private:
  template <Number T>
  void report(const Observation& seen, const Timing& timing, const Results& results) const {
    std::string wrong = seen.wrong;
    const double away = difference(results, reference_);
    if (wrong.empty() && std::is_same_v<T, NativeLanes> && results.hash != scalar_.hash)
      wrong = "not the bits of the scalar float run";
    if (wrong.empty() && !(away <= kFloatNearDouble)) wrong = "not near double: off by " + std::to_string(away);
    char note[200];
    std::snprintf(note, sizeof note,
                  "%.1f contacts, %.1f iterations, %.2g um deep, creep %.2g um/s, law to %.1g m/s, %.1g from double",
                  seen.contacts, seen.iterations, 1e6 * seen.penetration, 1e6 * seen.creep, seen.law, away);
    print({std::string("contact step, ") + name_of(scene_), number_name<T>(), 1, kContactWorlds / timing.cpu,
           "substeps/s", kContactWorlds / timing.wall, timing.variation, results.hash, wrong, note});
  }

  void report_stages(const Observation& seen) const {
    constexpr std::array kStages{"kinematics, bias, inertia", "collision", "joints and contacts: prepare", "solve",
                                 "remember and integrate"};
    ContactWorlds<NativeLanes> worlds(scene_, model_, starts_);
    for (int i = 0; i < kSettlingSteps + kObservedSteps; ++i) {
      std::array<double, kStages.size()> spent{};
      worlds.step_in_stages(spent);
    }
    const std::string wrong = worlds.results().hash == lanes_.hash ? seen.wrong : "the stages are not those of a step";
    std::array<std::vector<double>, kStages.size()> samples;
    for (int round = 0; round < 10 * settings_.rounds; ++round) {
      std::array<double, kStages.size()> spent{};
      int steps = 0;
      for (const double start = wall_seconds(); steps == 0 || wall_seconds() - start < 0.1 * settings_.seconds; ++steps)
        worlds.step_in_stages(spent);
      for (std::size_t i = 0; i < spent.size(); ++i) samples[i].push_back(spent[i] / (steps * kContactWorlds));
    }
    for (std::size_t i = 0; i < kStages.size(); ++i) {
      const double ns = 1e9 * median(samples[i]);
      print({std::string("Contact step, ") + name_of(scene_) + ": " + kStages[i], number_name<NativeLanes>(), 1, ns,
             "ns/substep", ns, variation(samples[i]), lanes_.hash, wrong, ""});
    }
  }

  ContactScene scene_;
  Settings settings_;
  Model model_;
  std::vector<ContactStart> starts_;
  Results reference_, scalar_, lanes_;
};

}  // namespace

}  // namespace benchmarks

int main(int argc, char** argv) {
  const benchmarks::Settings settings =
      benchmarks::parse(argc, argv, "Substeps per second of a Panda in contact, and their stages.");
  for (const benchmarks::ContactScene scene : benchmarks::kContactScenes) benchmarks::SceneRun(scene, settings).run();
  return 0;
}
