// The meshes and images of a file that is saved: which files they become beside it.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "manyhands/model/description.h"
#include "manyhands/model/io/save/save.h"

namespace manyhands::io {

/// The triangles as Wavefront OBJ: vertices in order, each number the shortest that is read back.
[[nodiscard]] std::string obj_text(const Mesh& mesh);

/// A name for a mesh, after the file or the element that it came from.
[[nodiscard]] std::string mesh_stem(const Mesh& mesh);

/// Collects files, and writes them when all is known to be well.
class AssetFiles {
 public:
  /// `path` is the file that will name them; its folder holds theirs, STEM_assets.
  explicit AssetFiles(const std::filesystem::path& path);

  /// The name of a file with these bytes, relative to the folder of `path`: the same for the same bytes, and never that
  /// of a file there is with others.
  [[nodiscard]] std::string add(const std::string& stem, const std::string& extension, std::string bytes);
  /// Throws SaveError; files are whole or not there.
  void write() const;

 private:
  [[nodiscard]] bool is_free(const std::string& name, const std::string& bytes) const;

  std::filesystem::path folder_;  ///< of the file that names them
  std::string own_folder_;        ///< within it
  std::map<std::string, std::string> files_;
};

/// A name for files: letters, digits, '-', '_' and '.', none of the last in front.
[[nodiscard]] std::string file_stem(const std::string& name, const std::string& otherwise);

/// The bytes of a file that a model shows. Throws SaveError if it is not there or has more than 128 MiB.
[[nodiscard]] std::string read_asset(const std::filesystem::path& path);

/// Writes what `text` makes of the files beside `path`, then the file: what it names is there when it appears. Throws
/// SaveError.
LoadReport save_with_assets(const std::filesystem::path& path, const std::function<SavedText(AssetFiles&)>& text);

}  // namespace manyhands::io
