// Where the robots and scenes that ship with the library lie.
#pragma once

#include <filesystem>

namespace manyhands {

/// The folder set by `set_asset_root`, else the variable MANYHANDS_ASSETS, else the source tree's.
[[nodiscard]] std::filesystem::path asset_root();
/// Call before the first use of an asset; the Python package points it into itself.
void set_asset_root(std::filesystem::path root);
/// The path of an asset, for example "panda/panda.urdf". Throws std::runtime_error if it is not there.
[[nodiscard]] std::filesystem::path asset_path(const std::filesystem::path& relative);

}  // namespace manyhands
