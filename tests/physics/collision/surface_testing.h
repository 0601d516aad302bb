// Meshes and height fields for tests.
#pragma once

#include "manyhands/physics/collision/surface/triangle_mesh.h"
#include "tests/physics/collision/shape_testing.h"

namespace manyhands::testing {

/// A flat square of side 2, cut into 2 n n triangles of uneven shape.
inline Mesh flat_ground(int n, ShapeSource& source) {
  Mesh mesh{"ground"};
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const bool rim = i == 0 || j == 0 || i == n || j == n;
      const double shake = rim ? 0 : 0.3;
      mesh.vertices.push_back({static_cast<float>(-1 + (2 * i + source.uniform(-shake, shake)) / n),
                               static_cast<float>(-1 + (2 * j + source.uniform(-shake, shake)) / n), 0});
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = b + n + 1, d = a + n + 1;
      if ((i + j) % 2 != 0) {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
      } else {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
      }
    }
  }
  return mesh;
}

/// The surface of a polyhedron.
inline Mesh surface_of(const ConvexPolyhedron& hull) {
  Mesh mesh{"hull"};
  for (const auto& v : hull.vertices) mesh.vertices.push_back(broadcast<float>(v));
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const auto face = hull.faces[f];
    for (std::size_t i = 1; i + 1 < face.size(); ++i) mesh.triangles.push_back({face[0], face[i], face[i + 1]});
  }
  return mesh;
}

inline ConvexPolyhedron cube_hull() {
  std::vector<Point> corners;
  for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5});
  return convex_polyhedron(std::span<const Point>(corners));
}

/// Spacing and heights are such that vertices are exact in float.
inline HeightField rough_ground(int columns, int rows, double roughness, ShapeSource& source) {
  HeightField field{columns, rows, 0.125, 0.0625, {}};
  for (int i = 0; i < columns * rows; ++i) {
    field.height.push_back(static_cast<double>(static_cast<float>(source.uniform(-roughness, roughness))));
  }
  return field;
}

/// The surface of a height field.
inline Mesh surface_of(const HeightField& field) {
  Mesh mesh{"field"};
  for (int j = 0; j < field.rows; ++j) {
    for (int i = 0; i < field.columns; ++i) {
      mesh.vertices.push_back({static_cast<float>((i - 0.5 * (field.columns - 1)) * field.dx),
                               static_cast<float>((j - 0.5 * (field.rows - 1)) * field.dy),
                               static_cast<float>(field.height[static_cast<std::size_t>(j * field.columns + i)])});
    }
  }
  for (int j = 0; j + 1 < field.rows; ++j) {
    for (int i = 0; i + 1 < field.columns; ++i) {
      const int a = j * field.columns + i, b = a + 1, d = a + field.columns, c = d + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
    }
  }
  return mesh;
}

}  // namespace manyhands::testing
