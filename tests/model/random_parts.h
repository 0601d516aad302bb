// Models at random, of every kind of part.
#pragma once

#include <random>

#include "manyhands/math/quaternion.h"
#include "manyhands/model/model_builder.h"

namespace manyhands::testing {

/// Trees on joints and on welded links, with geoms, frames, drives, couplings and exclusions; all names begin with
/// `prefix`. with_mocap: some links are carried by mocap joints.
inline Model random_parts(std::mt19937& random, const std::string& prefix, bool with_mocap = false) {
  const auto below = [&](int n) { return std::uniform_int_distribution(0, n - 1)(random); };
  const auto x = [&] { return std::uniform_real_distribution(-1.0, 1.0)(random); };
  const auto pose = [&] {
    const Vec3<double> axis = 1 / norm(Vec3<double>{x(), x(), 2}) * Vec3<double>{x(), x(), 2};
    return Transform<double>{to_matrix(normalized(Quat<double>{axis.x, axis.y, axis.z, x()})), {x(), x(), x()}};
  };
  ModelBuilder builder(prefix);
  std::vector<LinkId> links{builder.world()};
  std::vector<JointId> single;
  const int count = 1 + below(6);
  for (int i = 0; i < count; ++i) {
    const std::string name = prefix + std::to_string(i);
    const LinkId parent = links[static_cast<std::size_t>(below(2) * below(static_cast<int>(links.size())))];
    const LinkId link = builder.add_link(name, {.mass = 1, .com = {x(), x(), x()}, .inertia = {1, 1, 1, 0, 0, 0}});
    builder.link(link).gravity_compensation = i == 1 ? 0.3 : 0;
    links.push_back(link);
    if (below(4) == 0) {
      builder.place_root(link, pose());
    } else {
      const auto type = static_cast<JointType>(below(parent == builder.world() ? 7 + with_mocap : 6));
      Joint joint{.name = name + "_joint", .type = type, .parent = parent, .child = link, .X_PF = pose()};
      joint.axis = {x(), x(), 2};
      if (velocity_size(type) == 1) {
        joint.limits = {.lower = -1, .upper = 2};
        if (!single.empty() && below(4) == 0) {
          joint.mimic = Mimic{builder.joint(single.front()).name, 2, 0.1};
        }
      }
      joint.damping = below(2);
      joint.stiffness = 3 * joint.damping;
      const JointId id = builder.add_joint(joint);
      if (velocity_size(type) == 1) single.push_back(id);
    }
    for (int k = below(3); k-- > 0;) {
      builder.add_geom({.name = below(2) == 0 ? name + "_geom" + std::to_string(k) : "",
                        .role = below(4) == 0 ? GeomRole::kVisual : GeomRole::kCollision,
                        .link = link,
                        .X_LG = pose(),
                        .shape = {.type = ShapeType::kBox, .size = {0.1, 0.2, 0.3}}});
    }
    if (below(3) == 0) builder.add_frame(name + "_frame", link, pose());
  }
  if (below(3) == 0) {
    builder.add_geom({.link = builder.world(), .X_LG = pose(), .shape = {.type = ShapeType::kPlane}});
  }
  if (links.size() > 2) {
    if (below(2) == 0) builder.exclude_contact(links[1], links.back());
    if (below(3) == 0) {
      builder.add_equality({.name = prefix + "weld",
                            .type = EqualityType::kFixed,
                            .link_a = links[1],
                            .link_b = links.back(),
                            .X_LA = pose()});
    }
  }
  if (single.size() > 1 && below(2) == 0) {
    builder.add_equality({.name = prefix + "gear",
                          .type = EqualityType::kGear,
                          .joint_a = single.front(),
                          .joint_b = single.back(),
                          .ratio = 2});
  }
  if (!single.empty() && below(2) == 0) {
    builder.add_actuator({.name = prefix + "drive",
                          .type = below(2) == 0 ? ActuatorType::kForce : ActuatorType::kPosition,
                          .joint = single.back(),
                          .kp = 1});
  }
  return builder.build();
}

}  // namespace manyhands::testing
