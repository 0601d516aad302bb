#include "manyhands/base/whole_file.h"

#include <optional>
#include <random>
#include <string>
#include <system_error>

#include "manyhands/base/system.h"

namespace manyhands {

namespace {

/// Opens a file beside `path`, by a name that nobody knows beforehand, and returns where it lies.
std::filesystem::path open_draft(const std::filesystem::path& path, std::optional<system::NewFile>& file) {
  constexpr int kTries = 10;
  std::random_device random;
  for (int i = 1;; ++i) {
    std::filesystem::path draft = path;
    draft += ".part" + std::to_string(random());
    try {
      file.emplace(draft);
      return draft;
    } catch (const std::system_error& error) {
      if (error.code() != std::errc::file_exists || i == kTries) throw;
    }
  }
}

}  // namespace

void write_whole_file(const std::filesystem::path& path, std::initializer_list<std::span<const std::byte>> pieces) {
  std::optional<system::NewFile> file;
  const std::filesystem::path draft = open_draft(path, file);
  try {
    for (const std::span<const std::byte> piece : pieces) file->write(piece);
    file->close();
    std::filesystem::rename(draft, path);
  } catch (const std::system_error&) {
    file.reset();  // where an open file cannot be removed
    std::error_code ignored;
    std::filesystem::remove(draft, ignored);
    throw;
  }
}

void write_whole_file(const std::filesystem::path& path, std::string_view text) {
  write_whole_file(path, {std::as_bytes(std::span(text))});
}

}  // namespace manyhands
