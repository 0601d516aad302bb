#include "manyhands/physics/collision/general/collide_convex.h"

#include <limits>

#include "manyhands/physics/collision/general/epa.h"
#include "manyhands/physics/collision/general/manifold_points.h"

namespace manyhands {
namespace {

using Vec = Vec3<double>;

SupportingFeature moved(SupportingFeature f, const Transform<double>& X) {
  for (std::size_t i = 0; i < f.size; ++i) f.corner[i] = X * f.corner[i];
  f.normal = X.R * f.normal;
  return f;
}

/// Puts the contact exactly on the normal of a face it rests on, if that is the same contact but for rounding and the
/// last step of an iteration.
void settle(const CorePair& pair, const Vec& normal, double radii, ShapeDistance<double>& contact) {
  constexpr double kCosine = 1 - 1e-7, kSame = 1e-9;
  if (!(dot(normal, contact.normal_AB) > kCosine)) return;
  const double phi = -dot(normal, minkowski_support(pair, normal).w) - radii;
  if (std::abs(phi - contact.phi) > kSame * pair.scale()) return;
  contact.normal_AB = normal;
  contact.phi = phi;
}

Transform<double> relative(const Transform<double>& X_WA, const Transform<double>& X_WB) {
  return {transpose(X_WA.R) * X_WB.R, transpose_times(X_WA.R, X_WB.p - X_WA.p)};
}

}  // namespace

ShapeDistance<double> core_distance(const ConvexShape& a, const ConvexShape& b, const Transform<double>& X_AB,
                                    double far) {
  const CorePair pair{a, b, X_AB};
  const double radii = a.radius + b.radius;
  const GjkResult near = gjk(pair, far + radii);
  double between = near.distance;
  Vec normal = near.normal, on_a = near.a;
  if (near.overlap) {
    const Penetration deep = epa(pair, near);
    between = -deep.depth;
    normal = deep.normal;
    on_a = deep.a;
  }
  const double phi = between - radii;
  const Vec p_A = fma(a.radius, normal, on_a);
  return {phi, p_A, fma(phi, normal, p_A), normal};
}

Manifold<double> contact_manifold(const ConvexShape& a, const ConvexShape& b, const Transform<double>& X_AB,
                                  const ShapeDistance<double>& contact, double margin, bool clip_only) {
  const CorePair pair{a, b, X_AB};
  ShapeDistance<double> c = contact;
  const double radii = a.radius + b.radius;
  const SupportingFeature on_a = supporting_feature(a, c.normal_AB);
  const SupportingFeature on_b = moved(supporting_feature(b, -transpose_times(X_AB.R, c.normal_AB)), X_AB);
  if (on_a.size > 2) settle(pair, on_a.normal, radii, c);
  if (on_b.size > 2) settle(pair, -on_b.normal, radii, c);

  const ManifoldPoints corners = clip_features(on_a, on_b, c.normal_AB, a.radius, b.radius);
  ManifoldPoints kept;
  double deepest = std::numeric_limits<double>::infinity();
  for (const ManifoldPoint& p : corners.all()) {
    deepest = min(deepest, p.phi);
    if (p.phi <= margin) kept.add(p);
  }
  const bool missed = deepest > c.phi + 1e-6 * pair.scale();
  if (!clip_only && missed && c.phi <= margin) kept.add({fma(0.5 * c.phi, c.normal_AB, c.p_A), c.phi});
  return choose_points(kept.all(), c.normal_AB);
}

template <Real R>
ShapeDistance<R> convex_distance(const ConvexShape& a, const Transform<R>& X_WA, const ConvexShape& b,
                                 const Transform<R>& X_WB) {
  const auto X_A = broadcast<double>(X_WA), X_B = broadcast<double>(X_WB);
  const auto d = core_distance(a, b, relative(X_A, X_B), std::numeric_limits<double>::infinity());
  return {static_cast<R>(d.phi), broadcast<R>(X_A * d.p_A), broadcast<R>(X_A * d.p_B),
          broadcast<R>(X_A.R * d.normal_AB)};
}

template <Real R>
Manifold<R> collide_convex(const ConvexShape& a, const Transform<R>& X_WA, const ConvexShape& b,
                           const Transform<R>& X_WB, R margin) {
  const auto X_A = broadcast<double>(X_WA);
  const Transform<double> X_AB = relative(X_A, broadcast<double>(X_WB));
  const auto far = static_cast<double>(margin);
  const ShapeDistance<double> contact = core_distance(a, b, X_AB, far);
  if (!(contact.phi <= far)) return {};
  return posed<R>(X_A, contact_manifold(a, b, X_AB, contact, far, false));
}

#define MANYHANDS_INSTANTIATE(R)                                                                         \
  template ShapeDistance<R> convex_distance(const ConvexShape&, const Transform<R>&, const ConvexShape&, \
                                            const Transform<R>&);                                        \
  template Manifold<R> collide_convex(const ConvexShape&, const Transform<R>&, const ConvexShape&,       \
                                      const Transform<R>&, R);
MANYHANDS_INSTANTIATE(double)
MANYHANDS_INSTANTIATE(float)
#undef MANYHANDS_INSTANTIATE

}  // namespace manyhands
