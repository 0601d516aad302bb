#include "manyhands/base/whole_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <random>
#include <string>
#include <system_error>

namespace manyhands {

namespace {

[[noreturn]] void throw_errno() { throw std::system_error(errno, std::generic_category()); }

void write_all(int file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw_errno();
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

/// A new file beside `path`, of a name that nobody knows beforehand: no link leads it astray, and no two writers meet.
int open_draft(const std::filesystem::path& path, std::filesystem::path& draft) {
  constexpr int kTries = 10;
  std::random_device random;
  for (int i = 0; i < kTries; ++i) {
    draft = path;
    draft += ".part" + std::to_string(random());
    const int file = ::open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
    if (file >= 0) return file;
    if (errno != EEXIST) break;
  }
  throw_errno();
}

void write_and_close(int file, std::initializer_list<std::span<const std::byte>> pieces) {
  try {
    for (const std::span<const std::byte> piece : pieces) write_all(file, piece);
    if (::fsync(file) != 0) throw_errno();
  } catch (...) {
    ::close(file);
    throw;
  }
  if (::close(file) != 0) throw_errno();
}

}  // namespace

void write_whole_file(const std::filesystem::path& path, std::initializer_list<std::span<const std::byte>> pieces) {
  std::filesystem::path draft;
  const int file = open_draft(path, draft);
  try {
    write_and_close(file, pieces);
    std::filesystem::rename(draft, path);
  } catch (const std::system_error&) {
    std::error_code ignored;
    std::filesystem::remove(draft, ignored);
    throw;
  }
}

void write_whole_file(const std::filesystem::path& path, std::string_view text) {
  write_whole_file(path, {std::as_bytes(std::span(text))});
}

}  // namespace manyhands
