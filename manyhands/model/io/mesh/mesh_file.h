// Triangle meshes from STL, OBJ, COLLADA (DAE), glTF and MuJoCo's MSH files.
#pragma once

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "manyhands/model/description.h"

namespace manyhands {

/// Thrown when a mesh file cannot be read; the message names the file and what is wrong.
class MeshError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Loads the triangles of an STL (ASCII or binary), OBJ, DAE, GLTF, GLB or MSH file, told by its extension. Coordinates
/// are those of the file times `scale`; DAE files also by their unit; DAE and glTF files turned so that their up axis
/// is z. Polygons become fans of triangles, equal vertices of an STL become one, triangles with a repeated vertex are
/// left out. A mirroring scale turns the triangles round, so that they still face outwards. Files of more than 128 MiB
/// are refused.
[[nodiscard]] Mesh load_mesh(const std::filesystem::path& path, const Vec3<double>& scale = {1, 1, 1});

/// The same by the objects of the file, each with the vertices that it uses: an OBJ file's begin at 'o' and 'g', a
/// glTF file's are its nodes. Of other formats all is one object.
[[nodiscard]] std::vector<Mesh> load_mesh_objects(const std::filesystem::path& path,
                                                  const Vec3<double>& scale = {1, 1, 1});

namespace io {

/// The readers behind `load_mesh`: the triangles in `bytes`, unscaled. They throw MeshError, whatever the bytes are.
[[nodiscard]] Mesh read_stl(std::string_view bytes);
[[nodiscard]] Mesh read_obj(std::string_view bytes);
[[nodiscard]] std::vector<Mesh> read_obj_objects(std::string_view bytes);
[[nodiscard]] Mesh read_dae(std::string_view bytes);
[[nodiscard]] Mesh read_msh(std::string_view bytes);
/// `files` gives the contents of the files beside it that a glTF file names.
using GltfFiles = std::function<std::string(const std::string& name)>;
[[nodiscard]] Mesh read_gltf(std::string_view bytes, const GltfFiles& files);
[[nodiscard]] std::vector<Mesh> read_gltf_objects(std::string_view bytes, const GltfFiles& files);

}  // namespace io
}  // namespace manyhands
