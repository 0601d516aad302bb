#include "manyhands/model/io/save/asset_files.h"

#include <cctype>
#include <fstream>
#include <sstream>
#include <system_error>

#include "manyhands/base/whole_file.h"
#include "manyhands/model/io/save/exact.h"

namespace manyhands::io {

namespace fs = std::filesystem;

namespace {

/// Writes a whole file; what hinders it becomes a SaveError.
void save_file(const fs::path& path, const std::string& bytes) {
  try {
    write_whole_file(path, bytes);
  } catch (const std::system_error& error) {
    throw SaveError("cannot write " + path.string() + ": " + error.code().message());
  }
}

}  // namespace

std::string obj_text(const Mesh& mesh) {
  std::string text;
  for (const Vec3<float>& v : mesh.vertices) {
    text += "v " + exact_text(v.x) + " " + exact_text(v.y) + " " + exact_text(v.z) + "\n";
  }
  for (const std::array<int, 3>& t : mesh.triangles) {
    text += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " + std::to_string(t[2] + 1) + "\n";
  }
  return text;
}

std::string mesh_stem(const Mesh& mesh) {
  const std::size_t from = mesh.source.find('\''), to = mesh.source.rfind('\'');
  const bool is_element = mesh.source.starts_with("mesh '") && from < to;  // as loaders of MJCF call it
  const fs::path name =
      is_element ? mesh.source.substr(from + 1, to - from - 1) : fs::path(mesh.source).stem().string();
  return file_stem(name.string(), "mesh");
}

AssetFiles::AssetFiles(const fs::path& path)
    : folder_(fs::absolute(path).parent_path()), own_folder_(file_stem(path.stem().string(), "model") + "_assets") {}

std::string AssetFiles::add(const std::string& stem, const std::string& extension, std::string bytes) {
  std::string name;
  for (int number = 1; number == 1 || !is_free(name, bytes); ++number) {
    name = own_folder_ + "/" + stem + (number == 1 ? "" : "_" + std::to_string(number)) + extension;
  }
  files_.emplace(name, std::move(bytes));
  return name;
}

bool AssetFiles::is_free(const std::string& name, const std::string& bytes) const {
  if (const auto planned = files_.find(name); planned != files_.end()) return planned->second == bytes;
  std::error_code error;
  const fs::path path = folder_ / name;
  if (!fs::exists(fs::symlink_status(path, error))) return true;
  if (!fs::is_regular_file(path, error) || fs::file_size(path, error) != bytes.size()) return false;
  return read_asset(path) == bytes;
}

void AssetFiles::write() const {
  if (files_.empty()) return;
  std::error_code error;
  fs::create_directory(folder_ / own_folder_, error);
  if (error) throw SaveError("cannot make the folder " + (folder_ / own_folder_).string() + ": " + error.message());
  for (const auto& [name, bytes] : files_) save_file(folder_ / name, bytes);
}

std::string file_stem(const std::string& name, const std::string& otherwise) {
  constexpr std::size_t kLongest = 100;
  std::string stem;
  for (const char c : name.substr(0, kLongest)) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.';
    stem += is_plain ? c : '_';
  }
  if (stem.empty() || stem.front() == '.') stem = otherwise + stem;
  return stem;
}

std::string read_asset(const fs::path& path) {
  constexpr std::uintmax_t kMost = std::uintmax_t{128} << 20;
  std::error_code error;
  if (!fs::is_regular_file(path, error) || fs::file_size(path, error) > kMost) {
    throw SaveError("there is no file " + path.string() + " of at most 128 MiB");
  }
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  if (!stream) throw SaveError(path.string() + " cannot be read");
  return bytes.str();
}

LoadReport save_with_assets(const fs::path& path, const std::function<SavedText(AssetFiles&)>& text) {
  AssetFiles files(path);
  SavedText saved = text(files);
  files.write();
  save_file(path, saved.text);
  return std::move(saved.report);
}

}  // namespace manyhands::io
