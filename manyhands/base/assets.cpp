#include "manyhands/base/assets.h"

#include <cstdlib>
#include <map>
#include <set>
#include <string>

namespace manyhands {

namespace {

std::filesystem::path& chosen_root() {
  static std::filesystem::path root;
  return root;
}

/// The robots and scenes in the folder, sorted; those of a folder with many are counted.
std::string list_of_models(const std::filesystem::path& root) {
  constexpr std::size_t kMany = 8;
  std::map<std::string, std::set<std::string>> folders;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    const std::filesystem::path path = entry.path().lexically_relative(root);
    if (path.extension() != ".urdf" && path.extension() != ".xml") continue;
    folders[path.begin()->string()].insert(path.string());
  }
  std::string text;
  for (const auto& [folder, names] : folders) {
    if (names.size() > kMany) {
      text += (text.empty() ? "" : ", ") + std::to_string(names.size()) + " models in '" + folder + "'";
    } else {
      for (const std::string& name : names) text += (text.empty() ? "'" : ", '") + name + "'";
    }
  }
  return text.empty() ? "no robots" : text;
}

}  // namespace

std::filesystem::path asset_root() {
  if (!chosen_root().empty()) return chosen_root();
  if (const char* root = std::getenv("MANYHANDS_ASSETS")) return root;
  return MANYHANDS_SOURCE_ASSETS;
}

void set_asset_root(std::filesystem::path root) { chosen_root() = std::move(root); }

std::filesystem::path asset_path(const std::filesystem::path& relative) {
  const std::filesystem::path root = asset_root();
  if (!std::filesystem::is_directory(root)) {
    throw std::runtime_error("asset '" + relative.string() + "' is not found, as there is no folder '" + root.string() +
                             "'; set MANYHANDS_ASSETS to the folder 'assets' of the project");
  }
  if (!std::filesystem::exists(root / relative)) {
    throw AssetNotFound("asset '" + relative.string() + "' is not in '" + root.string() + "'; there are " +
                        list_of_models(root));
  }
  return root / relative;
}

}  // namespace manyhands
