// Random trees with every type of joint, and random states of them.
#pragma once

#include <array>
#include <random>
#include <string>

#include "manyhands/math/quaternion.h"
#include "manyhands/model/model_builder.h"

namespace manyhands::testing {

using Generator = std::mt19937_64;

inline double uniform(Generator& rng, double low, double high) {
  return low + (high - low) * (static_cast<double>(rng() >> 11) * 0x1p-53);
}

inline Vec3<double> random_vector(Generator& rng, double reach) {
  return {uniform(rng, -reach, reach), uniform(rng, -reach, reach), uniform(rng, -reach, reach)};
}

inline Quat<double> random_rotation(Generator& rng) { return quat_from_rotation_vector(random_vector(rng, 2.0)); }

/// A box of 0.2 to 5 kg, turned at random.
inline Inertial random_inertial(Generator& rng) {
  const double m = uniform(rng, 0.2, 5.0), a = uniform(rng, 0.05, 0.5), b = uniform(rng, 0.05, 0.5),
               c = uniform(rng, 0.05, 0.5);
  const SymMat3<double> box{m / 12 * (b * b + c * c), m / 12 * (a * a + c * c), m / 12 * (a * a + b * b), 0, 0, 0};
  return {.mass = m, .com = random_vector(rng, 0.2), .inertia = rotated(to_matrix(random_rotation(rng)), box)};
}

inline constexpr std::array kJointTypes{JointType::kFixed,     JointType::kRevolute,  JointType::kContinuous,
                                        JointType::kPrismatic, JointType::kSpherical, JointType::kPlanar,
                                        JointType::kFloating};
/// The first of them: those of one degree of freedom at most.
inline constexpr std::size_t kSingleTypes = 4;

/// `links` links, joined at random places; the first `types` types of joint anywhere, the root included.
inline Model random_tree(std::uint64_t seed, int links, std::size_t types = kJointTypes.size()) {
  Generator rng(seed);
  ModelBuilder builder("random tree " + std::to_string(seed));
  std::vector<LinkId> all{builder.world()};
  for (int i = 0; i < links; ++i) {
    const bool branch = uniform(rng, 0, 1) < 0.4;
    const LinkId parent = branch ? all[rng() % all.size()] : all.back();
    const LinkId child = builder.add_link("link" + std::to_string(i), random_inertial(rng));
    const JointType type = kJointTypes[rng() % types];
    const bool plain = uniform(rng, 0, 1) < 0.3;
    builder.add_joint(
        {.name = "joint" + std::to_string(i),
         .type = type,
         .parent = parent,
         .child = child,
         .X_PF = {plain ? Mat3<double>::identity() : to_matrix(random_rotation(rng)), random_vector(rng, 0.5)},
         .axis = plain ? Vec3<double>{0, 0, 1} : random_vector(rng, 1.0),
         .armature = uniform(rng, 0.0, 0.3)});
    all.push_back(child);
  }
  return builder.build();
}

/// q (nq) within a turn and a metre, quaternions of unit length.
inline std::vector<double> random_configuration(const Model& model, Generator& rng) {
  std::vector<double> q(static_cast<std::size_t>(model.nq()));
  for (double& x : q) x = uniform(rng, -3.0, 3.0);
  for (const Body& body : model.bodies()) {
    if (body.type != JointType::kSpherical && body.type != JointType::kFloating) continue;
    const Quat<double> r = random_rotation(rng);
    double* at = &q[static_cast<std::size_t>(body.iq + body.nq - 4)];
    at[0] = r.x;
    at[1] = r.y;
    at[2] = r.z;
    at[3] = r.w;
  }
  return q;
}

inline std::vector<double> random_numbers(std::size_t n, Generator& rng) {
  std::vector<double> values(n);
  for (double& x : values) x = uniform(rng, -2.0, 2.0);
  return values;
}

}  // namespace manyhands::testing
