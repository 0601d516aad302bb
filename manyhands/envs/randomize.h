// What may differ from episode to episode besides where it begins: physics, motors, delays and noise.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "manyhands/envs/make.h"
#include "manyhands/envs/scene.h"
#include "manyhands/math/philox.h"
#include "manyhands/physics/world/parameters.h"

namespace manyhands {

/// What can be randomised. A factor multiplies what the task says, and is 1 where nothing is asked for.
enum class Randomized : std::uint8_t {
  kObjectMass,        ///< factor, of every object; its inertia in proportion
  kObjectSize,        ///< factor, of every object in all directions; the mass stays
  kObjectFriction,    ///< factor, lateral
  kTableFriction,     ///< factor, lateral
  kFingerFriction,    ///< factor, lateral
  kGravity,           ///< factor
  kJointDamping,      ///< [N m s/rad or N s/m] of every joint of the arm, fingers included
  kMotorGain,         ///< factor: the share of a motor's error that a physics step removes
  kMotorForce,        ///< factor, of the largest
  kActionLatency,     ///< whole environment steps from an action to its effect; until the first one acts: zeros
  kActionNoise,       ///< standard deviation, fresh in each number of each action, before it is clipped
  kObservationNoise,  ///< standard deviation, fresh in each number of `observation`; goals and rewards stay exact
};
inline constexpr std::size_t kRandomizedCount = 12;

/// The values of one episode of one world, those that were not asked for included.
using RandomValues = std::array<float, kRandomizedCount>;

/// The random numbers of a world's randomisation: a stream of its own, so that goals and placements stay as they are.
struct RandomKey {
  std::uint64_t seed = 0;
  std::uint64_t episode = 0;  ///< resets since the seed was set
};

/// Draws values from ranges. Uniform: one for all worlds of a batch.
class Randomizer {
 public:
  /// Throws std::invalid_argument on a name that there is not (the message lists those there are), one given twice, or
  /// a range that is empty or leaves what the name allows.
  explicit Randomizer(std::span<const RandomRange> ranges);

  [[nodiscard]] bool empty() const { return names_.empty(); }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }  ///< as given
  [[nodiscard]] bool varies(Randomized what) const { return range_[static_cast<std::size_t>(what)] >= 0; }
  /// Whether physics differ between worlds, so that each needs parameters of its own.
  [[nodiscard]] bool varies_physics() const;
  [[nodiscard]] std::size_t longest_latency() const { return longest_latency_; }  ///< [environment steps]

  /// What an episode has. A value depends on the key and its own range alone, not on what else is randomised.
  [[nodiscard]] RandomValues draw(const RandomKey& key) const;
  /// The values in the order of names().
  void write(const RandomValues& values, std::span<float> row) const;

 private:
  std::vector<RandomRange> ranges_;
  std::vector<std::string> names_;
  std::array<int, kRandomizedCount> range_;  ///< of each kind: the index in ranges_, or -1
  std::size_t longest_latency_ = 0;
};

/// Normal noise, a pure function of the episode, the step and what it is added to.
[[nodiscard]] inline RandomStream noise_of(const RandomKey& key, int step, Randomized what) {
  const auto part = static_cast<std::uint32_t>(what == Randomized::kActionNoise ? 1 : 2);
  return {key.seed, 2 * static_cast<std::uint32_t>(step) + part, key.episode};
}

/// Where the parts of a scene stand in its parameters.
struct SceneParts {
  SceneParts(const Model& scene, const Arm& arm, std::span<const ObjectSpec> objects);

  std::vector<std::size_t> object_bodies, object_geoms, table_geoms, finger_geoms, motor_dofs;
};

/// Gives one world the parameters `base` as the values change them.
template <Real R>
void write_params(const RandomValues& values, const SceneParts& parts, const ParamsView<R>& base,
                  const ParamsView<R>& to);

}  // namespace manyhands
