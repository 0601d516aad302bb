// The meshes that a description names, each loaded once for all the geoms that show or use it.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <tuple>

#include "manyhands/model/io/package_paths.h"
#include "manyhands/model/model_builder.h"

namespace manyhands::io {

struct ShelvedMesh {
  MeshId id{};            ///< invalid if it cannot be read
  std::string problem{};  ///< why
};

class MeshShelf {
 public:
  explicit MeshShelf(ModelBuilder& builder) : builder_(&builder) {}

  /// The mesh of that name. Throws PathEscape.
  [[nodiscard]] ShelvedMesh find(const PackagePaths& paths, const std::string& name, const Vec3<double>& scale);

 private:
  ModelBuilder* builder_;
  std::map<std::tuple<std::filesystem::path, double, double, double>, ShelvedMesh> meshes_;
};

}  // namespace manyhands::io
