// A shape of any type, with the data it is made of.
#pragma once

#include "manyhands/physics/collision/general/convex.h"
#include "manyhands/physics/collision/surface/triangle_mesh.h"

namespace manyhands {

/// What a geom's shape is, for queries that take every type. What it points to outlives it.
struct ShapeView {
  ShapeType type = ShapeType::kSphere;
  Vec3<double> size{};                     ///< as Shape::size
  const ConvexPolyhedron* hull = nullptr;  ///< of kConvex
  const TriangleMesh* mesh = nullptr;      ///< of kMesh
  const HeightField* field = nullptr;      ///< of kHeightField

  [[nodiscard]] bool is_convex_body() const {
    return type != ShapeType::kPlane && type != ShapeType::kMesh && type != ShapeType::kHeightField;
  }
  /// Of a convex body.
  [[nodiscard]] ConvexShape convex() const { return ConvexShape::of(type, size, hull); }
};

}  // namespace manyhands
