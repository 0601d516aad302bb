#include "manyhands/model/solids.h"

#include <cmath>
#include <numbers>

namespace manyhands {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLeastVolume = 1e-30;  // [m^3]: below it a mesh is flat

Inertial principal(double mass, double xx, double yy, double zz) {
  return {mass, Vec3<double>::zero(), {xx, yy, zz, 0, 0, 0}};
}

/// About a point at offset d from the centre of mass, less what is about the centre: m (d.d 1 - d d^T).
SymMat3<double> parallel_axes(double mass, const Vec3<double>& d) {
  return {mass * (d.y * d.y + d.z * d.z),
          mass * (d.x * d.x + d.z * d.z),
          mass * (d.x * d.x + d.y * d.y),
          -mass * d.x * d.y,
          -mass * d.x * d.z,
          -mass * d.y * d.z};
}

SymMat3<double> times(double s, const SymMat3<double>& m) {
  return {s * m.xx, s * m.yy, s * m.zz, s * m.xy, s * m.xz, s * m.yz};
}

/// A cylinder between two half spheres.
Inertial solid_capsule(double r, double half) {
  const double length = 2 * half;
  const double ball = 4.0 / 3 * kPi * r * r * r, tube = kPi * r * r * length;
  const double across =
      tube * (3 * r * r + length * length) / 12 + ball * (0.4 * r * r + length * length / 4 + 3.0 / 8 * length * r);
  return principal(ball + tube, across, across, tube * r * r / 2 + ball * 0.4 * r * r);
}

struct Triangle {
  Vec3<double> a, b, c;
  [[nodiscard]] Vec3<double> centre() const { return (1.0 / 3) * (a + b + c); }
  [[nodiscard]] Vec3<double> normal_area() const {
    return 0.5 * cross(b - a, c - a);
  }  ///< outwards, as long as the area
};

template <class Visit>
void for_each_triangle(const Mesh& mesh, const AffineMap& place, const Vec3<double>& origin, Visit visit) {
  const auto vertex = [&](int i) {
    const Vec3<float>& v = mesh.vertices[static_cast<std::size_t>(i)];
    return place * Vec3<double>{v.x, v.y, v.z} - origin;
  };
  const std::size_t second = place.mirrors() ? 2 : 1;
  for (const auto& t : mesh.triangles) visit(Triangle{vertex(t[0]), vertex(t[second]), vertex(t[3 - second])});
}

Vec3<double> middle_of_faces(const Mesh& mesh, const AffineMap& place) {
  Vec3<double> sum = Vec3<double>::zero();
  double area = 0;
  for_each_triangle(mesh, place, Vec3<double>::zero(), [&](const Triangle& t) {
    const double a = norm(t.normal_area());
    sum = sum + a * t.centre();
    area += a;
  });
  return area > 0 ? (1 / area) * sum : sum;
}

/// The second moments of mass, sum of m p p^T, as an inertia.
SymMat3<double> inertia_of_moments(const SymMat3<double>& P) {
  return {P.yy + P.zz, P.xx + P.zz, P.xx + P.yy, -P.xy, -P.xz, -P.yz};
}

SymMat3<double> outer(const Vec3<double>& u) {
  return {u.x * u.x, u.y * u.y, u.z * u.z, u.x * u.y, u.x * u.z, u.y * u.z};
}

}  // namespace

Inertial solid_of(const Shape& shape) {
  const Vec3<double>& s = shape.size;
  switch (shape.type) {
    case ShapeType::kSphere:
      return solid_ellipsoid({s.x, s.x, s.x});
    case ShapeType::kCapsule:
      return solid_capsule(s.x, s.y);
    case ShapeType::kCylinder: {
      const double m = 2 * kPi * s.x * s.x * s.y, across = m * (3 * s.x * s.x + 4 * s.y * s.y) / 12;
      return principal(m, across, across, m * s.x * s.x / 2);
    }
    case ShapeType::kBox: {
      const double m = 8 * s.x * s.y * s.z;
      return principal(m, m * (s.y * s.y + s.z * s.z) / 3, m * (s.x * s.x + s.z * s.z) / 3,
                       m * (s.x * s.x + s.y * s.y) / 3);
    }
    default:
      return {};
  }
}

Inertial skin_of(const Shape& shape) {
  const Vec3<double>& s = shape.size;
  const double r = s.x, half = s.y, tube = 4 * kPi * r * half;
  switch (shape.type) {
    case ShapeType::kSphere: {
      const double m = 4 * kPi * r * r, about = 2.0 / 3 * m * r * r;
      return principal(m, about, about, about);
    }
    case ShapeType::kCapsule: {
      const double ball = 4 * kPi * r * r;  // of its two halves each has its middle r / 2 beyond the tube's end
      const double across = tube * (r * r / 2 + half * half / 3) + ball * (2.0 / 3 * r * r + half * r + half * half);
      return principal(tube + ball, across, across, tube * r * r + ball * 2.0 / 3 * r * r);
    }
    case ShapeType::kCylinder: {
      const double ends = 2 * kPi * r * r;
      const double across = tube * (r * r / 2 + half * half / 3) + ends * (r * r / 4 + half * half);
      return principal(tube + ends, across, across, tube * r * r + ends * r * r / 2);
    }
    case ShapeType::kBox: {
      const Vec3<double> faces{8 * s.y * s.z, 8 * s.x * s.z, 8 * s.x * s.y};
      const double m = faces.x + faces.y + faces.z;
      const auto second_moment = [&](double extent, double ends) { return extent * extent * (m + 2 * ends) / 3; };
      const double xx = second_moment(s.x, faces.x), yy = second_moment(s.y, faces.y), zz = second_moment(s.z, faces.z);
      return principal(m, yy + zz, xx + zz, xx + yy);
    }
    default:
      return {};
  }
}

Inertial skin_of_ellipsoid(const Vec3<double>& s) {
  constexpr double kThomsen = 1.6075, kLayer = 1e-6;
  const auto product = [](double a, double b) { return std::pow(a * b, kThomsen); };
  const double mean = (product(s.x, s.y) + product(s.y, s.z) + product(s.z, s.x)) / 3;
  const double area = 4 * kPi * std::pow(mean, 1 / kThomsen);
  const Inertial inside = solid_ellipsoid(s), whole = solid_ellipsoid(s + Vec3<double>{kLayer, kLayer, kLayer});
  const double factor = area / (whole.mass - inside.mass);
  return {area, Vec3<double>::zero(), times(factor, whole.inertia + times(-1, inside.inertia))};
}

Inertial solid_ellipsoid(const Vec3<double>& s) {
  const double m = 4.0 / 3 * kPi * s.x * s.y * s.z;
  return principal(m, m * (s.y * s.y + s.z * s.z) / 5, m * (s.x * s.x + s.z * s.z) / 5,
                   m * (s.x * s.x + s.y * s.y) / 5);
}

Inertial solid_of(const Mesh& mesh, bool legacy, const AffineMap& place) {
  const auto pyramid = [&](const Triangle& t) {
    const double v = dot(t.a, cross(t.b, t.c)) / 6;
    return legacy ? abs(v) : v;
  };
  const Vec3<double> tip = middle_of_faces(mesh, place);
  double first_volume = 0;
  Vec3<double> moment = Vec3<double>::zero();
  for_each_triangle(mesh, place, tip, [&](const Triangle& t) {
    first_volume += pyramid(t);
    moment = moment + (0.75 * pyramid(t)) * t.centre();
  });
  if (!(first_volume > kLeastVolume)) return {};
  const Vec3<double> com = tip + (1 / first_volume) * moment;
  double volume = 0;  // another one in legacy mode, where pyramids overlap
  SymMat3<double> P = SymMat3<double>::zero();
  for_each_triangle(mesh, place, com, [&](const Triangle& t) {
    volume += pyramid(t);
    P = P + times(pyramid(t) / 20, outer(t.a) + outer(t.b) + outer(t.c) + outer(t.a + t.b + t.c));
  });
  return {volume, com, inertia_of_moments(P)};
}

Inertial skin_of(const Mesh& mesh, const AffineMap& place) {
  const Vec3<double> centre = middle_of_faces(mesh, place);
  double area = 0;
  SymMat3<double> P = SymMat3<double>::zero();
  for_each_triangle(mesh, place, centre, [&](const Triangle& t) {
    const double a = norm(t.normal_area());
    area += a;
    P = P + times(a / 12, outer(t.a) + outer(t.b) + outer(t.c) + outer(t.a + t.b + t.c));
  });
  return {area, centre, inertia_of_moments(P)};
}

Inertial scaled(const Inertial& inertial, double factor) {
  return {factor * inertial.mass, inertial.com, times(factor, inertial.inertia)};
}

Inertial placed(const Transform<double>& X, const Inertial& inertial) {
  return {inertial.mass, X * inertial.com, rotated(X.R, inertial.inertia)};
}

Inertial sum(const Inertial& a, const Inertial& b) {
  const double mass = a.mass + b.mass;
  if (!(mass > 0)) return {mass, a.com, a.inertia + b.inertia};
  const Vec3<double> com = (1 / mass) * (a.mass * a.com + b.mass * b.com);
  return {mass, com, a.inertia + parallel_axes(a.mass, a.com - com) + b.inertia + parallel_axes(b.mass, b.com - com)};
}

}  // namespace manyhands
