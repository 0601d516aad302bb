// Triangle meshes that are seen: smooth normals, and coarser copies for small pictures.
#pragma once

#include <memory>
#include <vector>

#include "manyhands/render/clusters.h"

namespace manyhands {

/// Meshes that move together, in the axes of their body B. Immutable, shared by scenes and threads.
class Triangles {
 public:
  /// A mesh in B; its normals are smooth where neighbours meet at less than 40 degrees, or not at all.
  struct Part {
    std::vector<Vec3<float>> vertices;
    std::vector<std::array<int, 3>> triangles;
    bool is_smooth = true;
  };

  /// Those of equal parts are made once, as long as somebody keeps them.
  [[nodiscard]] static std::shared_ptr<const Triangles> of(std::vector<Part> parts);

  /// The meshes as they are.
  [[nodiscard]] const ClusteredMesh& exact() const { return exact_; }
  /// The coarsest copy whose surface is off by about `error` [m] at most, to be looked at.
  [[nodiscard]] const ClusteredMesh& within(float error) const { return coarsest(shown_, error); }
  /// Likewise, where one sees its shadow only: coarser, as it does not matter how it is turned to the light.
  [[nodiscard]] const ClusteredMesh& casting_within(float error) const { return coarsest(casting_, error); }

 private:
  struct Level {
    float error;  // [m]
    ClusteredMesh mesh;
  };
  explicit Triangles(const std::vector<Part>& parts);
  [[nodiscard]] const ClusteredMesh& coarsest(const std::vector<Level>& levels, float error) const;

  ClusteredMesh exact_;
  std::vector<Level> shown_, casting_;  // from the finest on
};

}  // namespace manyhands
