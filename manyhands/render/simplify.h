// Coarser copies of triangle meshes, for pictures in which nobody sees the difference.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "manyhands/render/clusters.h"

namespace manyhands {

/// Moves vertices onto neighbours, the least visible first, by the sum of squared distances from the planes of the
/// triangles that they have taken along (Garland and Heckbert, Surface Simplification Using Quadric Error Metrics,
/// 1997). What is left are vertices of the mesh, with its normals. A closed mesh stays closed.
class Simplifier {
 public:
  explicit Simplifier(std::span<const Facet> mesh);
  ~Simplifier();
  Simplifier(const Simplifier& other);
  Simplifier(Simplifier&&) noexcept;
  Simplifier& operator=(const Simplifier&) = delete;
  Simplifier& operator=(Simplifier&&) noexcept;

  /// Goes on until the next vertex would be farther than `error` [m] from its planes, in the mean of their squares, or
  /// a triangle turn away from the normals at its corners by more than `angle` [rad]; pi or more: by
  /// any angle.
  void simplify(double error, double angle);
  [[nodiscard]] std::vector<Facet> facets() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace manyhands
