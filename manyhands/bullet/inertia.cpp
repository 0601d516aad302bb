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

/// How far PyBullet's AABB of a shape reaches beyond it: three margins of hulls, two of those in a program's compound,
/// and one more where the shape of a file lies in another: an OBJ file's, whose objects are shapes, or one that does
/// not lie along the inertial frame.
double reach_beyond(const ShapePlan& shape, bool lies_alone, bool from_file) {
  const bool is_hull = shape.is_urdf_cylinder || shape.geom.shape.mesh.is_valid();
  if (is_hull && !from_file) return (lies_alone ? 3 : 2) * kMargin;
  if (is_hull) return (shape.file.ends_with(".obj") ? 4 : 3) * kMargin;
  return lies_alone || !from_file ? 0 : kMargin;
}

/// Along the shape's own axes.
Bounds own_bounds(const BodyPlan& plan, const ShapePlan& shape) {
  const Vec3<double>& s = shape.geom.shape.size;
  switch (shape.geom.shape.type) {
    case ShapeType::kSphere:
      return {{-s.x, -s.x, -s.x}, {s.x, s.x, s.x}};
    case ShapeType::kCapsule:
      return {{-s.x, -s.x, -s.y - s.x}, {s.x, s.x, s.y + s.x}};
    case ShapeType::kCylinder:
      return {{-s.x, -s.x, -s.y}, {s.x, s.x, s.y}};
    case ShapeType::kBox:
      return {-s, s};
    default: {
      Bounds b;
      for (const Vec3<float>& p : plan.meshes[shape.geom.shape.mesh.index()].vertices) {
        b.widen(Vec3<double>{p.x, p.y, p.z}, {0, 0, 0});
      }
      return b;
    }
  }
}

/// Of all shapes along the axes of the inertial frame.
Bounds all_bounds(const BodyPlan& plan, const LinkPlan& link, bool lies_alone) {
  Bounds all;
  for (const ShapePlan& shape : link.collisions) {
    const double more = reach_beyond(shape, lies_alone, plan.from_file);
    const Bounds own = own_bounds(plan, shape);
    const Transform<double> X_IG = inverse(link.X_LI) * shape.geom.X_LG;
    const Vec3<double> half = own.half() + Vec3<double>{more, more, more};
    if (shape.geom.shape.type == ShapeType::kSphere) {
      all.widen(X_IG.p, half);
    } else {
      all.widen(X_IG, own.centre(), half);
    }
  }
  return all;
}

/// Whether PyBullet needs no compound around the shape: not where anything is turned, even if both alike.
bool is_centred(const LinkPlan& link, const ShapePlan& shape) {
  const Vec3<double> off = shape.geom.X_LG.p - link.X_LI.p;
  const auto unturned = [](const Mat3<double>& R) { return R.x.x == 1 && R.y.y == 1 && R.z.z == 1; };
  return off.x == 0 && off.y == 0 && off.z == 0 && unturned(shape.geom.X_LG.R) && unturned(link.X_LI.R);
}

}  // namespace

bool stands_for_link(const LinkPlan& link) {
  return link.collisions.size() == 1 && is_centred(link, link.collisions.front());
}

namespace {

/// Without the link's factor.
Vec3<double> plain_inertia(const BodyPlan& plan, const LinkPlan& link, double mass) {
  if (link.collisions.empty()) {
    constexpr double kCube = 6.67e-7;  // of 2 mm, for 1 kg
    return plan.from_file ? Vec3<double>{kCube * mass, kCube * mass, kCube * mass} : Vec3<double>::zero();
  }
  if (std::ranges::any_of(link.collisions, &ShapePlan::is_ground)) return Vec3<double>::zero();
  const ShapePlan& first = link.collisions.front();
  const Vec3<double>& s = first.geom.shape.size;
  const bool lies_alone = stands_for_link(link);
  if (lies_alone) {
    if (first.geom.shape.type == ShapeType::kSphere) {
      const double I = 0.4 * mass * s.x * s.x;
      return {I, I, I};
    }
    if (first.geom.shape.type == ShapeType::kCylinder && !first.is_urdf_cylinder) {
      const double across = mass / 12 * (3 * s.x * s.x + 4 * s.y * s.y);
      return {across, across, 0.5 * mass * s.x * s.x};
    }
  }
  return box_inertia(mass, all_bounds(plan, link, lies_alone).half());
}

}  // namespace

Vec3<double> inertia_of_shapes(const BodyPlan& plan, const LinkPlan& link, double mass) {
  return link.inertia_scale * plain_inertia(plan, link, mass);
}

void set_inertias(BodyPlan& plan, bool use_file) {
  for (int i = -1; i < plan.num_links(); ++i) {
    LinkPlan& link = plan.link(i);
    if (use_file && link.has_file_inertia) {
      const Mat3<double>& R = link.X_LI.R;
      const Mat3<double> back{{R.x.x, R.y.x, R.z.x}, {R.x.y, R.y.y, R.z.y}, {R.x.z, R.y.z, R.z.z}};
      const SymMat3<double> I = rotated(back, link.file_inertia);
      if (std::abs(I.xy) + std::abs(I.xz) + std::abs(I.yz) < 1e-12 * (I.xx + I.yy + I.zz)) {
        link.inertia = {I.xx, I.yy, I.zz};
        continue;
      }
      const PrincipalAxes axes = principal_axes(I);
      link.X_LI.R = R * axes.R;
      link.inertia = axes.moments;
    } else {
      link.inertia = inertia_of_shapes(plan, link, link.mass);
    }
  }
}

}  // namespace manyhands::bullet
