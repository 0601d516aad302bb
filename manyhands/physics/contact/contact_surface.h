// How the materials of two geoms become the numbers of one contact.
#pragma once

#include "manyhands/physics/collision/colliders.h"
#include "manyhands/physics/contact/settings.h"
#include "manyhands/physics/dynamics/yielding.h"

namespace manyhands {

/// A touching surface's numbers, those of its two geoms combined.
template <Number T>
struct CombinedSurface {
  T friction_1, friction_2;  ///< along t_1 and t_2
  Vec3<T> t_1, t_2;
  T restitution, spinning, rolling;
  T radius_A, radius_B;  ///< by which each side is curved at the contact [m]; 0 where it is flat or a corner
  T softness, push;      ///< of a soft surface, see `combine_surfaces`; 0 where it is hard
  std::optional<TreeCompliance<real_t<T>>> compliance;
  real_t<T> mobility;  ///< W of the compliance
};

namespace internal {

template <Number T>
MANYHANDS_INLINE T combined(CombineRule rule, T a, T b) {
  switch (rule) {
    case CombineRule::kProduct:
      return a * b;
    case CombineRule::kGeometricMean:
      return sqrt(a * b);
    case CombineRule::kMaximum:
      return max(a, b);
    default:
      return min(a, b);
  }
}

/// Two unit vectors across the unit vector n (Duff et al. 2017, Building an Orthonormal Basis, Revisited).
template <Number T>
MANYHANDS_INLINE void tangents(const Vec3<T>& n, Vec3<T>& t_1, Vec3<T>& t_2) {
  const T one = constant<T>(1);
  const T sign = copysign(one, n.z);
  const T a = -one / (sign + n.z), b = n.x * n.y * a;
  t_1 = {fma(sign * (n.x * n.x), a, one), sign * b, -(sign * n.x)};
  t_2 = {b, fma(n.y * n.y, a, sign), -n.y};
}

/// t_1 along the axis as far as it lies in the plane; any tangents where it stands on the plane.
template <Number T>
MANYHANDS_INLINE void tangents_along(const Vec3<T>& axis, const Vec3<T>& n, Vec3<T>& t_1, Vec3<T>& t_2) {
  tangents(n, t_1, t_2);
  const Vec3<T> along = fma(-dot(axis, n), n, axis);
  const T length = norm(along);
  const auto flat = length > constant<T>(1e-4);
  const T inverse = constant<T>(1) / select(flat, length, constant<T>(1));
  t_1 = select(flat, inverse * along, t_1);
  t_2 = select(flat, cross(n, t_1), t_2);
}

/// The radius of a round side at a contact with the given normal; 0 of flat sides and corners.
template <Number T>
MANYHANDS_INLINE T curvature_radius(const Collider<real_t<T>>& geom, const Vec3<T>& size, const Vec3<T>& normal,
                                    const Transform<T>& X_WG) {
  const T zero = constant<T>(0);
  switch (geom.type) {
    case ShapeType::kSphere:
    case ShapeType::kCapsule:
      return size.x;
    case ShapeType::kCylinder:
      return select(abs(dot(normal, X_WG.R.z)) < constant<T>(0.5), size.x, zero);
    default:
      return zero;
  }
}

/// The stiffness of two soft surfaces in a row; of one alone if the other is hard.
[[nodiscard]] inline std::optional<double> in_series(std::optional<double> a, std::optional<double> b) {
  if (!a || !b) return a ? a : b;
  return *a * *b / (*a + *b);
}

template <Real R>
[[gnu::noinline]] std::optional<TreeCompliance<R>> compliance_between(const Collider<R>& a, const Collider<R>& b) {
  const std::optional<Compliance> both = between(a.surface.compliance, b.surface.compliance);
  return both ? std::optional(tree_compliance<R>(*both)) : std::nullopt;
}

}  // namespace internal

/// The combined surface of a pair whose contact has the given normal. A soft surface's force k (-phi) - d u, implicit
/// in the velocity u, is the law u_n + softness n = target with softness = 1 / (h (h k + d)), target = -push phi.
template <Number T, Number P>
MANYHANDS_INLINE CombinedSurface<T> combine_surfaces(const Colliders<real_t<T>>& colliders, const ColliderPair& pair,
                                                     const Params<P>& params, real_t<T> h, const Vec3<T>& normal,
                                                     const std::vector<Transform<T>>& X_WG) {
  const Collider<real_t<T>>&a = colliders.geoms[pair.a], &b = colliders.geoms[pair.b];
  CombinedSurface<T> surface;
  std::optional<double> stiffness, damping;
  if (pair.surface >= 0) {
    const SurfaceMaterial& own = colliders.surfaces[static_cast<std::size_t>(pair.surface)];
    const auto number = [](double value) { return constant<T>(value); };
    surface.friction_1 = number(own.lateral_friction);
    surface.friction_2 = number(own.friction_y.value_or(own.lateral_friction));
    surface.restitution = number(own.restitution);
    surface.spinning = number(own.spinning_friction);
    surface.rolling = number(own.rolling_friction);
    stiffness = own.stiffness;
    damping = own.damping;
    if (own.compliance) surface.compliance = tree_compliance<real_t<T>>(*own.compliance);
  } else {
    const auto all = [&](CombineRule rule, const Field<P>& values) {
      return internal::combined(rule, broadcast<T>(values[a.geom]), broadcast<T>(values[b.geom]));
    };
    const bool mixed = a.surface.friction_y.has_value() != b.surface.friction_y.has_value();
    surface.friction_1 = all(colliders.rules.friction, params.geom_friction);
    surface.friction_2 =
        all(colliders.rules.friction, mixed || a.surface.friction_y ? params.geom_friction_y : params.geom_friction);
    surface.restitution = all(colliders.rules.restitution, params.geom_restitution);
    surface.spinning = all(CombineRule::kMaximum, params.geom_spinning);
    surface.rolling = all(CombineRule::kMaximum, params.geom_rolling);
    stiffness = internal::in_series(a.surface.stiffness, b.surface.stiffness);
    damping = internal::in_series(a.surface.damping, b.surface.damping);
    if (a.yields || b.yields) surface.compliance = internal::compliance_between(a, b);
  }
  if (a.surface.friction_y || b.surface.friction_y) {
    internal::tangents_along(X_WG[a.surface.friction_y ? pair.a : pair.b].R.x, normal, surface.t_1, surface.t_2);
  } else {
    internal::tangents(normal, surface.t_1, surface.t_2);
  }
  surface.radius_A = internal::curvature_radius(a, broadcast<T>(params.geom_size[a.geom]), normal, X_WG[pair.a]);
  surface.radius_B = internal::curvature_radius(b, broadcast<T>(params.geom_size[b.geom]), normal, X_WG[pair.b]);
  surface.softness = surface.push = constant<T>(0);
  surface.mobility = a.mobility + b.mobility;
  if (stiffness) {
    const double softness = 1 / (h * (h * *stiffness + damping.value_or(0)));
    surface.softness = constant<T>(softness);
    surface.push = constant<T>(softness * h * *stiffness);
  }
  for (T* friction : {&surface.friction_1, &surface.friction_2, &surface.spinning, &surface.rolling}) {
    *friction = select(*friction < constant<T>(contact_settings::kLeastFriction), constant<T>(0), *friction);
  }
  return surface;
}

}  // namespace manyhands
