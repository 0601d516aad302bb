#include "manyhands/envs/randomize.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace manyhands {

namespace {

/// What a name allows.
struct Kind {
  const char* name;
  double usual;  ///< where it is not randomised
  double least, most;
};

constexpr double kTiny = 1e-3, kHuge = 1e3;
/// In the order of Randomized.
constexpr std::array<Kind, kRandomizedCount> kKinds{{{"object_mass", 1, kTiny, kHuge},
                                                     {"object_size", 1, 0.1, 5},
                                                     {"object_friction", 1, 0, kHuge},
                                                     {"table_friction", 1, 0, kHuge},
                                                     {"finger_friction", 1, 0, kHuge},
                                                     {"gravity", 1, 0, 10},
                                                     {"joint_damping", 0, 0, kHuge},
                                                     {"motor_gain", 1, kTiny, 10},
                                                     {"motor_force", 1, 0, kHuge},
                                                     {"action_latency", 0, 0, 64},
                                                     {"action_noise", 0, 0, kHuge},
                                                     {"observation_noise", 0, 0, kHuge}}};

constexpr std::size_t index_of(Randomized what) { return static_cast<std::size_t>(what); }

std::size_t kind_named(const std::string& name) {
  const auto* kind = std::ranges::find(kKinds, name, &Kind::name);
  if (kind != kKinds.end()) return static_cast<std::size_t>(kind - kKinds.begin());
  std::string message = "randomize: there is no '" + name + "'; there are:";
  for (const Kind& known : kKinds) message += std::string(" ") + known.name;
  throw std::invalid_argument(message);
}

void check(const RandomRange& range, const Kind& kind, bool whole) {
  const auto refuse = [&](const std::string& expected) {
    throw std::invalid_argument("randomize: '" + range.name + "' has the range " + std::to_string(range.low) + " to " +
                                std::to_string(range.high) + "; expected " + expected);
  };
  if (!(range.low >= kind.least && range.low <= range.high && range.high <= kind.most))
    refuse("low <= high, both from " + std::to_string(kind.least) + " to " + std::to_string(kind.most));
  if (range.logarithmic && (whole || range.low <= 0))
    refuse(whole ? "a uniform range of whole numbers" : "more than 0 where the logarithm is uniform");
  if (whole && (std::floor(range.low) != range.low || std::floor(range.high) != range.high))
    refuse("whole numbers of environment steps");
}

double value_at(const RandomRange& range, double unit, bool whole) {
  if (whole) return range.low + std::floor(unit * (range.high - range.low + 1));
  if (range.logarithmic) return range.low * exp(unit * log(range.high / range.low));
  return std::fma(unit, range.high - range.low, range.low);
}

}  // namespace

Randomizer::Randomizer(std::span<const RandomRange> ranges) : ranges_(ranges.begin(), ranges.end()) {
  range_.fill(-1);
  for (const RandomRange& range : ranges_) {
    const std::size_t kind = kind_named(range.name);
    const bool whole = kind == index_of(Randomized::kActionLatency);
    if (range_[kind] >= 0) throw std::invalid_argument("randomize: '" + range.name + "' is given twice");
    check(range, kKinds[kind], whole);
    range_[kind] = static_cast<int>(names_.size());
    names_.push_back(range.name);
    if (whole) longest_latency_ = static_cast<std::size_t>(range.high);
  }
}

bool Randomizer::varies_physics() const {
  return std::ranges::any_of(range_.begin(), range_.begin() + index_of(Randomized::kActionLatency),
                             [](int range) { return range >= 0; });
}

RandomValues Randomizer::draw(const RandomKey& key) const {
  RandomStream random(key.seed, 0, key.episode);
  RandomValues values{};
  for (std::size_t kind = 0; kind < values.size(); ++kind) {
    const auto unit = random.unit<double>();
    const bool whole = kind == index_of(Randomized::kActionLatency);
    const double value =
        range_[kind] < 0 ? kKinds[kind].usual : value_at(ranges_[static_cast<std::size_t>(range_[kind])], unit, whole);
    values[kind] = static_cast<float>(value);
  }
  return values;
}

void Randomizer::write(const RandomValues& values, std::span<float> row) const {
  for (std::size_t kind = 0; kind < values.size(); ++kind) {
    if (range_[kind] >= 0) row[static_cast<std::size_t>(range_[kind])] = values[kind];
  }
}

SceneParts::SceneParts(const Model& scene, const Arm& arm, std::span<const ObjectSpec> objects) {
  for (const ObjectSpec& object : objects) object_bodies.push_back(scene.link(scene.link_id(object.name)).body.index());
  for (std::size_t i = 0; i < arm.max_force.size(); ++i) motor_dofs.push_back(arm.dof(i));
  const auto is_finger = [&](std::size_t body) {
    const Body& part = scene.bodies()[body];
    const auto dof = static_cast<std::size_t>(part.iv);
    const bool follows = std::ranges::any_of(arm.followers, [&](const Follower& joint) { return joint.dof == dof; });
    return part.nv == 1 && (follows || std::ranges::count(arm.fingers, dof) > 0);
  };
  for (std::size_t i = 0; i < scene.geoms().size(); ++i) {
    const Geom& geom = scene.geoms()[i];
    const std::size_t body = scene.link(geom.link).body.index();
    if (std::ranges::count(object_bodies, body) > 0) object_geoms.push_back(i);
    if (geom.name == "table") table_geoms.push_back(i);
    if (is_finger(body)) finger_geoms.push_back(i);
  }
}

template <Real R>
void write_params(const RandomValues& values, const SceneParts& parts, const ParamsView<R>& base,
                  const ParamsView<R>& to) {
  const auto value = [&](Randomized what) { return static_cast<R>(values[index_of(what)]); };
  const R mass = value(Randomized::kObjectMass), size = value(Randomized::kObjectSize);
  for (const std::size_t body : parts.object_bodies) {
    for (std::size_t k = 0; k < 10; ++k)  // mass, first moments, inertia
      to.inertia[10 * body + k] = mass * (k == 0 ? R(1) : k < 4 ? size : size * size) * base.inertia[10 * body + k];
  }
  for (const std::size_t geom : parts.object_geoms) {
    for (std::size_t k = 0; k < 3; ++k) to.geom_size[3 * geom + k] = size * base.geom_size[3 * geom + k];
  }
  const auto rub = [&](const std::vector<std::size_t>& geoms, Randomized what) {
    for (const std::size_t geom : geoms) {
      to.geom_friction[geom] = value(what) * base.geom_friction[geom];
      to.geom_friction_y[geom] = value(what) * base.geom_friction_y[geom];
    }
  };
  rub(parts.object_geoms, Randomized::kObjectFriction);
  rub(parts.table_geoms, Randomized::kTableFriction);
  rub(parts.finger_geoms, Randomized::kFingerFriction);
  for (std::size_t k = 0; k < 3; ++k) to.gravity[k] = value(Randomized::kGravity) * base.gravity[k];
  for (const std::size_t dof : parts.motor_dofs) {
    to.damping[dof] = base.damping[dof] + value(Randomized::kJointDamping);
    to.motor_kp[dof] = std::min(R(1), value(Randomized::kMotorGain) * base.motor_kp[dof]);
    to.motor_max_force[dof] = value(Randomized::kMotorForce) * base.motor_max_force[dof];
  }
}

template void write_params(const RandomValues&, const SceneParts&, const ParamsView<double>&,
                           const ParamsView<double>&);
template void write_params(const RandomValues&, const SceneParts&, const ParamsView<float>&, const ParamsView<float>&);

}  // namespace manyhands
