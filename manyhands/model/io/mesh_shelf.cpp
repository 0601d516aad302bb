#include "manyhands/model/io/mesh_shelf.h"

#include "manyhands/model/io/mesh/mesh_file.h"

namespace manyhands::io {

ShelvedMesh MeshShelf::find(const PackagePaths& paths, const std::string& name, const Vec3<double>& scale) {
  std::filesystem::path path;
  try {
    path = paths.resolve(name);
  } catch (const PathEscape&) {
    throw;
  } catch (const std::runtime_error& error) {
    return {.problem = error.what()};
  }
  const auto [entry, is_new] = meshes_.try_emplace(std::tuple(path, scale.x, scale.y, scale.z));
  if (is_new) {
    try {
      entry->second.id = builder_->add_mesh(load_mesh(path, scale));
    } catch (const std::exception& error) {
      entry->second.problem = error.what();
    }
  }
  return entry->second;
}

}  // namespace manyhands::io
