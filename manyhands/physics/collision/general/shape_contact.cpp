#include "manyhands/physics/collision/general/shape_contact.h"

#include <stdexcept>
#include <string>

#include "manyhands/model/model_builder.h"
#include "manyhands/physics/collision/collide_pair.h"

namespace manyhands {
namespace {

/// A shape as the only geom of a body of its own.
template <Real R>
Collider<R> alone(const CollisionShape& shape, std::size_t index) {
  Collider<R> geom;
  geom.type = shape.type();
  geom.geom = index;
  geom.body = geom.root = index + 1;
  geom.turned = true;
  geom.hull = shape.hull();
  geom.mesh = shape.triangles();
  geom.height_field = shape.field();
  return geom;
}

}  // namespace

template <Real R>
ShapeContact<R> shape_contact(const CollisionShape& a, const Transform<R>& X_WA, const CollisionShape& b,
                              const Transform<R>& X_WB, R margin) {
  if (!(margin >= 0) || !is_finite(margin)) {
    throw std::invalid_argument("margin is " + std::to_string(margin) + " m; expected a finite number of 0 or more");
  }
  if (!a.view().is_convex_body() && !b.view().is_convex_body()) {
    throw std::invalid_argument(
        "contact between two of plane, mesh and height field is not looked for: make one of them a solid, as the "
        "convex hull of a mesh");
  }
  Colliders<R> colliders;
  colliders.geoms = {alone<R>(a, 0), alone<R>(b, 1)};
  const ColliderPair pair = colliders.pair_of(0, 1).value();
  Layout two_geoms;
  two_geoms[Each::kGeom] = 2;
  ParamsStorage<R> params(two_geoms);
  params.geom_size[0] = broadcast<R>(a.size());
  params.geom_size[1] = broadcast<R>(b.size());

  ShapeContact<R> contact;
  contact.size = collide_pair<R>(colliders, pair, params, mask_t<R>(true), margin, {X_WA, X_WB}, contact.manifolds);
  for (std::size_t i = 0; i < contact.size; ++i) {
    Manifold<R>& m = contact.manifolds[i];
    if (pair.a != 0) m = swapped(m);
    for (R& phi : m.phi) {
      if (!(phi <= margin)) phi = std::numeric_limits<R>::infinity();
    }
  }
  return contact;
}

template ShapeContact<double> shape_contact(const CollisionShape&, const Transform<double>&, const CollisionShape&,
                                            const Transform<double>&, double);
template ShapeContact<float> shape_contact(const CollisionShape&, const Transform<float>&, const CollisionShape&,
                                           const Transform<float>&, float);

}  // namespace manyhands
