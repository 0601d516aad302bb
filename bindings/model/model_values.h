// What the files that bind models share: vectors and poses between Python and C++.
#pragma once

#include <nanobind/nanobind.h>

#include <array>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "bindings/arrays.h"
#include "bindings/vectors.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/model/model_builder.h"

namespace manyhands {

void bind_model_parts(nanobind::module_& m);
void bind_model_builder(nanobind::module_& m);  // after bind_model's Model
void bind_saving(nanobind::module_& m);         // after bind_model's Model and LoadReport

namespace bindings {

using Numbers3 = std::array<double, 3>;
using Numbers4 = std::array<double, 4>;

/// The signature of a property or method without arguments that gives an array of float64.
[[nodiscard]] inline std::string returns_array(const std::string& name) {
  return "def " + name + "(self) -> numpy.typing.NDArray[numpy.float64]";
}

[[nodiscard]] inline nanobind::object vector3(const Vec3<double>& a) { return copied(&a.x, {3}); }

[[nodiscard]] inline nanobind::object quaternion(const Mat3<double>& R) {
  const Quat<double> r = to_quat(R);
  return copied(&r.x, {4});
}

[[nodiscard]] inline Vec3<double> vec3(const Numbers3& a) { return {a[0], a[1], a[2]}; }

/// The pose of a position and a quaternion xyzw. Throws ModelError unless it has length 1.
[[nodiscard]] inline Transform<double> transform(const std::string& what, const Numbers3& position, const Numbers4& r) {
  const double length2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3];
  if (!(abs(length2 - 1) < 1e-6)) throw ModelError(what + ": the quaternion (x, y, z, w) must have length 1");
  return {to_matrix(normalized(Quat<double>{r[0], r[1], r[2], r[3]})), vec3(position)};
}

using NumberOrNumbers = std::variant<double, std::vector<double>>;

/// The size of a shape from the numbers that it takes. Throws ModelError if their number is another.
[[nodiscard]] inline Vec3<double> size_of(const std::string& shape, ShapeType type, const NumberOrNumbers& given) {
  const std::vector<double> numbers = std::holds_alternative<double>(given)
                                          ? std::vector<double>{std::get<double>(given)}
                                          : std::get<std::vector<double>>(given);
  const bool is_round = type == ShapeType::kCapsule || type == ShapeType::kCylinder;
  const std::size_t expected = type == ShapeType::kSphere ? 1 : is_round ? 2 : type == ShapeType::kBox ? 3 : 0;
  if (numbers.size() != expected) {
    throw ModelError("a geom of shape '" + shape + "' has a size of " + std::to_string(expected) + " numbers, not " +
                     std::to_string(numbers.size()));
  }
  Vec3<double> size{};
  if (expected > 0) size.x = numbers[0];
  if (expected > 1) size.y = numbers[1];
  if (expected > 2) size.z = numbers[2];
  return size;
}

template <class Part>
[[nodiscard]] std::vector<Part> copy_of(std::span<const Part> parts) {
  return {parts.begin(), parts.end()};
}

/// The value that a word stands for. Throws ModelError, which lists the words.
template <class Value, std::size_t n>
[[nodiscard]] Value named(const char* kind, const std::string& word,
                          const std::array<std::pair<const char*, Value>, n>& words) {
  std::string known;
  for (const auto& [name, value] : words) {
    if (word == name) return value;
    known += std::string(" '") + name + "'";
  }
  throw ModelError("there is no " + std::string(kind) + " '" + word + "'; there are" + known);
}

template <class Value, std::size_t n>
[[nodiscard]] const char* name_of(Value wanted, const std::array<std::pair<const char*, Value>, n>& words) {
  for (const auto& [name, value] : words) {
    if (value == wanted) return name;
  }
  return "unknown";
}

inline constexpr std::array<std::pair<const char*, ShapeType>, 8> kShapes{{{"sphere", ShapeType::kSphere},
                                                                           {"capsule", ShapeType::kCapsule},
                                                                           {"cylinder", ShapeType::kCylinder},
                                                                           {"box", ShapeType::kBox},
                                                                           {"plane", ShapeType::kPlane},
                                                                           {"mesh", ShapeType::kMesh},
                                                                           {"convex", ShapeType::kConvex},
                                                                           {"height_field", ShapeType::kHeightField}}};

inline constexpr std::array<std::pair<const char*, EqualityType>, 8> kEqualities{
    {{"point", EqualityType::kPoint},
     {"hinge", EqualityType::kHinge},
     {"fixed", EqualityType::kFixed},
     {"prismatic", EqualityType::kPrismatic},
     {"slider", EqualityType::kSlider},
     {"joint", EqualityType::kJoint},
     {"gear", EqualityType::kGear},
     {"tendon", EqualityType::kTendon}}};

inline constexpr std::array<std::pair<const char*, MjcfCompliance>, 3> kCompliances{
    {{"stated", MjcfCompliance::kStated}, {"all", MjcfCompliance::kAll}, {"none", MjcfCompliance::kNone}}};

inline constexpr std::array<std::pair<const char*, ActuatorType>, 4> kActuators{{{"force", ActuatorType::kForce},
                                                                                 {"position", ActuatorType::kPosition},
                                                                                 {"velocity", ActuatorType::kVelocity},
                                                                                 {"affine", ActuatorType::kAffine}}};

inline constexpr std::array<std::pair<const char*, ActivationType>, 4> kActivations{
    {{"none", ActivationType::kNone},
     {"integrator", ActivationType::kIntegrator},
     {"filter", ActivationType::kFilter},
     {"filterexact", ActivationType::kFilterExact}}};

inline constexpr std::array<std::pair<const char*, CombineRule>, 4> kCombineRules{
    {{"product", CombineRule::kProduct},
     {"geometric_mean", CombineRule::kGeometricMean},
     {"maximum", CombineRule::kMaximum},
     {"minimum", CombineRule::kMinimum}}};

}  // namespace bindings
}  // namespace manyhands
