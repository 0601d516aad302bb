// The shapes, colours and surfaces of <visual> and <collision>.
#include <algorithm>
#include <numbers>

#include "manyhands/model/io/geom_part.h"
#include "manyhands/model/io/sdf/sdf_parts.h"
#include "manyhands/model/io/text_numbers.h"
#include "manyhands/model/unit.h"

namespace manyhands::io {

namespace {

void read_plane(const SdfElement& plane, SdfGeom& result) {
  plane.expect({"normal", "size"});
  result.geom.shape = {.type = ShapeType::kPlane};
  const Vec3<double> normal = plane.vec3_or("normal", {0, 0, 1});
  if (norm(normal) < 1e-9) plane.fail("the normal of <plane> is 0; expected a direction such as 0 0 1");
  result.pose.X.R = result.pose.X.R * rotation_to_normal(at_unit_length(normal));
}

void read_mesh(const SdfElement& mesh, SdfGeom& result) {
  mesh.expect({"uri", "scale", "submesh"});
  if (mesh.has("submesh")) {
    mesh.note_serious(LoadAction::kIgnored, "<submesh> is not used; the whole mesh is taken");
  }
  result.geom.shape = {.type = ShapeType::kMesh};
  result.mesh_file = mesh.text_or("uri", "");
  if (result.mesh_file.empty()) mesh.fail("<mesh> has no <uri>; expected the name of a mesh file");
  result.mesh_scale = mesh.vec3_or("scale", {1, 1, 1});
}

/// Reads the one shape into `result`; false if its kind is not known.
bool read_shape(const SdfElement& shape, SdfGeom& result) {
  const std::string_view tag = shape.tag();
  Geom& geom = result.geom;
  const auto round = [&](ShapeType type) {
    shape.expect({"radius", "length"});
    geom.shape = {.type = type, .size = {shape.number_or("radius", 1), 0.5 * shape.number_or("length", 1), 0}};
  };
  if (tag == "box") {
    shape.expect({"size"});
    geom.shape = {.type = ShapeType::kBox, .size = 0.5 * shape.vec3_or("size", {1, 1, 1})};
  } else if (tag == "sphere") {
    shape.expect({"radius"});
    geom.shape = {.type = ShapeType::kSphere, .size = {shape.number_or("radius", 1), 0, 0}};
  } else if (tag == "cylinder") {
    round(ShapeType::kCylinder);
  } else if (tag == "capsule") {
    round(ShapeType::kCapsule);
  } else if (tag == "ellipsoid") {
    shape.expect({"radii"});
    geom.shape = {.type = ShapeType::kConvex};
    result.ellipsoid = shape.vec3_or("radii", {1, 1, 1});
  } else if (tag == "plane") {
    read_plane(shape, result);
  } else if (tag == "mesh") {
    read_mesh(shape, result);
  } else {
    return false;
  }
  return true;
}

bool is_solid(const SdfGeom& part) {
  const Vec3<double> half = part.ellipsoid.value_or(Vec3<double>{1, 1, 1});
  return has_extent(part.geom.shape, part.mesh_scale) && half.x > 0 && half.y > 0 && half.z > 0;
}

void read_colour(const SdfElement& visual, SdfGeom& result) {
  const SdfElement material = visual.child("material");
  if (!material) return;
  material.expect({"ambient", "diffuse", "specular", "emissive", "lighting", "pbr"});
  const SdfElement diffuse = material.child("diffuse"), ambient = material.child("ambient");
  if (const SdfElement& colour = diffuse ? diffuse : ambient) {
    const bool has_alpha = split_blanks(colour.text()).size() > 3;
    const std::vector<double> v = colour.numbers(has_alpha ? 4 : 3);
    for (std::size_t i = 0; i < v.size(); ++i) result.geom.rgba[i] = static_cast<float>(std::clamp(v[i], 0.0, 1.0));
  }
  const SdfElement pbr = material.child("pbr");
  const SdfElement metal = pbr ? pbr.child("metal") : pbr;
  if (metal) result.texture_file = metal.text_or("albedo_map", "");
}

}  // namespace

std::optional<SdfGeom> read_geom(const SdfElement& element, GeomRole role) {
  SdfGeom result{.source = element, .pose = element.pose()};
  result.geom.role = role;
  result.geom.name = element.attribute("name");
  if (role == GeomRole::kVisual) {
    element.expect({"pose", "geometry", "material", "transparency", "cast_shadows", "visibility_flags"});
    read_colour(element, result);
    const double shown = 1 - std::clamp(element.number_or("transparency", 0), 0.0, 1.0);
    result.geom.rgba[3] *= static_cast<float>(shown);
  } else {
    element.expect({"pose", "geometry", "surface", "max_contacts"});
    result.is_concave = element.attribute("concave") == "yes" || element.attribute("concave") == "1";
  }
  const SdfElement geometry = element.child("geometry");
  const std::vector<SdfElement> shapes = geometry ? geometry.children() : std::vector<SdfElement>{};
  if (shapes.empty()) element.fail("it has no <geometry> with a shape in it; expected one such as <box>");
  for (std::size_t i = 1; i < shapes.size(); ++i) {
    shapes[i].note(LoadAction::kIgnored,
                   "<" + std::string(shapes[i].tag()) + "> in <geometry>; only the first shape counts");
  }
  if (shapes[0].tag() == "empty") return std::nullopt;
  const std::string shape = "the <" + std::string(shapes[0].tag()) + ">";
  if (!read_shape(shapes[0], result)) {
    shapes[0].note_serious(LoadAction::kIgnored, shape + " is not known; the geom is left out");
    return std::nullopt;
  }
  if (!is_solid(result)) {
    shapes[0].note_serious(LoadAction::kIgnored, shape + " has no size; the geom is left out");
    return std::nullopt;
  }
  return result;
}

SurfaceMaterial read_surface(const SdfElement& collision) {
  SurfaceMaterial result{.lateral_friction = 1};
  const SdfElement surface = collision.child("surface");
  if (!surface) return result;
  surface.expect({"friction", "bounce", "contact"});
  if (const SdfElement friction = surface.child("friction")) {
    friction.expect({"ode", "torsional"});
    if (const SdfElement ode = friction.child("ode")) {
      ode.expect({"mu", "mu2"});  // mu2 is across a direction that Gazebo chooses where the file does not
      result.lateral_friction = ode.positive_or("mu", 1);
    }
    if (const SdfElement torsional = friction.child("torsional")) {
      torsional.expect({"coefficient", "use_patch_radius", "patch_radius"});
      // A disc of contact under Hertz's pressure: torque = 3 pi / 16 a mu N.
      const double radius = torsional.flag_or("use_patch_radius", true) ? torsional.positive_or("patch_radius", 0) : 0;
      result.spinning_friction = 3 * std::numbers::pi / 16 * radius * torsional.positive_or("coefficient", 1);
    }
  }
  if (const SdfElement bounce = surface.child("bounce")) {
    bounce.expect({"restitution_coefficient", "threshold"});
    result.restitution = bounce.restitution_or("restitution_coefficient", 0);
  }
  if (const SdfElement contact = surface.child("contact")) contact.expect({"collide_bitmask"});
  return result;
}

}  // namespace manyhands::io
