#include "manyhands/physics/collision/colliders.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace manyhands {

namespace {

/// How many manifolds two shapes need: a triangulated surface may touch on several sides.
std::size_t manifolds_of(ShapeType a, ShapeType b) {
  const auto surface = [](ShapeType type) { return type == ShapeType::kMesh || type == ShapeType::kHeightField; };
  return surface(a) || surface(b) ? 4 : 1;
}

/// Shapes with a volume first, then the surfaces of the world.
int rank(ShapeType type) {
  switch (type) {
    case ShapeType::kConvex:
      return 4;
    case ShapeType::kPlane:
      return 5;
    case ShapeType::kMesh:
      return 6;
    default:
      return static_cast<int>(type);
  }
}

/// What a shape needs beyond its size.
template <Real R>
void add_surface(const Model& model, const Geom& geom, Collider<R>& collider) {
  if (collider.type == ShapeType::kMesh && collider.body != 0) collider.type = ShapeType::kConvex;
  if (collider.type == ShapeType::kConvex) {
    collider.hull = std::make_shared<ConvexPolyhedron>(
        convex_polyhedron(std::span<const Vec3<float>>(model.meshes()[geom.shape.mesh.index()].vertices)));
    collider.radius = static_cast<R>(collider.hull->bound);
  } else if (collider.type == ShapeType::kMesh) {
    collider.mesh = std::make_shared<TriangleMesh>(model.meshes()[geom.shape.mesh.index()]);
    collider.radius = static_cast<R>(collider.mesh->bound());
  } else if (collider.type == ShapeType::kHeightField) {
    const HeightField& field = model.height_fields()[geom.shape.height_field.index()];
    collider.height_field = std::make_shared<HeightField>(field);
    double highest = 0;
    for (const double z : field.height) highest = std::max(highest, std::abs(z));
    collider.radius =
        static_cast<R>(norm(Vec3<double>{field.columns * field.dx / 2, field.rows * field.dy / 2, highest}));
  }
}

bool is_excluded(const Model& model, LinkId a, LinkId b) {
  return std::ranges::any_of(
      model.exclusions(), [&](const ContactExclusion& e) { return (e.a == a && e.b == b) || (e.a == b && e.b == a); });
}

/// The body that hangs on the world and carries `body`.
BodyId root_of(const Model& model, BodyId body) {
  while (model.body(body).parent.value() > 0) body = model.body(body).parent;
  return body;
}

bool resists_turning(const SurfaceMaterial& surface) {
  return surface.spinning_friction > 0 || surface.rolling_friction > 0;
}

}  // namespace

bool may_touch(const Model& model, const Geom& a, const Geom& b) {
  const BodyId body_a = model.link(a.link).body, body_b = model.link(b.link).body;
  if (body_a == body_b) return false;
  if ((a.filter.group & b.filter.mask) == 0 || (b.filter.group & a.filter.mask) == 0) return false;
  if (is_excluded(model, a.link, b.link)) return false;
  if (body_a.value() == 0 || body_b.value() == 0) {
    // A robot's first moving link rests against the base that it is mounted on.
    const LinkId moving = body_a.value() == 0 ? b.link : a.link, fixed = body_a.value() == 0 ? a.link : b.link;
    const Body& body = model.body(model.link(moving).body);
    return body.parent.value() != 0 || fixed.value() == 0 || body.type == JointType::kFloating ||
           model.joint(body.joint).parent != fixed;
  }
  if (model.body(body_a).parent == body_b || model.body(body_b).parent == body_a) return false;
  return model.contact_rules().self_collision || root_of(model, body_a) != root_of(model, body_b);
}

template <Real R>
Colliders<R>::Colliders(const Model& model) : rules(model.contact_rules()) {
  std::vector<int> collider_of(model.geoms().size(), -1);
  for (std::size_t i = 0; i < model.geoms().size(); ++i) {
    const Geom& geom = model.geoms()[i];
    if (geom.role != GeomRole::kCollision) continue;
    const Link& link = model.link(geom.link);
    const Transform<double> X_BG = link.X_BL * geom.X_LG;
    const Mat3<double>& m = X_BG.R;
    const bool turned = geom.shape.type != ShapeType::kSphere && (m.x.x < 1 || m.y.y < 1 || m.z.z < 1);
    collider_of[i] = static_cast<int>(geoms.size());
    Collider<R>& collider = geoms.emplace_back();
    collider.type = geom.shape.type;
    collider.geom = i;
    collider.body = link.body.index();
    collider.turned = turned;
    collider.X_BG = broadcast<R>(X_BG);
    collider.surface = geom.surface;
    collider.margin = static_cast<R>(geom.margin);
    add_surface(model, geom, collider);
  }
  const auto add = [&](std::size_t a, std::size_t b, int surface) {
    if (rank(geoms[a].type) > rank(geoms[b].type)) std::swap(a, b);
    const bool torsion = surface >= 0 ? resists_turning(surfaces[static_cast<std::size_t>(surface)])
                                      : resists_turning(geoms[a].surface) || resists_turning(geoms[b].surface);
    pairs.push_back({.a = a,
                     .b = b,
                     .manifolds = manifolds_of(geoms[a].type, geoms[b].type),
                     .torsion = torsion,
                     .surface = surface});
  };
  const auto is_explicit = [&](std::size_t a, std::size_t b) {
    return std::ranges::any_of(model.contact_pairs(), [&](const ContactPair& pair) {
      return (pair.a.index() == a && pair.b.index() == b) || (pair.a.index() == b && pair.b.index() == a);
    });
  };
  for (std::size_t a = 0; a < geoms.size(); ++a) {
    for (std::size_t b = a + 1; b < geoms.size(); ++b) {
      if (is_explicit(geoms[a].geom, geoms[b].geom)) continue;
      if (may_touch(model, model.geoms()[geoms[a].geom], model.geoms()[geoms[b].geom])) add(a, b, -1);
    }
  }
  for (const ContactPair& pair : model.contact_pairs()) {
    const int a = collider_of[pair.a.index()], b = collider_of[pair.b.index()];
    if (a < 0 || b < 0) continue;
    if (pair.surface) surfaces.push_back(*pair.surface);
    add(static_cast<std::size_t>(a), static_cast<std::size_t>(b),
        pair.surface ? static_cast<int>(surfaces.size()) - 1 : -1);
  }
  std::ranges::stable_sort(pairs, [&](const ColliderPair& x, const ColliderPair& y) {
    return std::tuple(rank(geoms[x.a].type), rank(geoms[x.b].type)) <
           std::tuple(rank(geoms[y.a].type), rank(geoms[y.b].type));
  });
  for (ColliderPair& pair : pairs) {
    pair.manifold = num_manifolds;
    num_manifolds += pair.manifolds;
  }
}

template struct Colliders<double>;
template struct Colliders<float>;

}  // namespace manyhands
