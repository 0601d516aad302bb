#include "manyhands/physics/collision/colliders.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "manyhands/physics/dynamics/start_mobility.h"

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
    Bounds box;
    for (const Vec3<double>& p : collider.hull->vertices) box.include(p);
    collider.centre = broadcast<R>(0.5 * (box.low + box.high));
    collider.half = broadcast<R>(0.5 * (box.high - box.low));
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

/// The two in either order as one number.
std::uint64_t unordered(std::size_t a, std::size_t b) {
  return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | static_cast<std::uint64_t>(std::max(a, b));
}

/// Where the geom's body stands in its tree: what the rules of self-collision ask.
template <Real R>
void add_place(const Model& model, Collider<R>& collider) {
  const Body& body = model.bodies()[collider.body];
  collider.root = model.root_link(LinkId(static_cast<int>(collider.link))).index();
  collider.is_still = collider.body == 0;
  if (collider.body == 0) return;
  collider.is_still = body.type == JointType::kMocap;
  collider.neighbour = body.parent.index();
  if (body.type != JointType::kFloating) collider.base = model.joint(body.joint).parent.index();
}

bool resists_turning(const SurfaceMaterial& surface) {
  return surface.spinning_friction > 0 || surface.rolling_friction > 0;
}

/// Fills in Collider::mobility if any surface gives way.
template <Real R>
void add_mobility(const Model& model, const std::vector<SurfaceMaterial>& of_pairs, std::vector<Collider<R>>& geoms) {
  const auto yields = [](const SurfaceMaterial& surface) { return surface.compliance.has_value(); };
  if (std::ranges::none_of(of_pairs, yields) && std::ranges::none_of(geoms, &Collider<R>::yields)) return;
  const StartMobility start(model);
  for (Collider<R>& collider : geoms)
    collider.mobility = static_cast<R>(start.of_link(LinkId(static_cast<int>(collider.link))).linear);
}

}  // namespace

/// Filters, exclusions, one body, joint neighbours, self-collision.
template <Real R>
bool Colliders<R>::may_touch(std::size_t i, std::size_t j) const {
  const Collider<R>&a = geoms[i], &b = geoms[j];
  if (a.body == b.body) return false;
  if ((a.filter.group & b.filter.mask) == 0 || (b.filter.group & a.filter.mask) == 0) return false;
  if (!excluded_.empty() && std::ranges::binary_search(excluded_, unordered(a.link, b.link))) return false;
  if (!rules.self_collision && a.root == b.root) return false;
  if (a.body == 0 || b.body == 0) {
    // A robot's first moving link rests against the base that it is mounted on.
    const Collider<R>&moving = a.body == 0 ? b : a, &fixed = a.body == 0 ? a : b;
    return fixed.link == 0 || moving.neighbour != 0 || moving.base != fixed.link;
  }
  return a.is_still || b.is_still || (a.neighbour != b.body && b.neighbour != a.body);
}

template <Real R>
std::optional<ColliderPair> Colliders<R>::pair_of(std::size_t a, std::size_t b) const {
  if (!rules.contacts || (geoms[a].is_still && geoms[b].is_still)) return std::nullopt;
  int surface = -1;
  const std::uint64_t key = unordered(a, b);
  const auto own = std::ranges::lower_bound(explicit_, key, {}, &std::pair<std::uint64_t, int>::first);
  if (own != explicit_.end() && own->first == key) {
    surface = own->second;
  } else if (!may_touch(a, b)) {
    return std::nullopt;
  }
  if (rank(geoms[a].type) > rank(geoms[b].type)) std::swap(a, b);
  const bool torsion = surface >= 0 ? resists_turning(surfaces[static_cast<std::size_t>(surface)])
                                    : resists_turning(geoms[a].surface) || resists_turning(geoms[b].surface);
  return ColliderPair{
      .a = a, .b = b, .manifolds = manifolds_of(geoms[a].type, geoms[b].type), .torsion = torsion, .surface = surface};
}

template <Real R>
Colliders<R>::Colliders(const Model& model, PairSearch pair_search)
    : collider_of(model.geoms().size(), -1), rules(model.contact_rules()) {
  for (std::size_t i = 0; i < model.geoms().size(); ++i) {
    const Geom& geom = model.geoms()[i];
    if (geom.role != GeomRole::kCollision) continue;
    const Link& link = model.link(geom.link);
    const Transform<double> X_BG = link.X_BL * geom.X_LG;
    const Mat3<double>& m = X_BG.R;
    collider_of[i] = static_cast<int>(geoms.size());
    Collider<R>& collider = geoms.emplace_back();
    collider.type = geom.shape.type;
    collider.geom = i;
    collider.link = geom.link.index();
    collider.body = link.body.index();
    collider.filter = geom.filter;
    collider.turned = geom.shape.type != ShapeType::kSphere && (m.x.x < 1 || m.y.y < 1 || m.z.z < 1);
    collider.X_BG = broadcast<R>(X_BG);
    collider.offset = static_cast<R>(norm(X_BG.p));
    collider.surface = geom.surface;
    collider.yields = gives_way(geom.surface.compliance);
    collider.margin = static_cast<R>(geom.margin);
    add_place(model, collider);
    add_surface(model, geom, collider);
  }
  for (const ContactExclusion& e : model.exclusions()) excluded_.push_back(unordered(e.a.index(), e.b.index()));
  std::ranges::sort(excluded_);
  for (const ContactPair& pair : model.contact_pairs()) {
    const int a = collider_of[pair.a.index()], b = collider_of[pair.b.index()];
    if (a < 0 || b < 0) continue;
    if (pair.surface) surfaces.push_back(*pair.surface);
    explicit_.emplace_back(unordered(static_cast<std::size_t>(a), static_cast<std::size_t>(b)),
                           pair.surface ? static_cast<int>(surfaces.size()) - 1 : -1);
  }
  std::ranges::sort(explicit_);
  add_mobility(model, surfaces, geoms);
  list_pairs(pair_search);
}

template <Real R>
void Colliders<R>::list_pairs(PairSearch pair_search) {
  search = pair_search;
  pairs.clear();
  num_manifolds = 0;
  if (search == PairSearch::kSwept) return;
  for (std::size_t a = 0; a < geoms.size(); ++a) {
    for (std::size_t b = a + 1; b < geoms.size(); ++b) {
      if (const std::optional<ColliderPair> pair = pair_of(a, b)) pairs.push_back(*pair);
    }
  }
  std::ranges::stable_sort(pairs, {}, [&](const ColliderPair& pair) {
    return std::pair(rank(geoms[pair.a].type), rank(geoms[pair.b].type));
  });
  for (ColliderPair& pair : pairs) {
    pair.manifold = num_manifolds;
    num_manifolds += pair.manifolds;
  }
}

template <Real R>
void Colliders<R>::insert(const Colliders& part, const Insertion& at, const Model& model) {
  const int first = static_cast<int>(geoms.size());
  const auto new_link = [&](std::size_t link) { return static_cast<std::size_t>(at.new_link(static_cast<int>(link))); };
  const auto new_body = [&](std::size_t body) { return static_cast<std::size_t>(at.new_body(static_cast<int>(body))); };
  const int end = at.bodies.shifts() ? at.bodies.of_old(at.bodies.old_size) : 0;
  for (int b = at.bodies.of_old(at.bodies.old_first); b < end; ++b) {
    for (const LinkId link : model.links_of(BodyId(b))) {
      for (const GeomId geom : model.geoms_of(link)) {
        const int i = geom.value() < at.geoms ? collider_of[geom.index()] : -1;
        if (i < 0) continue;
        Collider<R>& collider = geoms[static_cast<std::size_t>(i)];
        collider.body = static_cast<std::size_t>(b);
        collider.neighbour = model.body(BodyId(b)).parent.index();
      }
    }
  }
  for (Collider<R> collider : part.geoms) {
    collider.geom += static_cast<std::size_t>(at.geoms);
    collider.link = new_link(collider.link);
    collider.root = new_link(collider.root);
    collider.base = new_link(collider.base);
    collider.body = new_body(collider.body);
    collider.neighbour = new_body(collider.neighbour);
    geoms.push_back(std::move(collider));
  }
  for (const int i : part.collider_of) collider_of.push_back(i < 0 ? -1 : first + i);
  const auto add_sorted = [](auto& list, auto item) { list.insert(std::ranges::upper_bound(list, item), item); };
  for (const std::uint64_t key : part.excluded_) {
    add_sorted(excluded_, unordered(new_link(key >> 32), new_link(key & 0xffffffff)));
  }
  for (const auto& [key, surface] : part.explicit_) {
    const auto offset = static_cast<std::size_t>(first);
    add_sorted(explicit_, std::pair(unordered((key >> 32) + offset, (key & 0xffffffff) + offset),
                                    surface < 0 ? -1 : static_cast<int>(surfaces.size()) + surface));
  }
  surfaces.insert(surfaces.end(), part.surfaces.begin(), part.surfaces.end());
  add_mobility(model, surfaces, geoms);
}

template <Real R>
void Colliders<R>::set_excluded(LinkId a, LinkId b, bool excluded) {
  const std::uint64_t key = unordered(a.index(), b.index());
  const auto found = std::ranges::equal_range(excluded_, key);
  if (!excluded) {
    excluded_.erase(found.begin(), found.end());
  } else if (found.empty()) {
    excluded_.insert(found.begin(), key);
  }
}

template struct Colliders<double>;
template struct Colliders<float>;

}  // namespace manyhands
