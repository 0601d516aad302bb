#include "manyhands/model/io/mjcf/mjcf_assets.h"

#include <algorithm>

#include "manyhands/model/convex_polyhedron.h"
#include "manyhands/model/hull_mesh.h"
#include "manyhands/model/io/mesh/mesh_file.h"
#include "manyhands/model/io/mjcf/mjcf.h"
#include "manyhands/model/io/text_file.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

Rgba read_rgba(const MjcfElement& element, const Rgba& fallback) {
  if (!element.has("rgba")) return fallback;
  const std::vector<double> v = element.numbers("rgba", 4, 4);
  Rgba rgba{};
  std::ranges::transform(v, rgba.begin(), [](double x) { return static_cast<float>(x); });
  return rgba;
}

namespace {

/// The name, or the file's without folder and extension.
std::string asset_name(const MjcfElement& element) {
  if (!element.text_or("name", "").empty()) return element.text("name");
  if (!element.has_own("file")) element.fail("it has neither 'name' nor 'file'; expected one of them");
  return std::filesystem::path(element.text("file")).stem().string();
}

std::array<float, 2> read_repeat(const MjcfElement& material) {
  std::array<float, 2> repeat{1, 1};
  if (!material.has("texrepeat")) return repeat;
  const std::vector<double> given = material.numbers("texrepeat", 2, 2);
  for (std::size_t i = 0; i < 2; ++i) {
    if (given[i] > 0 && given[i] <= kMostRepeats) {
      repeat[i] = static_cast<float>(given[i]);
    } else {
      material.note(LoadAction::kRepaired, "'texrepeat' " + format_number(given[i]) + " is not above 0 and at most " +
                                               format_number(kMostRepeats) + "; 1 taken");
    }
  }
  return repeat;
}

template <class Entries>
auto& find_asset(Entries& entries, const char* kind, const std::string& name, const MjcfElement& user) {
  const auto found = entries.find(name);
  if (found == entries.end()) {
    user.fail("there is no " + std::string(kind) + " " + in_quotes(name) + "; expected the name of one in <asset>");
  }
  return found->second;
}

}  // namespace

MjcfAssets::MjcfAssets(const std::vector<MjcfElement>& sections, const std::vector<MjcfSettings>& settings,
                       const MjcfClasses& classes, bool load_meshes)
    : settings_(settings), load_meshes_(load_meshes) {
  for (const MjcfElement& section : sections) {
    section.named("asset").expect({}, {"mesh", "hfield", "texture", "material", "model"});
    for (const MjcfElement& element : section.children("texture")) add_texture(element);
  }
  for (const MjcfElement& section : sections) {
    for (const MjcfElement& element : section.children()) {
      if (element.tag() == "mesh") {
        add_mesh(element, classes);
      } else if (element.tag() == "hfield") {
        add_height_field(element);
      } else if (element.tag() == "material") {
        add_material(element, classes);
      }
    }
  }
}

void MjcfAssets::add_texture(const MjcfElement& element) {
  const std::string file = std::filesystem::path(element.text_or("file", "")).stem().string();
  const std::string name = element.text_or("name", file);
  const MjcfElement texture = element.named("texture '" + name + "'");
  const bool is_new = textures_.emplace(name, read_texture(texture, settings_of(texture))).second;
  if (!is_new && !name.empty()) texture.fail("the name is taken; expected another name");
}

void MjcfAssets::add_material(const MjcfElement& element, const MjcfClasses& classes) {
  const std::string name = element.named("material").text("name");
  const MjcfElement source = element.named("material '" + name + "'").with_defaults(classes, "material");
  source.expect({"name", "class", "rgba", "texture", "texrepeat", "texuniform"}, {});
  MjcfMaterial material{.rgba = read_rgba(source, {1, 1, 1, 1}), .is_uniform = source.boolean_or("texuniform", false)};
  if (!source.text_or("texture", "").empty()) {
    const MjcfTexture& texture = find_asset(textures_, "texture", source.text("texture"), source);
    material.texture = texture.shown;
    if (texture.shown && !texture.is_cube) material.texture->repeat = read_repeat(source);
  }
  if (!materials_.emplace(name, std::move(material)).second) source.fail("the name is taken; expected another name");
}

void MjcfAssets::add_mesh(const MjcfElement& element, const MjcfClasses& classes) {
  const std::string name = asset_name(element.named("mesh"));
  const MjcfElement mesh = element.named("mesh '" + name + "'").with_defaults(classes, "mesh");
  mesh.expect({"name", "class", "file", "scale", "refpos", "refquat", "vertex", "face", "inertia", "content_type",
               "maxhullvert", "builtin", "params"});
  if (!meshes_.emplace(name, MeshEntry{mesh, false, {}}).second) mesh.fail("the name is taken; expected another name");
}

void MjcfAssets::add_height_field(const MjcfElement& element) {
  const std::string name = asset_name(element.named("hfield"));
  const MjcfElement field = element.named("hfield '" + name + "'");
  field.expect({"name", "file", "nrow", "ncol", "size", "elevation", "content_type"});
  if (!height_fields_.emplace(name, HeightFieldEntry{field, false, {}}).second) {
    field.fail("the name is taken; expected another name");
  }
}

std::string path_in(const std::string& folder, const std::string& file, const MjcfSettings& settings) {
  namespace fs = std::filesystem;
  const fs::path path = settings.strip_path ? fs::path(file).filename() : fs::path(file);
  return (fs::path(folder) / path).string();
}

namespace {

Mesh inline_mesh(const MjcfElement& source) {
  constexpr std::size_t kMost = 3'000'000;
  const std::vector<double> v = source.numbers("vertex", 12, kMost);
  if (v.size() % 3 != 0) source.fail("the count of numbers in 'vertex' is no multiple of 3");
  Mesh mesh{.source = source.what()};
  for (std::size_t i = 0; i < v.size(); i += 3) {
    mesh.vertices.push_back({static_cast<float>(v[i]), static_cast<float>(v[i + 1]), static_cast<float>(v[i + 2])});
  }
  const std::vector<double> f = source.has("face") ? source.numbers("face", 3, kMost) : std::vector<double>{};
  if (f.size() % 3 != 0) source.fail("the count of numbers in 'face' is no multiple of 3");
  for (std::size_t i = 0; i < f.size(); i += 3) {
    std::array<int, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(f[i + k] >= 0 && f[i + k] < static_cast<double>(mesh.vertices.size()))) {
        source.fail("'face' names a vertex " + format_number(f[i + k]) + ", which does not exist");
      }
      triangle[k] = static_cast<int>(f[i + k]);
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

/// refpos, refquat and scale, in MuJoCo's order.
AffineMap placing_of(const MjcfElement& source) {
  const Vec3<double> origin = source.vec3_or("refpos", Vec3<double>::zero());
  const Vec3<double> scale = source.vec3_or("scale", {1, 1, 1});
  if (scale.x == 0 || scale.y == 0 || scale.z == 0) source.fail("a scale of 0; expected three other numbers");
  Mat3<double> R = Mat3<double>::identity();
  if (source.has("refquat")) R = transpose(to_matrix(quat_from_wxyz(source, source.numbers("refquat", 4, 4).data())));
  const Mat3<double> A{scale.x * R.x, scale.y * R.y, scale.z * R.z};
  return {A, -(A * origin)};
}

void place_vertices(const MjcfElement& source, const AffineMap& place, Mesh& mesh) {
  for (Vec3<float>& v : mesh.vertices) {
    const Vec3<double> p = place * Vec3<double>{v.x, v.y, v.z};
    v = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    if (!is_finite(v.x) || !is_finite(v.y) || !is_finite(v.z)) source.fail("a vertex is not finite");
  }
  if (place.mirrors()) {
    for (std::array<int, 3>& t : mesh.triangles) std::swap(t[1], t[2]);
  }
}

/// MuJoCo makes hulls of at most `maxhullvert` vertices.
void note_coarser_hull(const MjcfElement& source, const Mesh& mesh) {
  const int most = source.integer_or("maxhullvert", -1);
  if (most < 0 || mesh.vertices.size() <= static_cast<std::size_t>(most)) return;
  const std::size_t has = convex_polyhedron(mesh.vertices).vertices.size();
  if (has <= static_cast<std::size_t>(most)) return;
  source.note_serious(LoadAction::kIgnored, "its hull keeps " + std::to_string(has) + " vertices; 'maxhullvert' " +
                                                std::to_string(most) + " is not used");
}

}  // namespace

std::optional<MjcfMesh> MjcfAssets::read_mesh(const MjcfElement& source) const {
  try {
    if (source.has("builtin")) throw MeshError("builtin meshes are not made");
    if (!source.has("file") && !source.has("vertex")) throw MeshError("neither 'file' nor 'vertex'");
    const MjcfSettings& settings = settings_of(source);
    Mesh mesh = source.has("file")
                    ? load_mesh(source.paths().resolve(path_in(settings.mesh_folder, source.text("file"), settings)))
                    : inline_mesh(source);
    const std::string kind = source.word_or("inertia", {"convex", "exact", "legacy", "shell"}, "legacy");
    note_coarser_hull(source, mesh);
    if (mesh.triangles.empty()) mesh = hull_of(mesh);
    const AffineMap place = placing_of(source);
    const Inertial mass = kind == "shell"    ? skin_of(mesh, place)
                          : kind == "convex" ? solid_of(hull_of(mesh), false, place)
                                             : solid_of(mesh, kind == "legacy", place);
    place_vertices(source, place, mesh);
    return MjcfMesh{std::move(mesh), mass};
  } catch (const PathEscape& error) {
    source.fail(error.what());
  } catch (const MjcfError&) {
    throw;
  } catch (const std::exception& error) {
    source.note_serious(LoadAction::kIgnored, std::string(error.what()) + "; its geoms are left out");
  }
  return std::nullopt;
}

const MjcfMesh* MjcfAssets::mesh(const std::string& name, const MjcfElement& user) {
  MeshEntry& entry = find_asset(meshes_, "mesh", name, user);
  if (!entry.is_read) {
    entry.is_read = true;
    if (load_meshes_) {
      entry.mesh = read_mesh(entry.source);
    } else {
      entry.source.note_once("load_meshes", LoadAction::kIgnored, "meshes are left out, as asked");
    }
  }
  return entry.mesh ? &*entry.mesh : nullptr;
}

MeshId MjcfAssets::mesh_id(const std::string& name, const MjcfElement& user, ModelBuilder& builder) {
  MjcfMesh& mesh = *find_asset(meshes_, "mesh", name, user).mesh;
  if (!mesh.id) mesh.id = builder.add_mesh(mesh.surface);
  return *mesh.id;
}

std::optional<HeightFieldId> MjcfAssets::height_field(const std::string& name, const MjcfElement& user,
                                                      ModelBuilder& builder) {
  HeightFieldEntry& entry = find_asset(height_fields_, "hfield", name, user);
  if (entry.is_read) return entry.id;
  entry.is_read = true;
  const MjcfElement& source = entry.source;
  try {
    const MjcfSettings& settings = settings_of(source);
    const std::string file = source.text_or("file", "");
    const std::string bytes =
        file.empty() ? "" : read_text_file(source.paths().resolve(path_in(settings.mesh_folder, file, settings)));
    HeightField field = read_height_field(source, bytes, heights_left_);
    heights_left_ -= static_cast<int>(field.height.size());
    entry.id = builder.add_height_field(std::move(field));
  } catch (const PathEscape& error) {
    source.fail(error.what());
  } catch (const MjcfError&) {
    throw;
  } catch (const std::runtime_error& error) {
    source.note_serious(LoadAction::kIgnored, "its file: " + std::string(error.what()) + "; its geoms are left out");
  }
  return entry.id;
}

const MjcfMaterial& MjcfAssets::material(const std::string& name, const MjcfElement& user) const {
  return find_asset(materials_, "material", name, user);
}

}  // namespace manyhands::io
