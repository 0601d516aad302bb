#include "manyhands/model/io/mesh/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <string>

#include "manyhands/model/io/text_numbers.h"

namespace manyhands {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t kMostBytes = std::uintmax_t{128} << 20;

std::string read_bytes(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) throw MeshError("there is no such file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error || size > kMostBytes)
    throw MeshError("the file has more than " + std::to_string(kMostBytes >> 20) + " MiB");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (!stream) throw MeshError("the file cannot be read");
  return bytes;
}

std::string extension_of(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// The files of a glTF lie beside it.
io::GltfFiles files_beside(const fs::path& path) {
  return [folder = path.parent_path()](const std::string& name) {
    if (name.find_first_of("/\\:") != name.npos || name.starts_with('.')) {
      throw MeshError("the file " + io::in_quotes(name) + " does not lie beside it; expected a plain name");
    }
    return read_bytes(folder / name);
  };
}

bool is_gltf(const std::string& extension) { return extension == ".gltf" || extension == ".glb"; }

Mesh read(const fs::path& path) {
  const std::string extension = extension_of(path);
  if (extension == ".stl") return io::read_stl(read_bytes(path));
  if (extension == ".obj") return io::read_obj(read_bytes(path));
  if (extension == ".dae") return io::read_dae(read_bytes(path));
  if (extension == ".msh") return io::read_msh(read_bytes(path));
  if (is_gltf(extension)) return io::read_gltf(read_bytes(path), files_beside(path));
  throw MeshError("the format " + io::in_quotes(extension) +
                  " is not known; expected .stl, .obj, .dae, .gltf, .glb or .msh");
}

std::vector<Mesh> read_objects(const fs::path& path) {
  if (extension_of(path) == ".obj") return io::read_obj_objects(read_bytes(path));
  if (is_gltf(extension_of(path))) return io::read_gltf_objects(read_bytes(path), files_beside(path));
  std::vector<Mesh> objects;
  objects.push_back(read(path));
  return objects;
}

void apply_scale(Mesh& mesh, const Vec3<double>& scale) {
  for (Vec3<float>& v : mesh.vertices) {
    v = {static_cast<float>(v.x * scale.x), static_cast<float>(v.y * scale.y), static_cast<float>(v.z * scale.z)};
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) {
      throw MeshError("a vertex is not finite");
    }
  }
  if (scale.x * scale.y * scale.z < 0) {
    for (std::array<int, 3>& t : mesh.triangles) std::swap(t[1], t[2]);
  }
}

/// Whether triangles are left once those with a repeated vertex are gone.
bool finish(Mesh& mesh, const Vec3<double>& scale) {
  std::erase_if(mesh.triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  apply_scale(mesh, scale);
  return !mesh.triangles.empty();
}

}  // namespace

Mesh load_mesh(const fs::path& path, const Vec3<double>& scale) {
  try {
    Mesh mesh = read(path);
    mesh.source = path.string();
    mesh.scale = scale;
    if (!finish(mesh, scale)) throw MeshError("the file holds no triangles");
    return mesh;
  } catch (const MeshError& error) {
    throw MeshError(path.string() + ": " + error.what());
  }
}

std::vector<Mesh> load_mesh_objects(const fs::path& path, const Vec3<double>& scale) {
  try {
    std::vector<Mesh> objects = read_objects(path);
    std::erase_if(objects, [&](Mesh& object) { return !finish(object, scale); });
    if (objects.empty()) throw MeshError("the file holds no triangles");
    for (Mesh& object : objects) {
      object.source.insert(0, path.string() + (object.source.empty() ? "" : "#"));
      object.scale = scale;
    }
    return objects;
  } catch (const MeshError& error) {
    throw MeshError(path.string() + ": " + error.what());
  }
}

}  // namespace manyhands
