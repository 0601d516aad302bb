#include "manyhands/bullet/inertia.h"

#include <algorithm>

#include "manyhands/bullet/bounds.h"
#include "manyhands/model/principal_axes.h"

namespace manyhands::bullet {

namespace {

constexpr double kMargin = 0.001;  // of hulls [m]

/// Of a solid box with these half extents.
Vec3<double> box_inertia(double mass, const Vec3<double>& half) {
  const Vec3<double> s{half.x * half.x, half.y * half.y, half.z * half.z};
  return (mass / 3) * Vec3<double>{s.y + s.z, s.x + s.z, s.x + s.y};
}

/// Along the shape's own axes, as PyBullet's AABB of it.
Bounds own_bounds(const BodyPlan& plan, const ShapePlan& shape) {
  const Vec3<double>& s = shape.geom.shape.size;
  Vec3<double> half;
  switch (shape.geom.shape.type) {
    case ShapeType::kSphere:
      half = {s.x, s.x, s.x};
      break;
    case ShapeType::kCapsule:
      half = {s.x, s.x, s.y + s.x};
      break;
    case ShapeType::kCylinder:
      half = {s.x, s.x, s.y};
      break;
    case ShapeType::kBox:
      half = s;
      break;
    default: {
      Bounds b;
      for (const Vec3<float>& p : plan.meshes[shape.geom.shape.mesh.index()].vertices) {
        b.widen(Vec3<double>{p.x, p.y, p.z}, {3 * kMargin, 3 * kMargin, 3 * kMargin});
      }
      return b;
    }
  }
  if (shape.is_urdf_cylinder) half = half + Vec3<double>{3 * kMargin, 3 * kMargin, 3 * kMargin};
  return {-half, half};
}

/// Of all shapes along the axes of the inertial frame.
Bounds all_bounds(const BodyPlan& plan, const LinkPlan& link) {
  Bounds all;
  for (const ShapePlan& shape : link.collisions) {
    const Bounds own = own_bounds(plan, shape);
    all.widen(inverse(link.X_LI) * shape.geom.X_LG, own.centre(), own.half());
  }
  return all;
}

bool is_centred(const LinkPlan& link, const ShapePlan& shape) {
  const Transform<double> X = inverse(link.X_LI) * shape.geom.X_LG;
  const double off = std::abs(X.p.x) + std::abs(X.p.y) + std::abs(X.p.z);
  return off < 1e-12 && X.R.x.x > 1 - 1e-12 && X.R.y.y > 1 - 1e-12;
}

}  // namespace

Vec3<double> inertia_of_shapes(const BodyPlan& plan, const LinkPlan& link, double mass, bool from_file) {
  if (link.collisions.empty()) {
    constexpr double kCube = 6.67e-7;  // of 2 mm, for 1 kg
    return from_file ? Vec3<double>{kCube * mass, kCube * mass, kCube * mass} : Vec3<double>::zero();
  }
  if (std::ranges::any_of(link.collisions, &ShapePlan::is_ground)) return Vec3<double>::zero();
  const ShapePlan& first = link.collisions.front();
  const Vec3<double>& s = first.geom.shape.size;
  if (link.collisions.size() == 1 && is_centred(link, first)) {
    if (first.geom.shape.type == ShapeType::kSphere) {
      const double I = 0.4 * mass * s.x * s.x;
      return {I, I, I};
    }
    if (first.geom.shape.type == ShapeType::kCylinder && !first.is_urdf_cylinder) {
      const double across = mass / 12 * (3 * s.x * s.x + 4 * s.y * s.y);
      return {across, across, 0.5 * mass * s.x * s.x};
    }
  }
  return box_inertia(mass, all_bounds(plan, link).half());
}

void set_inertias(BodyPlan& plan, bool use_file, bool from_file) {
  for (int i = -1; i < plan.num_links(); ++i) {
    LinkPlan& link = plan.link(i);
    if (use_file && link.has_file_inertia) {
      const SymMat3<double>& I = link.file_inertia;
      if (I.xy == 0 && I.xz == 0 && I.yz == 0) {
        link.inertia = {I.xx, I.yy, I.zz};
        continue;
      }
      const PrincipalAxes axes = principal_axes(I);
      link.X_LI.R = axes.R;
      link.inertia = axes.moments;
    } else {
      link.inertia = inertia_of_shapes(plan, link, link.mass, from_file);
    }
  }
}

}  // namespace manyhands::bullet
