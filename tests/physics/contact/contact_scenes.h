// Small worlds in which things touch, for tests of contact on every number type.
#pragma once

#include <string>

#include "manyhands/model/model_builder.h"

namespace manyhands::testing {

/// Adds bodies to a builder in a line each.
struct SceneBuilder {
  explicit SceneBuilder(const std::string& name) : builder(name) {}

  /// A free body of one shape with the inertia of a solid box as large (close enough for any shape).
  LinkId add(const std::string& name, const Shape& shape, double mass, const Vec3<double>& p,
             const SurfaceMaterial& surface = {}) {
    const LinkId link = builder.add_link(name, inertial(shape, mass));
    builder.add_joint({.name = name + "_free",
                       .type = JointType::kFloating,
                       .parent = builder.world(),
                       .child = link,
                       .X_PF = {Mat3<double>::identity(), p}});
    add_geom(link, shape, Transform<double>::identity(), surface);
    return link;
  }

  void add_geom(LinkId link, const Shape& shape, const Transform<double>& X = Transform<double>::identity(),
                const SurfaceMaterial& surface = {}) {
    Geom geom;
    geom.link = link;
    geom.shape = shape;
    geom.X_LG = X;
    geom.surface = surface;
    builder.add_geom(geom);
  }

  /// A link that slides along x in the world.
  LinkId add_slide(const std::string& name, const Shape& shape, double mass, const Vec3<double>& p,
                   const Vec3<double>& axis, double damping = 0) {
    const LinkId link = builder.add_link(name, inertial(shape, mass));
    builder.add_joint({.name = name + "_slide",
                       .type = JointType::kPrismatic,
                       .parent = builder.world(),
                       .child = link,
                       .X_PF = {Mat3<double>::identity(), p},
                       .axis = axis,
                       .damping = damping});
    add_geom(link, shape);
    return link;
  }

  /// A link that turns in its parent about y, with its shape hanging down by half its length.
  LinkId add_hinge(const std::string& name, LinkId parent, const Vec3<double>& p, double half, double mass,
                   const JointLimits& limits = {}) {
    Inertial body = inertial({ShapeType::kCapsule, {0.02, half, 0}}, mass);
    body.com = {0, 0, -half};
    const LinkId link = builder.add_link(name, body);
    builder.add_joint({.name = name + "_hinge",
                       .type = JointType::kRevolute,
                       .parent = parent,
                       .child = link,
                       .X_PF = {Mat3<double>::identity(), p},
                       .axis = {0, 1, 0},
                       .limits = limits});
    add_geom(link, {ShapeType::kCapsule, {0.02, half, 0}}, {Mat3<double>::identity(), {0, 0, -half}});
    return link;
  }

  static Inertial inertial(const Shape& shape, double mass) {
    const Vec3<double> s = shape.size;
    const Vec3<double> half = shape.type == ShapeType::kBox      ? s
                              : shape.type == ShapeType::kSphere ? Vec3<double>{0.8 * s.x, 0.8 * s.x, 0.8 * s.x}
                                                                 : Vec3<double>{s.x, s.x, s.y};
    const auto about = [&](double a, double b) { return mass / 3 * (a * a + b * b); };
    return {.mass = mass, .inertia = {about(half.y, half.z), about(half.x, half.z), about(half.x, half.y), 0, 0, 0}};
  }

  ModelBuilder builder;
};

inline constexpr int kScenes = 6;

/// Stacked boxes; a pinched capsule; an arm among boxes; rolling, spinning and bouncing things; equality constraints;
/// the same where everything gives way.
inline Model contact_scene(int which) {
  SceneBuilder s("scene " + std::to_string(which));
  const LinkId world = s.builder.world();
  s.add_geom(world, {ShapeType::kPlane});
  switch (which) {
    case 0:
      s.add_geom(world, {ShapeType::kBox, {0.3, 0.3, 0.05}}, {Mat3<double>::identity(), {0, 0, 0.05}});
      for (int i = 0; i < 3; ++i)
        s.add("cube" + std::to_string(i), {ShapeType::kBox, {0.02, 0.02, 0.02}}, 1, {0.002 * i, 0, 0.121 + 0.041 * i});
      break;
    case 1: {
      s.add("capsule", {ShapeType::kCapsule, {0.004, 0.015, 0}}, 0.045, {0, 0, 0.2}, {.lateral_friction = 0.8});
      for (const double side : {-1.0, 1.0}) {
        const std::string name = side < 0 ? "left" : "right";
        s.add_slide(name, {ShapeType::kBox, {0.004, 0.02, 0.03}}, 0.1, {0.009 * side, 0, 0.2}, {-side, 0, 0}, 20);
        s.builder.add_actuator({.name = name,
                                .type = ActuatorType::kPosition,
                                .joint = JointId(static_cast<std::size_t>(side < 0 ? 1 : 2)),
                                .kp = 6000,
                                .max_force = 100});
      }
      break;
    }
    case 2: {
      const LinkId upper = s.add_hinge("upper", world, {0, 0, 0.5}, 0.15, 2, {.lower = -1, .upper = 1});
      s.add_hinge("lower", upper, {0, 0, -0.3}, 0.08, 1, {.lower = -0.4, .upper = 2});
      s.add("left", {ShapeType::kBox, {0.05, 0.05, 0.05}}, 0.5, {0.12, 0, 0.051});
      s.add("right", {ShapeType::kBox, {0.05, 0.05, 0.05}}, 0.5, {-0.12, 0.01, 0.051});
      break;
    }
    case 3:
      s.add("ball", {ShapeType::kSphere, {0.05, 0, 0}}, 0.4, {0, 0, 0.06}, {.rolling_friction = 0.002});
      s.add("spinner", {ShapeType::kCylinder, {0.05, 0.01, 0}}, 0.3, {0.2, 0, 0.011}, {.spinning_friction = 0.01});
      s.add("bouncer", {ShapeType::kSphere, {0.03, 0, 0}}, 0.2, {0.4, 0, 0.3}, {.restitution = 0.7});
      s.add("soft", {ShapeType::kBox, {0.03, 0.03, 0.03}}, 0.2, {0.6, 0, 0.031}, {.stiffness = 2000, .damping = 5});
      s.add("grooved", {ShapeType::kBox, {0.03, 0.03, 0.03}}, 0.2, {0.8, 0, 0.031}, {.friction_y = 0.05});
      break;
    default: {
      std::optional<Compliance> compliance;
      if (which == 5) compliance = {.stiffness = 200, .damping = 9, .impedance = 0.3, .width = 0.05, .power = 1.5};
      const JointLimits limits{.lower = -0.02, .upper = 0.02, .compliance = compliance};
      const LinkId left = s.add_hinge("left", world, {0, 0, 0.3}, 0.1, 1, which == 5 ? limits : JointLimits());
      const LinkId right = s.add_hinge("right", world, {0.2, 0, 0.3}, 0.1, 1);
      const LinkId bar = s.add_hinge("bar", left, {0, 0, -0.2}, 0.1, 0.5);
      s.builder.joint(JointId(2)).X_PF.R = {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}};  // to the right
      s.builder.exclude_contact(bar, right);
      s.builder.exclude_contact(left, right);
      s.builder.add_equality({.name = "pin",
                              .type = EqualityType::kPoint,
                              .link_a = right,
                              .link_b = bar,
                              .X_LA = {Mat3<double>::identity(), {0, 0, -0.2}},
                              .X_LB = {Mat3<double>::identity(), {0, 0, -0.2}},
                              .compliance = compliance});
      s.add("box", {ShapeType::kBox, {0.03, 0.03, 0.03}}, 0.3, {0.05, 0, 0.035}, {.compliance = compliance});
      break;
    }
  }
  return s.builder.build();
}

}  // namespace manyhands::testing
