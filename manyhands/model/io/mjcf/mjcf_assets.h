// <asset>: meshes, height fields and materials.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manyhands/model/io/mjcf/mjcf_settings.h"
#include "manyhands/model/model_builder.h"
#include "manyhands/model/solids.h"

namespace manyhands::io {

using Rgba = std::array<float, 4>;

/// The rgba of an element, or `fallback`.
[[nodiscard]] Rgba read_rgba(const MjcfElement& element, const Rgba& fallback);

/// A mesh that a geom uses.
struct MjcfMesh {
  Mesh surface{};
  Inertial per_density{};      ///< mass properties of the solid at density 1 kg/m^3; at density 1 kg/m^2 of its skin
  std::optional<MeshId> id{};  ///< where the model has it
};

/// What a <texture> shows, its `repeat` still unset.
struct MjcfTexture {
  std::optional<GeomTexture> shown{};  ///< nothing if it cannot be shown
  bool is_cube = false;                ///< one image for each side, which no material repeats
};

struct MjcfMaterial {
  Rgba rgba{};
  std::optional<GeomTexture> texture{};
  bool is_uniform = false;  ///< repeated along lengths in place of along a geom
};

class MjcfAssets {
 public:
  /// `sections`: all <asset> elements; `settings`: by the model that they belong to.
  MjcfAssets(const std::vector<MjcfElement>& sections, const std::vector<MjcfSettings>& settings,
             const MjcfClasses& classes, bool load_meshes);

  /// Reads the mesh when it is first asked for. Fails on an unknown name or a file outside the folder; gives nothing,
  /// with a note, if the file cannot be read or meshes are not wanted.
  [[nodiscard]] const MjcfMesh* mesh(const std::string& name, const MjcfElement& user);
  /// The same mesh in the model.
  [[nodiscard]] MeshId mesh_id(const std::string& name, const MjcfElement& user, ModelBuilder& builder);
  [[nodiscard]] std::optional<HeightFieldId> height_field(const std::string& name, const MjcfElement& user,
                                                          ModelBuilder& builder);
  [[nodiscard]] bool has_material(const std::string& name) const { return materials_.contains(name); }
  [[nodiscard]] const MjcfMaterial& material(const std::string& name, const MjcfElement& user) const;

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

  void add_texture(const MjcfElement& element);
  void add_material(const MjcfElement& element, const MjcfClasses& classes);
  void add_mesh(const MjcfElement& element, const MjcfClasses& classes);
  void add_height_field(const MjcfElement& element);
  [[nodiscard]] std::optional<MjcfMesh> read_mesh(const MjcfElement& source) const;
  [[nodiscard]] const MjcfSettings& settings_of(const MjcfElement& e) const { return settings_[e.model()]; }

  const std::vector<MjcfSettings>& settings_;
  bool load_meshes_;
  int heights_left_ = 32'000'000;  ///< of all height fields together, for a small picture may hold very many
  std::map<std::string, MeshEntry> meshes_;
  std::map<std::string, HeightFieldEntry> height_fields_;
  std::map<std::string, MjcfTexture> textures_;
  std::map<std::string, MjcfMaterial> materials_;
};

/// The path that a file's name means below the folder of its kind.
[[nodiscard]] std::string path_in(const std::string& folder, const std::string& file, const MjcfSettings& settings);

/// Reads a <texture>; what cannot be shown is noted.
[[nodiscard]] MjcfTexture read_texture(const MjcfElement& texture, const MjcfSettings& settings);

/// The material's texture as a geom of this shape shows it.
[[nodiscard]] std::optional<GeomTexture> texture_on(ShapeType shape, const MjcfMaterial& material,
                                                    const MjcfElement& geom);

/// A shape fitted to a mesh, as the file's frame has it, and its pose there.
struct MjcfFit {
  Vec3<double> size{};
  Transform<double> X_MS = Transform<double>::identity();
};

/// What MuJoCo makes of <geom type="capsule" mesh="...">: the sphere, capsule, cylinder, ellipsoid or box with the
/// inertia of the mesh, in its principal axes; if `in_box`, one about as large as the box of its vertices in these.
[[nodiscard]] MjcfFit fitted(const std::string& type, const MjcfMesh& mesh, bool in_box);

/// The heights of an <hfield>, from `elevation` or the bytes of its file. Fails on what is malformed and on more than
/// `most` heights; throws ImageError for a broken picture.
[[nodiscard]] HeightField read_height_field(const MjcfElement& source, const std::string& bytes, int most);

}  // namespace manyhands::io
