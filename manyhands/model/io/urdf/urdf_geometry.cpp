// The shapes, colours and places of <visual> and <collision>.
#include <cstdint>

#include "manyhands/model/io/geom_part.h"
#include "manyhands/model/io/text_numbers.h"
#include "manyhands/model/io/urdf/urdf_parts.h"
#include "manyhands/model/unit.h"

namespace manyhands::io {

namespace {

void read_plane(const UrdfElement& element, Geom& geom) {
  element.expect({"normal"});
  const Vec3<double> normal = element.vec3_or("normal", {0, 0, 1});
  const double length = norm(normal);
  if (length < 1e-9) element.fail("the normal of <plane> is 0; expected a direction such as \"0 0 1\"");
  geom.X_LG.R = geom.X_LG.R * rotation_to_normal((1 / length) * normal);
}

/// PyBullet reads a single number as the scale of all axes, and files rely on it.
Vec3<double> read_scale(const UrdfElement& mesh) {
  if (!mesh.has("scale")) return {1, 1, 1};
  if (split_blanks(mesh.text("scale")).size() != 1) return mesh.vec3("scale", "1 1 1");
  const double s = mesh.number("scale");
  mesh.note(LoadAction::kRepaired, "attribute 'scale' holds one number; " + format_number(s) + " taken for all axes");
  return {s, s, s};
}

/// Reads the one shape element into `result`; false if its kind is not known, which is noted.
bool read_shape(const UrdfElement& element, UrdfGeom& result) {
  Shape& shape = result.geom.shape;
  const std::string_view tag = element.tag();
  if (tag == "box") {
    element.expect({"size"});
    shape = {ShapeType::kBox, 0.5 * element.vec3("size", "0.1 0.2 0.3"), {}};
  } else if (tag == "sphere") {
    element.expect({"radius"});
    shape = {ShapeType::kSphere, {element.number("radius"), 0, 0}, {}};
  } else if (tag == "cylinder" || tag == "capsule") {
    element.expect({"radius", "length"});
    shape = {tag == "cylinder" ? ShapeType::kCylinder : ShapeType::kCapsule,
             {element.number("radius"), 0.5 * element.number("length"), 0},
             {}};
  } else if (tag == "plane") {
    shape = {ShapeType::kPlane, Vec3<double>::zero(), {}};
    read_plane(element, result.geom);
  } else if (tag == "mesh") {
    element.expect({"filename", "scale"});
    shape = {ShapeType::kMesh, Vec3<double>::zero(), {}};
    result.mesh_file = element.text("filename");
    result.mesh_scale = read_scale(element);
  } else {
    element.note_serious(LoadAction::kIgnored,
                         "the shape <" + std::string(tag) + "> is not known; the geom is left out");
    return false;
  }
  return true;
}

/// The visual's own material, or the one that it names.
void wear_material(const UrdfElement& visual, const Materials& materials, UrdfGeom& result) {
  if (visual.is_bullet()) result.geom.rgba = {1, 1, 1, 1};
  const UrdfElement element = visual.child("material");
  if (!element) return;
  element.expect({"name"}, {"color", "texture"});
  std::optional<UrdfMaterial> material = read_material(element);
  const std::string_view name = element.text_or_empty("name");
  if (const auto found = materials.find(name); !material && found != materials.end()) material = found->second;
  if (!material) {
    element.note(LoadAction::kDefaulted, "no colour for the material " + in_quotes(name) + "; grey taken");
    return;
  }
  result.geom.rgba = material->rgba;
  result.texture_file = material->texture_file;
}

/// Bullet's attributes of <collision>.
void read_bullets(const UrdfElement& collision, UrdfGeom& result) {
  result.is_concave = collision.text_or_empty("concave") == "yes" || collision.text_or_empty("concave") == "1";
  const auto bits = [&](const char* attribute, std::uint32_t otherwise) {
    const std::optional<double> value = collision.optional_number(attribute);
    return value ? static_cast<std::uint32_t>(static_cast<std::int64_t>(*value)) : otherwise;
  };
  result.geom.filter = {bits("group", result.geom.filter.group), bits("mask", result.geom.filter.mask)};
}

}  // namespace

std::optional<UrdfGeom> read_geom(const UrdfElement& element, GeomRole role, const Materials& materials) {
  const bool has_bullets = element.is_bullet() && role == GeomRole::kCollision;
  element.expect(
      {"name", has_bullets ? "concave" : "name", has_bullets ? "group" : "name", has_bullets ? "mask" : "name"},
      {"origin", "geometry", role == GeomRole::kVisual ? "material" : "geometry"});
  const UrdfElement geometry = element.required_child("geometry", "<geometry> with a shape in it");
  UrdfGeom result{.source = element, .geom = {}, .mesh_file = {}};
  result.geom.name = element.text_or_empty("name");
  result.geom.role = role;
  result.geom.X_LG = element.origin();
  if (has_bullets) read_bullets(element, result);
  const std::vector<UrdfElement> shapes = geometry.children();
  if (shapes.empty()) geometry.fail("<geometry> is empty; expected a shape such as <box size=\"0.1 0.2 0.3\"/>");
  for (std::size_t i = 1; i < shapes.size(); ++i) {
    shapes[i].note(LoadAction::kIgnored,
                   "<" + std::string(shapes[i].tag()) + "> in <geometry>; only the first shape counts");
  }
  if (!read_shape(shapes[0], result)) return std::nullopt;
  if (role == GeomRole::kVisual) wear_material(element, materials, result);
  if (!has_extent(result.geom.shape, result.mesh_scale)) {
    shapes[0].note_serious(LoadAction::kIgnored,
                           "the <" + std::string(shapes[0].tag()) + "> has no size; the geom is left out");
    return std::nullopt;
  }
  return result;
}

}  // namespace manyhands::io
