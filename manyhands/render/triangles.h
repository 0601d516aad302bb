// Triangle meshes that rays can meet, through Embree.
#pragma once

#include <memory>
#include <vector>

#include "manyhands/model/description.h"
#include "manyhands/render/rays.h"

namespace manyhands {

/// What a ray met: number `triangle` of part `part`.
struct TriangleHit {
  int part, triangle;
};

/// Meshes that move together, in the axes of their body B. Immutable, shared by scenes and threads.
class Triangles {
 public:
  /// A mesh in B; its normals are smooth where neighbours meet at less than 40 degrees, or not at all.
  struct Part {
    std::vector<Vec3<float>> vertices;
    std::vector<std::array<int, 3>> triangles;
    bool is_smooth = true;
  };
  struct Surface {
    float t;        ///< where the ray meets the triangle's plane
    Vec3<float> n;  ///< unit; from the neighbours where the mesh is smooth there
  };

  /// Those of equal parts are made once, as long as somebody keeps them. Throws std::runtime_error if Embree fails.
  [[nodiscard]] static std::shared_ptr<const Triangles> of(std::vector<Part> parts);
  ~Triangles();
  Triangles(const Triangles&) = delete;
  Triangles& operator=(const Triangles&) = delete;

  /// Shortens `rays.far` to the first triangle met, from either side, and says which it was; returns the lanes that met
  /// one. The others' `part` and `triangle` stay as they are.
  RayMask meet(RayPacket& rays, RayInts& part, RayInts& triangle) const;
  /// The lanes whose rays meet anything.
  [[nodiscard]] RayMask blocks(const RayPacket& rays) const;
  /// Exactly where a ray meets the triangle: the same on every machine, which Embree's own numbers are not.
  [[nodiscard]] Surface surface(const TriangleHit& hit, const Vec3<float>& o, const Vec3<float>& d) const;

 private:
  struct Built;
  explicit Triangles(std::vector<Part> parts);

  std::vector<Part> parts_;
  std::vector<std::vector<std::array<Vec3<float>, 3>>> normals_;  // of each part's triangles' corners
  std::unique_ptr<Built> built_;
};

}  // namespace manyhands
