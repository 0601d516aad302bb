// The meshes that a description names, each loaded once for all the geoms that show or use it.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "manyhands/model/io/package_paths.h"
#include "manyhands/model/model_builder.h"

namespace manyhands::io {

struct ShelvedMeshes {
  std::vector<MeshId> ids{};  ///< none if it cannot be read
  std::string problem{};      ///< why
};

class MeshShelf {
 public:
  explicit MeshShelf(ModelBuilder& builder) : builder_(&builder) {}

  /// The mesh of that name, as one or by its objects. Throws PathEscape.
  [[nodiscard]] ShelvedMeshes find(const PackagePaths& paths, const std::string& name, const Vec3<double>& scale,
                                   bool by_objects);

 private:
  ModelBuilder* builder_;
  std::map<std::tuple<std::filesystem::path, double, double, double, bool>, ShelvedMeshes> meshes_;
};

}  // namespace manyhands::io
