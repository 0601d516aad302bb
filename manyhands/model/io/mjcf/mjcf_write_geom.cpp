// <geom> and what it shows: meshes, height fields, materials.
#include <algorithm>
#include <cmath>

#include "manyhands/model/hull_mesh.h"
#include "manyhands/model/io/mjcf/mjcf_assets.h"
#include "manyhands/model/io/mjcf/mjcf_compliance.h"
#include "manyhands/model/io/mjcf/mjcf_writer.h"

namespace manyhands::io {

namespace {

const char* type_of(const Shape& shape) {
  switch (shape.type) {
    case ShapeType::kSphere:
      return "sphere";
    case ShapeType::kCapsule:
      return "capsule";
    case ShapeType::kCylinder:
      return "cylinder";
    case ShapeType::kBox:
      return "box";
    case ShapeType::kPlane:
      return "plane";
    case ShapeType::kMesh:
    case ShapeType::kConvex:
      return "mesh";
    case ShapeType::kHeightField:
      return "hfield";
  }
  return "";
}

template <std::size_t N>
std::string colour(const std::array<float, N>& rgb) {
  std::string text;
  for (const float x : rgb) text += (text.empty() ? "" : " ") + exact_text(x);
  return text;
}

double lowest(const HeightField& field) { return *std::ranges::min_element(field.height); }

/// Writes shape and size; returns the pose that these ask for.
Transform<double> write_shape(MjcfWriter& writer, pugi::xml_node node, const Geom& geom, const std::string& what) {
  const Shape& shape = geom.shape;
  Transform<double> X = geom.X_LG;
  const Vec3<double>& s = shape.size;
  set(node, "type", type_of(shape));
  switch (shape.type) {
    case ShapeType::kSphere:
      set(node, "size", s.x);
      break;
    case ShapeType::kCapsule:
    case ShapeType::kCylinder:
      set(node, "size", std::array{s.x, s.y});
      break;
    case ShapeType::kBox:
      set(node, "size", s);
      break;
    case ShapeType::kPlane:
      set(node, "size", "0 0 1");
      break;
    case ShapeType::kMesh:
    case ShapeType::kConvex:
      set(node, "mesh", mesh_asset(writer, shape.mesh));
      break;
    case ShapeType::kHeightField: {
      set(node, "hfield", height_field_asset(writer, shape.height_field));
      const double low = lowest(writer.model.height_fields()[shape.height_field.index()]);
      if (low == 0) break;
      X.p = X * Vec3<double>{0, 0, low};
      writer.notes.changed(what, "MJCF's heights begin at 0: the geom lies lower or higher by their least");
      break;
    }
  }
  return X;
}

/// A mesh in the world touches by its triangles here, and by its hull in MJCF; those that move have hulls in both.
void note_hull(MjcfWriter& writer, const Geom& geom, const std::string& what) {
  constexpr double kAlike = 1e-3;
  if (writer.model.link(geom.link).body.value() != 0) return;
  const Mesh& mesh = writer.model.meshes()[geom.shape.mesh.index()];
  const auto is_convex = [&] {
    try {
      const double volume = solid_of(mesh, false).mass, hull = solid_of(hull_of(mesh), false).mass;
      return std::abs(hull - volume) <= kAlike * hull;
    } catch (const ModelError&) {  // flat
      return false;
    }
  };
  if (is_convex()) {
    writer.notes.changed(what, "a mesh that is as good as convex touches by its hull");
  } else {
    writer.notes.loss(LoadAction::kRepaired, what, "a mesh that touches by its triangles becomes its convex hull");
  }
}

/// A capsule of no length is a sphere, which MJCF asks to be called one.
Geom as_written(const Geom& geom) {
  Geom result = geom;
  if (geom.shape.type == ShapeType::kCapsule && geom.shape.size.y == 0) result.shape.type = ShapeType::kSphere;
  return result;
}

}  // namespace

void write_geom(MjcfWriter& writer, pugi::xml_node body, GeomId id) {
  const Geom geom = as_written(writer.model.geoms()[id.index()]);
  const std::string what = part("geom", geom.name);
  pugi::xml_node node = body.append_child("geom");
  std::string& name = writer.geom_names[id.index()];
  name = writer.names.claim("geom", geom.name, "geom", writer.notes);
  set(node, "name", name);
  const Transform<double> X = write_shape(writer, node, geom, what);
  write_pose(node, X);
  const bool collides = geom.role == GeomRole::kCollision;
  if (collides && geom.shape.type == ShapeType::kMesh) note_hull(writer, geom, what);
  const auto& [contype, conaffinity] = writer.filters[id.index()];
  if (contype != 1) set(node, "contype", contype);
  if (conaffinity != 1) set(node, "conaffinity", conaffinity);
  write_surface(node, geom.surface, false);
  if (collides) write_compliance(writer, node, what, geom.surface.compliance, "solref", "solimp");
  if (collides && geom.surface.compliance) set_unless(node, "solmix", geom.surface.compliance->share, 1);
  if (collides) note_surface(writer, geom.surface, what);
  set_unless(node, "margin", geom.margin, 0);
  const std::string material = geom.texture ? material_asset(writer, geom) : "";
  if (!material.empty()) set(node, "material", material);
  set(node, "rgba", colour(geom.rgba));
}

void write_surface(pugi::xml_node node, const SurfaceMaterial& surface, bool is_pair) {
  const double slide = surface.lateral_friction, spin = surface.spinning_friction, roll = surface.rolling_friction;
  const int condim = roll > 0 ? 6 : spin > 0 ? 4 : slide > 0 ? 3 : 1;
  if (condim != 3) set(node, "condim", condim);
  if (is_pair) {
    set(node, "friction", std::array{slide, slide, spin, roll, roll});
  } else {
    set(node, "friction", std::array{slide, spin, roll});
  }
}

void note_surface(MjcfWriter& writer, const SurfaceMaterial& surface, const std::string& what) {
  const bool has_two = surface.friction_y && *surface.friction_y != surface.lateral_friction;
  if (has_two) writer.notes.loss(LoadAction::kIgnored, what, "its friction differs by direction");
  if (surface.restitution != 0) writer.notes.loss(LoadAction::kIgnored, what, "it bounces: MJCF has no restitution");
  if (surface.stiffness || surface.damping) {
    writer.notes.loss(LoadAction::kIgnored, what, "its stiffness and damping of contact are left out");
  }
}

const std::string& mesh_asset(MjcfWriter& writer, MeshId id) {
  const auto [entry, is_new] = writer.meshes.try_emplace(id.value());
  if (!is_new) return entry->second;
  const Mesh& mesh = writer.model.meshes()[id.index()];
  entry->second = writer.names.unused("mesh", mesh_stem(mesh));
  pugi::xml_node node = writer.assets.append_child("mesh");
  set(node, "name", entry->second);
  set(node, "inertia", "shell");  // of no use, but what MuJoCo takes of meshes that do not close
  if (writer.files != nullptr && !mesh.triangles.empty()) {
    set(node, "file", writer.files->add(entry->second, ".obj", obj_text(mesh)));
    return entry->second;
  }
  std::string vertices, faces;
  // 0 for -0, as it is read.
  for (const Vec3<float>& v : mesh.vertices) vertices += colour<3>({v.x + 0, v.y + 0, v.z + 0}) + " ";
  for (const std::array<int, 3>& t : mesh.triangles) {
    for (const int corner : t) faces += std::to_string(corner) + " ";
  }
  set(node, "vertex", vertices);
  if (!faces.empty()) set(node, "face", faces);
  return entry->second;
}

const std::string& height_field_asset(MjcfWriter& writer, HeightFieldId id) {
  const auto [entry, is_new] = writer.height_fields.try_emplace(id.value());
  if (!is_new) return entry->second;
  const HeightField& field = writer.model.height_fields()[id.index()];
  entry->second = writer.names.unused("hfield", "hfield");
  pugi::xml_node node = writer.assets.append_child("hfield");
  set(node, "name", entry->second);
  set(node, "nrow", field.rows);
  set(node, "ncol", field.columns);
  const auto half = [](double spacing, int count) {
    const double cells = count - 1;
    return number_for(0.5 * spacing * cells, spacing, [&](double x) { return 2 * x / cells; }, 2 / cells);
  };
  constexpr double kBelow = 1;  // how far MuJoCo lets the ground reach below its lowest point [m]
  const auto [low, high] = std::ranges::minmax(field.height);
  set(node, "size",
      std::array{half(field.dx, field.columns), half(field.dy, field.rows), high > low ? high - low : 1, kBelow});
  std::vector<double> elevation;  // from the highest y down
  const auto columns = static_cast<std::ptrdiff_t>(field.columns);
  for (auto row = field.height.end(); row != field.height.begin(); row -= columns) {
    elevation.insert(elevation.end(), row - columns, row);
  }
  for (double& height : elevation) height -= low;
  set(node, "elevation", elevation);
  return entry->second;
}

std::string material_asset(MjcfWriter& writer, const Geom& geom) {
  const GeomTexture& shown = *geom.texture;
  const bool is_image = !shown.file.empty();
  std::string bytes;
  if (is_image) {
    try {
      if (writer.files == nullptr) throw SaveError("a text holds no images");
      bytes = read_asset(shown.file);
    } catch (const std::exception& error) {
      writer.notes.left_out(part("geom", geom.name), "its texture: " + std::string(error.what()));
      return "";
    }
  }
  const double unit = geom.shape.type == ShapeType::kPlane ? 2 : 1;  // of planes MuJoCo counts repeats in 2 m
  const std::string repeat = exact_text(std::array{unit * shown.repeat[0], unit * shown.repeat[1]});
  const std::string key = is_image ? shown.file : colour(shown.rgb[0]) + ", " + colour(shown.rgb[1]);
  const auto [texture, is_new_texture] = writer.textures.try_emplace(key);
  if (is_new_texture) {
    texture->second = writer.names.unused("texture", "texture");
    pugi::xml_node node = writer.assets.append_child("texture");
    set(node, "name", texture->second);
    set(node, "type", "2d");
    if (is_image) {
      const std::filesystem::path path(shown.file);
      set(node, "file",
          writer.files->add(file_stem(path.stem().string(), "texture"), path.extension().string(), bytes));
    } else {
      const bool is_flat = shown.rgb[0] == shown.rgb[1];
      set(node, "builtin", is_flat ? "flat" : "checker");
      set(node, "rgb1", colour(shown.rgb[0]));
      set(node, "rgb2", colour(shown.rgb[1]));
      set(node, "width", 128);
      set(node, "height", 128);
    }
  }
  const auto [material, is_new] = writer.materials.try_emplace(texture->second + " " + repeat);
  if (is_new) {
    material->second = writer.names.unused("material", "material");
    pugi::xml_node node = writer.assets.append_child("material");
    set(node, "name", material->second);
    set(node, "texture", texture->second);
    set(node, "texrepeat", repeat);
  }
  return material->second;
}

}  // namespace manyhands::io
