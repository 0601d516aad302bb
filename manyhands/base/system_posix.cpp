// manyhands/base/system.h for Linux and macOS.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <new>
#include <string>
#include <system_error>

#include "manyhands/base/system.h"

namespace manyhands::system {

namespace {

[[noreturn]] void fail(int error) { throw std::system_error(error, std::generic_category()); }

/// Gives the file its room at once, so that a full disk is told of: one with holes would end the program later.
int take_room(int file, std::size_t size) {
  const auto length = static_cast<off_t>(size);
#if defined(__APPLE__)
  fstore_t room{F_ALLOCATEALL, F_PEOFPOSMODE, 0, length, 0};
  return ::fcntl(file, F_PREALLOCATE, &room) == -1 || ::ftruncate(file, length) != 0 ? errno : 0;
#else
  return ::posix_fallocate(file, 0, length);
#endif
}

/// An open file of `size` bytes without a name.
int open_nameless(std::size_t size, const std::filesystem::path& folder) {
  std::string name = (folder / "manyhands.XXXXXX").string();
  const int file = ::mkostemp(name.data(), O_CLOEXEC);
  if (file < 0) fail(errno);
  ::unlink(name.c_str());
  if (const int error = take_room(file, size); error != 0) {
    ::close(file);
    fail(error);
  }
  return file;
}

void* map(std::size_t size, int kind, int file) {
  void* bytes = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, kind, file, 0);
  if (file >= 0) ::close(file);  // the mapping holds it
  if (bytes == MAP_FAILED) throw std::bad_alloc();
  return bytes;
}

}  // namespace

int process_id() { return ::getpid(); }

NewFile::NewFile(const std::filesystem::path& path)
    : handle_(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644)) {
  if (handle_ < 0) fail(errno);
}

NewFile::~NewFile() {
  if (handle_ >= 0) ::close(static_cast<int>(handle_));
}

void NewFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(static_cast<int>(handle_), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void NewFile::close() {
  const int file = static_cast<int>(handle_);
  if (::fsync(file) != 0) fail(errno);
  handle_ = -1;
  if (::close(file) != 0) fail(errno);
}

void* map_memory(std::size_t size, const std::filesystem::path& folder) {
  if (folder.empty()) return map(size, MAP_PRIVATE | MAP_ANONYMOUS, -1);
  return map(size, MAP_SHARED, open_nameless(size, folder));
}

void unmap_memory(void* bytes, std::size_t size) { ::munmap(bytes, size); }

}  // namespace manyhands::system
