// Where the files that a robot description names lie, and which of them it may read.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace manyhands::io {

/// A path that leads out of the folders that may be read.
class PathEscape : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Resolves the file names of one description file.
class PackagePaths {
 public:
  /// `folder` holds the description file; `package_paths` is searched before the environment.
  /// `look_above`: what is not there is looked for, by its name without scheme, in the folders above, as Bullet does.
  PackagePaths(const std::filesystem::path& folder, std::vector<std::filesystem::path> package_paths,
               bool allow_outside, bool look_above = false);

  /// The same for a file in another folder, which this may read: relative names start there.
  [[nodiscard]] PackagePaths at(const std::filesystem::path& folder) const;

  /// The file meant by `name`: package://PACKAGE/..., model://PACKAGE/..., file://..., an absolute path, or a path
  /// relative to the folder. A package is looked for in the package paths, in GZ_SIM_RESOURCE_PATH,
  /// GAZEBO_MODEL_PATH and ROS_PACKAGE_PATH, in the share folders of AMENT_PREFIX_PATH and in the folders above the
  /// description: a folder of its name, or one whose package.xml bears it. The result is a regular file, symbolic links
  /// resolved.
  ///
  /// Throws PathEscape if it lies outside its package, or, without a package, outside that of the description: the
  /// nearest folder above with a package.xml, pyproject.toml or __init__.py, and those above it while they have one,
  /// too; else its folder. std::runtime_error if there is no such file.
  [[nodiscard]] std::filesystem::path resolve(std::string_view name) const;

 private:
  [[nodiscard]] std::filesystem::path resolve_as_said(std::string_view name) const;
  [[nodiscard]] std::filesystem::path find_package(const std::string& package) const;
  [[nodiscard]] std::filesystem::path checked(const std::filesystem::path& path,
                                              const std::vector<std::filesystem::path>& roots) const;

  std::filesystem::path folder_;
  std::vector<std::filesystem::path> package_paths_;
  std::vector<std::filesystem::path> own_roots_;  ///< what names without a package may reach
  bool allow_outside_;
  bool look_above_;
};

}  // namespace manyhands::io
