#include "manyhands/base/memory_block.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <new>
#include <string>
#include <system_error>
#include <utility>

namespace manyhands {

namespace {

[[noreturn]] void fail(int error, std::size_t size, const std::filesystem::path& folder) {
  throw std::system_error(error, std::generic_category(),
                          "cannot keep " + std::to_string(size >> 20) + " MB in a file in '" + folder.string() + "'");
}

/// An open file of `size` bytes without a name.
int open_file(std::size_t size, const std::filesystem::path& folder) {
  std::string name = (folder / "manyhands.XXXXXX").string();
  const int file = ::mkostemp(name.data(), O_CLOEXEC);
  if (file < 0) fail(errno, size, folder);
  ::unlink(name.c_str());
  // A file with holes would end the program where the disk is full.
  if (const int error = ::posix_fallocate(file, 0, static_cast<off_t>(size)); error != 0) {
    ::close(file);
    fail(error, size, folder);
  }
  return file;
}

void* map(std::size_t size, const std::filesystem::path& folder) {
  constexpr int kAccess = PROT_READ | PROT_WRITE;
  if (folder.empty()) return ::mmap(nullptr, size, kAccess, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  const int file = open_file(size, folder);
  void* bytes = ::mmap(nullptr, size, kAccess, MAP_SHARED, file, 0);
  ::close(file);  // the mapping holds it
  return bytes;
}

}  // namespace

MemoryBlock::MemoryBlock(std::size_t size, const std::filesystem::path& folder) : size_(size) {
  if (size == 0) return;
  bytes_ = map(size, folder);
  if (bytes_ == MAP_FAILED) throw std::bad_alloc();
}

MemoryBlock::~MemoryBlock() {
  if (bytes_ != nullptr) ::munmap(bytes_, size_);
}

MemoryBlock::MemoryBlock(MemoryBlock&& other) noexcept
    : bytes_(std::exchange(other.bytes_, nullptr)), size_(std::exchange(other.size_, 0)) {}

MemoryBlock& MemoryBlock::operator=(MemoryBlock&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  std::swap(size_, other.size_);
  return *this;
}

}  // namespace manyhands
