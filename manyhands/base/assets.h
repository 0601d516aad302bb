// Where the robots and scenes that ship with the library lie.
#pragma once

#include <filesystem>
#include <stdexcept>

namespace manyhands {

/// The folder set by `set_asset_root`, else the variable MANYHANDS_ASSETS, else the source tree's.
[[nodiscard]] std::filesystem::path asset_root();
/// Call before the first use of an asset; the Python package points it into itself.
void set_asset_root(std::filesystem::path root);
/// Thrown for an asset that does not ship; the message lists the robots that do.
class AssetNotFound : public std::runtime_error {
  using runtime_error::runtime_error;
};

/// The path of an asset, for example "panda/panda.urdf". Throws AssetNotFound if it is not there, and
/// std::runtime_error if the folder itself is not.
[[nodiscard]] std::filesystem::path asset_path(const std::filesystem::path& relative);

}  // namespace manyhands
