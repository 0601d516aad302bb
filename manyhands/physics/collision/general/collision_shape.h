// A shape that stands for itself: checked, and keeping what it is made of.
#pragma once

#include <memory>
#include <span>

#include "manyhands/physics/collision/general/shape_view.h"

namespace manyhands {

/// A shape outside of any model, for questions about shapes alone. Immutable; copies share their data. What makes one
/// throws std::invalid_argument that says what is wrong with the argument.
class CollisionShape {
 public:
  /// Lengths are above 0 [m]; capsule and cylinder lie along z, `half` the length between the centres of their ends.
  [[nodiscard]] static CollisionShape sphere(double radius);
  [[nodiscard]] static CollisionShape capsule(double radius, double half);
  [[nodiscard]] static CollisionShape cylinder(double radius, double half);
  [[nodiscard]] static CollisionShape box(const Vec3<double>& half);
  /// The half-space z <= 0.
  [[nodiscard]] static CollisionShape plane();
  /// The convex hull of the vertices.
  [[nodiscard]] static CollisionShape convex(std::span<const Vec3<double>> vertices);
  /// The triangles as a surface.
  [[nodiscard]] static CollisionShape mesh(const Mesh& mesh);
  /// The ground below a grid.
  [[nodiscard]] static CollisionShape height_field(HeightField field);

  /// Valid while this shape or a copy lives.
  [[nodiscard]] ShapeView view() const { return {type_, size_, hull_.get(), mesh_.get(), field_.get()}; }
  [[nodiscard]] ShapeType type() const { return type_; }
  [[nodiscard]] const Vec3<double>& size() const { return size_; }  ///< as Shape::size
  [[nodiscard]] const std::shared_ptr<const ConvexPolyhedron>& hull() const { return hull_; }
  [[nodiscard]] const std::shared_ptr<const TriangleMesh>& triangles() const { return mesh_; }
  [[nodiscard]] const std::shared_ptr<const HeightField>& field() const { return field_; }

 private:
  explicit CollisionShape(ShapeType type, const Vec3<double>& size = {}) : type_(type), size_(size) {}

  ShapeType type_;
  Vec3<double> size_;
  std::shared_ptr<const ConvexPolyhedron> hull_;
  std::shared_ptr<const TriangleMesh> mesh_;
  std::shared_ptr<const HeightField> field_;
};

}  // namespace manyhands
