#include "manyhands/model/part_checks.h"

#include <algorithm>

namespace manyhands {

std::size_t num_sizes(ShapeType type) {
  switch (type) {
    case ShapeType::kSphere:
      return 1;
    case ShapeType::kCapsule:
    case ShapeType::kCylinder:
      return 2;
    case ShapeType::kBox:
      return 3;
    default:
      return 0;
  }
}

void check_inertial(const std::string& name, const Inertial& inertial) {
  const SymMat3<double>& I = inertial.inertia;
  const bool all_finite =
      finite(inertial.mass) && finite(inertial.com) && finite(I.xx + I.yy + I.zz) && finite(I.xy + I.xz + I.yz);
  if (!all_finite) throw ModelError("link '" + name + "': mass, com and inertia must be finite numbers");
  if (inertial.mass < 0) {
    throw ModelError("link '" + name + "': mass is " + std::to_string(inertial.mass) + " kg; expected 0 or more");
  }
  const double det =
      I.xx * (I.yy * I.zz - I.yz * I.yz) - I.xy * (I.xy * I.zz - I.yz * I.xz) + I.xz * (I.xy * I.yz - I.yy * I.xz);
  const double scale = I.xx + I.yy + I.zz;
  const double minor = std::min({I.xx * I.yy - I.xy * I.xy, I.xx * I.zz - I.xz * I.xz, I.yy * I.zz - I.yz * I.yz});
  const double slack = 1e-9 * scale;
  const bool positive = std::min({I.xx, I.yy, I.zz}) >= 0 && minor >= -slack * scale && det >= -slack * scale * scale;
  if (!positive) throw ModelError("link '" + name + "': the inertia matrix is not positive semi-definite");
}

void check_geom(const Geom& geom) {
  const std::string what = "geom '" + geom.name + "'";
  const std::array sizes{geom.shape.size.x, geom.shape.size.y, geom.shape.size.z};
  for (std::size_t i = 0; i < num_sizes(geom.shape.type); ++i) {
    const bool may_be_zero = geom.shape.type == ShapeType::kCapsule && i == 1;
    if (!finite(sizes[i]) || sizes[i] < 0 || (sizes[i] == 0 && !may_be_zero)) {
      throw ModelError(what + ": a size is " + std::to_string(sizes[i]) + " m; expected a finite number above 0");
    }
  }
  const Transform<double>& X = geom.X_LG;
  if (!finite(X.p) || !finite(X.R.x) || !finite(X.R.y) || !finite(X.R.z)) {
    throw ModelError(what + ": its pose must be finite numbers");
  }
  check_surface(what, geom.surface);
  if (!finite(geom.margin) || geom.margin < 0) throw ModelError(what + ": the margin must be finite, 0 or more");
  if (!geom.texture) return;
  for (const float repeat : geom.texture->repeat) {
    if (!(repeat > 0 && repeat <= kMostRepeats)) {
      throw ModelError(what + ": its texture is repeated " + std::to_string(repeat) +
                       " times; expected more than 0, at most 10000");
    }
  }
}

void check_surface(const std::string& what, const SurfaceMaterial& s) {
  for (const double value : {s.lateral_friction, s.friction_y.value_or(0), s.spinning_friction, s.rolling_friction,
                             s.stiffness.value_or(0), s.damping.value_or(0)}) {
    if (!finite(value) || value < 0) {
      throw ModelError(what + ": frictions, stiffness and damping must be finite, 0 or more");
    }
  }
  check_restitution(what, s.restitution);
  check_compliance(what, s.compliance);
  if (s.compliance && s.stiffness)
    throw ModelError(what + ": its surface has a stiffness and a compliance; expected one of the two");
}

void check_restitution(const std::string& what, double restitution) {
  if (restitution >= 0 && restitution <= 1) return;
  throw ModelError(what + ": restitution is " + std::to_string(restitution) +
                   "; expected 0 to 1, where contact gives back all speed: above, it would make energy");
}

void check_compliance(const std::string& what, const std::optional<Compliance>& compliance) {
  if (!compliance) return;
  const Compliance& c = *compliance;
  for (const double value : {c.stiffness, c.damping, c.width, c.power, c.share}) {
    if (!finite(value) || value < 0)
      throw ModelError(what + ": the numbers of its compliance must be finite, 0 or more");
  }
  for (const double value : {c.impedance, c.largest_impedance, c.midpoint}) {
    if (!(value > 0 && value < 1))
      throw ModelError(what + ": impedances and midpoint of its compliance must lie between 0 and 1");
  }
  if (c.power < 1) throw ModelError(what + ": the power of its compliance must be 1 or more");
}

namespace {

void check_tendon_path(const std::string& what, const Tendon& tendon) {
  if (tendon.joints.empty() == tendon.branches.empty())
    throw ModelError(what + " runs over joints or through points; expected one of them, not both");
  for (const TendonJoint& part : tendon.joints) {
    if (!finite(part.coefficient) || part.coefficient == 0)
      throw ModelError(what + ": a coefficient is " + std::to_string(part.coefficient) + "; expected one other than 0");
  }
  for (const TendonBranch& branch : tendon.branches) {
    if (branch.points.size() < 2) throw ModelError(what + ": a branch needs two points or more");
    if (!finite(branch.divisor) || !(branch.divisor > 0))
      throw ModelError(what + ": a divisor is " + std::to_string(branch.divisor) + "; expected one above 0");
    for (const TendonPoint& point : branch.points) {
      if (!finite(point.p_L)) throw ModelError(what + ": its points must be finite numbers");
    }
  }
}

}  // namespace

void check_tendon(const Tendon& tendon) {
  const std::string what = "tendon '" + tendon.name + "'";
  check_tendon_path(what, tendon);
  for (const double value : {tendon.damping, tendon.friction, tendon.armature, tendon.stiffness}) {
    if (!finite(value) || value < 0)
      throw ModelError(what + ": damping, friction, armature and stiffness must be finite, 0 or more");
  }
  check_compliance(what, tendon.compliance);
  if (!(tendon.lower <= tendon.upper)) throw ModelError(what + ": its lower limit is above the upper one");
  const bool rests = finite(tendon.spring_lower) && finite(tendon.spring_upper);
  if (!rests || tendon.spring_lower > tendon.spring_upper)
    throw ModelError(what + ": its spring rests between two finite lengths, the lesser first");
}

void check_mesh(const Mesh& mesh) {
  const std::string what = "mesh '" + mesh.source + "'";
  for (const Vec3<float>& v : mesh.vertices) {
    if (!is_finite(v.x) || !is_finite(v.y) || !is_finite(v.z)) throw ModelError(what + ": a vertex is not finite");
  }
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    for (const int i : triangle) {
      if (i < 0 || i >= std::ssize(mesh.vertices)) {
        throw ModelError(what + ": a triangle names vertex " + std::to_string(i) + " of " +
                         std::to_string(mesh.vertices.size()));
      }
    }
  }
}

void check_height_field(const HeightField& field) {
  const bool whole =
      field.columns >= 2 && field.rows >= 2 && field.dx > 0 && field.dy > 0 &&
      field.height.size() == static_cast<std::size_t>(field.columns) * static_cast<std::size_t>(field.rows);
  if (!whole) throw ModelError("a height field needs rows x columns heights, 2 x 2 or more, and spacings above 0");
  for (const double height : field.height) {
    if (!finite(height)) throw ModelError("the heights of a height field must be finite numbers");
  }
}

}  // namespace manyhands
