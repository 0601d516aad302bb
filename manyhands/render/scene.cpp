#include "manyhands/render/scene.h"

#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "manyhands/model/convex_polyhedron.h"
#include "manyhands/render/triangles.h"

namespace manyhands {

namespace {

bool is_simple(ShapeType type) {
  return type != ShapeType::kMesh && type != ShapeType::kConvex && type != ShapeType::kHeightField;
}

Vec3<float> half_extents(ShapeType type, const Vec3<float>& size) {
  switch (type) {
    case ShapeType::kSphere:
      return {size.x, size.x, size.x};
    case ShapeType::kCapsule:
      return {size.x, size.x, size.x + size.y};
    case ShapeType::kCylinder:
      return {size.x, size.x, size.y};
    default:
      return size;
  }
}

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr Vec3<float> kInfinite{kFar, kFar, kFar};

/// Makes the box from `low` to `high` so large that it also holds that from `from` to `to`.
void widen(Vec3<float>& low, Vec3<float>& high, const Vec3<float>& from, const Vec3<float>& to) {
  low = {min(low.x, from.x), min(low.y, from.y), min(low.z, from.z)};
  high = {max(high.x, to.x), max(high.y, to.y), max(high.z, to.z)};
}

Triangles::Part part_of(const Mesh& mesh) { return {mesh.vertices, mesh.triangles}; }

Triangles::Part part_of(const ConvexPolyhedron& hull) {
  Triangles::Part part;
  part.is_smooth = false;
  for (const Vec3<double>& v : hull.vertices) part.vertices.push_back(broadcast<float>(v));
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const std::span<const int> face = hull.faces[f];
    for (std::size_t k = 2; k < face.size(); ++k) part.triangles.push_back({face[0], face[k - 1], face[k]});
  }
  return part;
}

/// Cut along the same diagonals as for collision.
Triangles::Part part_of(const HeightField& field) {
  Triangles::Part part;
  for (int j = 0; j < field.rows; ++j) {
    for (int i = 0; i < field.columns; ++i) {
      const double z = field.height[part.vertices.size()];
      part.vertices.push_back(broadcast<float>(
          Vec3<double>{(i - 0.5 * (field.columns - 1)) * field.dx, (j - 0.5 * (field.rows - 1)) * field.dy, z}));
    }
  }
  for (int j = 0; j + 1 < field.rows; ++j) {
    for (int i = 0; i + 1 < field.columns; ++i) {
      const int at = j * field.columns + i, above = at + field.columns;
      part.triangles.push_back({at, at + 1, above + 1});
      part.triangles.push_back({at, above + 1, above});
    }
  }
  return part;
}

Triangles::Part part_of(const Model& model, const Geom& geom, const Transform<double>& X_BG) {
  const auto take = [&]() -> Triangles::Part {
    if (geom.shape.type == ShapeType::kHeightField) {
      return part_of(model.height_fields()[geom.shape.height_field.index()]);
    }
    const Mesh& mesh = model.meshes()[geom.shape.mesh.index()];
    return geom.shape.type == ShapeType::kMesh ? part_of(mesh) : part_of(convex_polyhedron(mesh.vertices));
  };
  Triangles::Part part = take();
  for (Vec3<float>& v : part.vertices) v = broadcast<float>(X_BG * broadcast<double>(v));
  return part;
}

/// Which geoms are seen: all visual ones, and those of links that have none.
std::vector<GeomId> seen_geoms(const Model& model) {
  std::vector<bool> has_visual(model.links().size(), false);
  for (const Geom& geom : model.geoms()) {
    if (geom.role == GeomRole::kVisual) has_visual[geom.link.index()] = true;
  }
  std::vector<GeomId> seen;
  for (std::size_t i = 0; i < model.geoms().size(); ++i) {
    const Geom& geom = model.geoms()[i];
    // Things on the world itself do not hide each other.
    const bool stands_in = geom.link == LinkId(0) || !has_visual[geom.link.index()];
    if ((geom.role == GeomRole::kVisual || stands_in) && geom.rgba[3] > 0) seen.push_back(GeomId(i));
  }
  return seen;
}

}  // namespace

Pattern usual_pattern(const Geom& geom) {
  return geom.shape.type == ShapeType::kPlane ? Pattern::kChecks : Pattern::kPlain;
}

Item item_of(const Shape& shape) {
  if (!is_simple(shape.type)) throw std::invalid_argument("only simple shapes can be drawn without a model");
  Item item{.type = shape.type, .size = broadcast<float>(shape.size)};
  item.high = half_extents(item.type, item.size);
  const bool has_size = shape.type == ShapeType::kPlane || (item.high.x > 0 && item.high.y > 0 && item.high.z > 0);
  if (!has_size) throw std::invalid_argument("a shape to be drawn has a size that is not above 0");
  item.low = -item.high;
  return item;
}

Scene::Scene(std::shared_ptr<const Model> model) : model_(std::move(model)) {
  std::map<std::pair<int, bool>, std::vector<GeomId>> clusters;  // by body, and whether one sees through them
  for (const GeomId id : seen_geoms(*model_)) {
    const Geom& geom = model_->geoms()[id.index()];
    const Link& link = model_->link(geom.link);
    const bool is_clear = geom.rgba[3] < 1;
    if (!is_simple(geom.shape.type)) {
      clusters[{link.body.value(), is_clear}].push_back(id);
      continue;
    }
    Item item = item_of(geom.shape);
    item.body = link.body;
    item.X_BI = broadcast<float>(link.X_BL * geom.X_LG);
    item.first_seen = static_cast<int>(seen_.size());
    item.is_clear = is_clear;
    items_.push_back(item);
    seen_.push_back({geom.link, id, geom.rgba, usual_pattern(geom), item.low, item.high});
  }
  for (const auto& [key, geoms] : clusters) {
    Item item{.body = BodyId(key.first), .type = ShapeType::kMesh, .low = kInfinite, .high = -kInfinite};
    item.first_seen = static_cast<int>(seen_.size());
    item.is_clear = key.second;
    std::vector<Triangles::Part> parts;
    for (const GeomId id : geoms) {
      const Geom& geom = model_->geoms()[id.index()];
      Triangles::Part part = part_of(*model_, geom, model_->link(geom.link).X_BL * geom.X_LG);
      if (part.triangles.empty()) continue;
      Seen& seen = seen_.emplace_back(
          Seen{.link = geom.link, .geom = id, .rgba = geom.rgba, .low = kInfinite, .high = -kInfinite});
      for (const Vec3<float>& v : part.vertices) widen(seen.low, seen.high, v, v);
      widen(item.low, item.high, seen.low, seen.high);
      parts.push_back(std::move(part));
    }
    if (parts.empty()) continue;
    item.num_seen = static_cast<int>(parts.size());
    item.triangles = Triangles::of(std::move(parts));
    items_.push_back(item);
  }
}

}  // namespace manyhands
