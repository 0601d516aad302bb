// Shapes that MuJoCo fits to meshes.
#include <algorithm>
#include <cmath>
#include <limits>

#include "manyhands/model/io/mjcf/mjcf_assets.h"
#include "manyhands/model/principal_axes.h"

namespace manyhands::io {

namespace {

/// The half extents of the box with these moments of inertia and this mass.
Vec3<double> box_of(const Vec3<double>& moments, double mass) {
  const auto half = [&](double twice) { return 0.5 * std::sqrt(std::max(6 * twice / mass, 0.0)); };
  return {half(moments.y + moments.z - moments.x), half(moments.x + moments.z - moments.y),
          half(moments.x + moments.y - moments.z)};
}

/// Of a shape about as large as a box.
Vec3<double> size_like(const std::string& type, const Vec3<double>& box) {
  const double radius = 0.5 * (box.x + box.y);
  if (type == "sphere") return {(box.x + box.y + box.z) / 3, 0, 0};
  if (type == "capsule") return {radius, std::max(box.z - 0.5 * radius, 0.0), 0};
  if (type == "cylinder") return {radius, box.z, 0};
  return box;
}

/// Of a shape around a box, as far as its flat sides go.
Vec3<double> size_around(const std::string& type, const Vec3<double>& box) {
  const double radius = std::max(box.x, box.y);
  if (type == "sphere") return {std::max(radius, box.z), 0, 0};
  if (type == "capsule") return {radius, std::max(box.z - radius, 0.0), 0};
  if (type == "cylinder") return {radius, box.z, 0};
  return box;
}

}  // namespace

MjcfFit fitted(const std::string& type, const MjcfMesh& mesh, bool in_box) {
  const Inertial& whole = mesh.per_density;
  const PrincipalAxes axes = principal_axes(whole.inertia);
  const Transform<double> X_MI{axes.R, whole.com};
  if (!in_box) return {size_like(type, box_of(axes.moments, whole.mass)), X_MI};
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec3<double> low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  for (const Vec3<float>& v : mesh.surface.vertices) {
    const Vec3<double> p = inverse(X_MI) * Vec3<double>{v.x, v.y, v.z};
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return {size_around(type, 0.5 * (high - low)), {axes.R, X_MI * (0.5 * (low + high))}};
}

}  // namespace manyhands::io
