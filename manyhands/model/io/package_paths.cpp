#include "manyhands/model/io/package_paths.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <pugixml.hpp>

#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace fs = std::filesystem;

namespace {

std::vector<fs::path> paths_of_variable(const char* variable) {
  std::vector<fs::path> paths;
  const char* const value = std::getenv(variable);
  std::string_view rest = value == nullptr ? std::string_view() : std::string_view(value);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    if (end > 0) paths.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return paths;
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool has_file(const fs::path& folder, const char* name) {
  std::error_code error;
  return fs::is_regular_file(folder / name, error);
}

/// Whether a person has said that what lies in the folder belongs together: a ROS package, a Python project or package.
bool is_marked(const fs::path& folder) {
  return has_file(folder, "package.xml") || has_file(folder, "pyproject.toml") || has_file(folder, "__init__.py");
}

/// Whether a mark in the folder counts: not in one that many share, such as /tmp, nor in a home, which holds more than
/// one package.
bool may_be_root(const fs::path& folder) {
  std::error_code error;
  const bool is_shared = (fs::status(folder, error).permissions() & fs::perms::sticky_bit) != fs::perms::none;
  const char* const home = std::getenv("HOME");
  return !error && !is_shared && (home == nullptr || !fs::equivalent(folder, home, error));
}

/// The package that the folder lies in: the nearest folder above with a mark, or those above it while they have one,
/// too; the folder itself without any.
fs::path root_around(const fs::path& folder) {
  const auto is_root = [](const fs::path& above) {
    return above.has_relative_path() && is_marked(above) && may_be_root(above);
  };
  fs::path root = folder;
  while (root.has_relative_path() && !is_root(root)) root = root.parent_path();
  if (!is_root(root)) return folder;
  while (is_root(root.parent_path())) root = root.parent_path();
  return root;
}

/// Whether `folder` is the package: by its package.xml, or by its own name.
bool is_package(const fs::path& folder, const std::string& package) {
  if (folder.filename() == package) return is_folder(folder);
  if (!has_file(folder, "package.xml")) return false;
  pugi::xml_document manifest;
  if (!manifest.load_file((folder / "package.xml").c_str())) return false;
  return split_blanks(manifest.child("package").child_value("name")) == std::vector<std::string_view>{package};
}

/// The package in or at `place`: itself, a folder in it, or one in a folder in it (a repository of several packages).
std::optional<fs::path> package_at(const fs::path& place, const std::string& package, bool look_deeper) {
  if (is_folder(place / package)) return place / package;
  if (is_package(place, package)) return place;
  if (!look_deeper) return std::nullopt;
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(place, error), end; !error && entry != end; entry.increment(error)) {
    if (is_folder(entry->path() / package)) found.push_back(entry->path() / package);
  }
  if (found.empty()) return std::nullopt;
  return *std::ranges::min_element(found);  // the order of a folder's entries is not defined
}

/// "%20" and the like, as file:// names write blanks.
std::string percent_decoded(std::string_view text) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : ((c | 0x20) >= 'a' && (c | 0x20) <= 'f') ? (c | 0x20) - 'a' + 10 : -1;
  };
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && digit(text[i + 1]) >= 0 && digit(text[i + 2]) >= 0) {
      result += static_cast<char>(digit(text[i + 1]) * 16 + digit(text[i + 2]));
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

bool lies_in(const fs::path& path, const fs::path& root) {
  const auto [rest, unused] = std::mismatch(root.begin(), root.end(), path.begin(), path.end());
  return rest == root.end();
}

/// `path` with symbolic links and dots resolved, without the trailing slash; the path itself if that fails.
fs::path resolved(const fs::path& path) {
  std::error_code error;
  const fs::path result = fs::weakly_canonical(path, error);
  if (error) return path;
  return result.has_filename() ? result : result.parent_path();
}

}  // namespace

PackagePaths::PackagePaths(const fs::path& folder, std::vector<fs::path> package_paths, bool allow_outside,
                           bool look_above)
    : folder_(resolved(fs::absolute(folder))),
      package_paths_(std::move(package_paths)),
      allow_outside_(allow_outside),
      look_above_(look_above) {
  own_roots_.push_back(root_around(folder_));
  for (const fs::path& path : package_paths_) own_roots_.push_back(resolved(path));
}

PackagePaths PackagePaths::at(const fs::path& folder) const {
  PackagePaths other = *this;
  other.folder_ = resolved(fs::absolute(folder));
  return other;
}

fs::path PackagePaths::find_package(const std::string& package) const {
  if (package.empty() || package == "." || package == "..") {
    throw std::runtime_error("'" + package + "' is not the name of a package");
  }
  for (const fs::path& place : package_paths_) {
    if (const auto found = package_at(place, package, true)) return *found;
  }
  for (const char* const variable : {"GZ_SIM_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "ROS_PACKAGE_PATH"}) {
    for (const fs::path& place : paths_of_variable(variable)) {
      if (const auto found = package_at(place, package, true)) return *found;
    }
  }
  for (const fs::path& prefix : paths_of_variable("AMENT_PREFIX_PATH")) {
    if (is_folder(prefix / "share" / package)) return prefix / "share" / package;
  }
  for (fs::path above = folder_; above.has_relative_path(); above = above.parent_path()) {
    const auto found = package_at(above, package, false);
    // Somebody else's folder of that name is no package.
    const bool is_one =
        found && (has_file(*found, "package.xml") || lies_in(folder_, *found) || lies_in(*found, own_roots_.front()));
    if (is_one) return *found;
  }
  throw std::runtime_error("no package " + in_quotes(package) +
                           " in package_paths, ROS_PACKAGE_PATH, AMENT_PREFIX_PATH, GZ_SIM_RESOURCE_PATH, "
                           "GAZEBO_MODEL_PATH or, with a package.xml, the folders above the file");
}

fs::path PackagePaths::checked(const fs::path& path, const std::vector<fs::path>& roots) const {
  const fs::path result = resolved(path);
  const bool inside = std::ranges::any_of(roots, [&](const fs::path& root) { return lies_in(result, root); });
  if (!inside && !allow_outside_) {
    throw PathEscape(in_quotes(result.string()) + " lies outside " + in_quotes(roots.front().string()) +
                     "; expected a file inside it, or the option allow_outside_package");
  }
  std::error_code error;
  if (!fs::is_regular_file(result, error)) throw std::runtime_error("there is no file " + in_quotes(result.string()));
  return result;
}

fs::path PackagePaths::resolve(std::string_view name) const {
  if (!look_above_) return resolve_as_said(name);
  try {
    return resolve_as_said(name);
  } catch (const PathEscape&) {
    throw;
  } catch (const std::runtime_error&) {
    const std::size_t scheme = name.find("://");
    const fs::path rest = fs::path(name.substr(scheme == name.npos ? 0 : scheme + 3)).relative_path();
    for (fs::path above = folder_; above.has_relative_path(); above = above.parent_path()) {
      std::error_code error;
      if (fs::is_regular_file(above / rest, error)) return checked(above / rest, own_roots_);
    }
    throw;
  }
}

fs::path PackagePaths::resolve_as_said(std::string_view name) const {
  for (const std::string_view scheme : {"package://", "model://"}) {
    if (!name.starts_with(scheme)) continue;
    const std::string_view rest = name.substr(scheme.size());
    const std::size_t slash = std::min(rest.find('/'), rest.size());
    const fs::path package = resolved(find_package(std::string(rest.substr(0, slash))));
    return checked(package / fs::path(rest.substr(std::min(slash + 1, rest.size()))).relative_path(), {package});
  }
  constexpr std::string_view kFile = "file://";
  if (name.starts_with(kFile)) {
    const std::string path = percent_decoded(name.substr(kFile.size()));
    return checked(path.starts_with("localhost/") ? path.substr(9) : path, own_roots_);
  }
  if (name.find("://") != name.npos) {
    throw std::runtime_error("only package://, model:// and file:// names are read");
  }
  return checked(folder_ / fs::path(name), own_roots_);
}

}  // namespace manyhands::io
