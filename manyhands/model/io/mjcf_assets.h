// <asset>: meshes, height fields and materials.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manyhands/model/io/mjcf_settings.h"
#include "manyhands/model/model_builder.h"
#include "manyhands/model/solids.h"

namespace manyhands::io {

using Rgba = std::array<float, 4>;

/// The rgba of an element, or `fallback`.
[[nodiscard]] Rgba read_rgba(const MjcfElement& element, const Rgba& fallback);

/// A mesh that a geom uses.
struct MjcfMesh {
  MeshId id{};
  Inertial per_density{};  ///< mass properties of the solid at density 1 kg/m^3; at density 1 kg/m^2 of its skin
};

class MjcfAssets {
 public:
  MjcfAssets(const MjcfElement& root, const MjcfSettings& settings, const MjcfClasses& classes, bool load_meshes);

  /// Adds the mesh to the builder when it is first asked for. Fails on an unknown name or a file outside the folder;
  /// gives nothing, with a note, if the file cannot be read or meshes are not wanted.
  [[nodiscard]] const MjcfMesh* mesh(const std::string& name, const MjcfElement& user, ModelBuilder& builder);
  [[nodiscard]] std::optional<HeightFieldId> height_field(const std::string& name, const MjcfElement& user,
                                                          ModelBuilder& builder);
  [[nodiscard]] Rgba material(const std::string& name, const MjcfElement& user) const;

 private:
  struct MeshEntry {
    MjcfElement source;
    bool is_read = false;
    std::optional<MjcfMesh> mesh;
  };
  struct HeightFieldEntry {
    MjcfElement source;
    bool is_read = false;
    std::optional<HeightFieldId> id;
  };

  void add_mesh(const MjcfElement& element, const MjcfClasses& classes);
  void add_height_field(const MjcfElement& element);
  [[nodiscard]] std::optional<MjcfMesh> read_mesh(const MjcfElement& source, ModelBuilder& builder) const;
  [[nodiscard]] std::string path_of(const std::string& file) const;

  const MjcfSettings& settings_;
  bool load_meshes_;
  std::map<std::string, MeshEntry> meshes_;
  std::map<std::string, HeightFieldEntry> height_fields_;
  std::map<std::string, Rgba> materials_;
};

/// The surface of the convex hull of a mesh's vertices. Throws ModelError if they have no extent.
[[nodiscard]] Mesh hull_of(const Mesh& mesh);

/// The heights of an <hfield>, from `elevation` or the bytes of its file. Fails on what is malformed.
[[nodiscard]] HeightField read_height_field(const MjcfElement& source, const std::string& bytes);

}  // namespace manyhands::io
