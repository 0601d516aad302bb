#include "manyhands/physics/collision/general/collision_shape.h"

#include <stdexcept>
#include <string>

#include "manyhands/model/part_checks.h"

namespace manyhands {
namespace {

double length(const char* what, double x) {
  if (x > 0 && is_finite(x)) return x;
  throw std::invalid_argument(std::string(what) + " is " + std::to_string(x) + " m; expected a finite length above 0");
}

}  // namespace

CollisionShape CollisionShape::sphere(double radius) {
  return CollisionShape(ShapeType::kSphere, {length("a sphere's radius", radius), 0, 0});
}

CollisionShape CollisionShape::capsule(double radius, double half) {
  return CollisionShape(ShapeType::kCapsule,
                        {length("a capsule's radius", radius), length("a capsule's half length", half), 0});
}

CollisionShape CollisionShape::cylinder(double radius, double half) {
  return CollisionShape(ShapeType::kCylinder,
                        {length("a cylinder's radius", radius), length("a cylinder's half length", half), 0});
}

CollisionShape CollisionShape::box(const Vec3<double>& half) {
  for (const double x : {half.x, half.y, half.z}) length("a half extent of a box", x);
  return CollisionShape(ShapeType::kBox, half);
}

CollisionShape CollisionShape::plane() { return CollisionShape(ShapeType::kPlane); }

CollisionShape CollisionShape::convex(std::span<const Vec3<double>> vertices) {
  CollisionShape shape(ShapeType::kConvex);
  shape.hull_ = std::make_shared<const ConvexPolyhedron>(convex_polyhedron(vertices));
  return shape;
}

CollisionShape CollisionShape::mesh(const Mesh& mesh) {
  CollisionShape shape(ShapeType::kMesh);
  shape.mesh_ = std::make_shared<const TriangleMesh>(mesh);
  return shape;
}

CollisionShape CollisionShape::height_field(HeightField field) {
  if (!is_finite(field.dx) || !is_finite(field.dy)) {
    throw std::invalid_argument("the spacings of a height field must be finite numbers above 0");
  }
  check_height_field(field);
  CollisionShape shape(ShapeType::kHeightField);
  shape.field_ = std::make_shared<const HeightField>(std::move(field));
  return shape;
}

}  // namespace manyhands
