#include "manyhands/base/assets.h"

#include <cstdlib>
#include <stdexcept>

namespace manyhands {

namespace {

std::filesystem::path& chosen_root() {
  static std::filesystem::path root;
  return root;
}

}  // namespace

std::filesystem::path asset_root() {
  if (!chosen_root().empty()) return chosen_root();
  if (const char* root = std::getenv("MANYHANDS_ASSETS")) return root;
  return MANYHANDS_SOURCE_ASSETS;
}

void set_asset_root(std::filesystem::path root) { chosen_root() = std::move(root); }

std::filesystem::path asset_path(const std::filesystem::path& relative) {
  const std::filesystem::path path = asset_root() / relative;
  if (!std::filesystem::exists(path)) {
    throw std::runtime_error("asset '" + relative.string() + "' is not in '" + asset_root().string() +
                             "'; set MANYHANDS_ASSETS to the folder 'assets' of the project");
  }
  return path;
}

}  // namespace manyhands
