#include "manyhands/model/io/mesh_shelf.h"

#include "manyhands/model/io/mesh/mesh_file.h"

namespace manyhands::io {

ShelvedMeshes MeshShelf::find(const PackagePaths& paths, const std::string& name, const Vec3<double>& scale,
                              bool by_objects) {
  std::filesystem::path path;
  try {
    path = paths.resolve(name);
  } catch (const PathEscape&) {
    throw;
  } catch (const std::runtime_error& error) {
    return {.problem = error.what()};
  }
  const auto [entry, is_new] = meshes_.try_emplace(std::tuple(path, scale.x, scale.y, scale.z, by_objects));
  if (is_new) {
    try {
      std::vector<Mesh> meshes;
      if (by_objects) {
        meshes = load_mesh_objects(path, scale);
      } else {
        meshes.push_back(load_mesh(path, scale));
      }
      for (Mesh& mesh : meshes) entry->second.ids.push_back(builder_->add_mesh(std::move(mesh)));
    } catch (const std::exception& error) {
      entry->second.problem = error.what();
    }
  }
  return entry->second;
}

}  // namespace manyhands::io
