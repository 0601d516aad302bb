#include "manyhands/base/memory_block.h"

#include <string>
#include <system_error>
#include <utility>

#include "manyhands/base/system.h"

namespace manyhands {

MemoryBlock::MemoryBlock(std::size_t size, const std::filesystem::path& folder) : size_(size) {
  if (size == 0) return;
  try {
    bytes_ = system::map_memory(size, folder);
  } catch (const std::system_error& error) {
    throw std::system_error(error.code(),
                            "cannot keep " + std::to_string(size >> 20) + " MB in a file in '" + folder.string() + "'");
  }
}

MemoryBlock::~MemoryBlock() {
  if (bytes_ != nullptr) system::unmap_memory(bytes_, size_);
}

MemoryBlock::MemoryBlock(MemoryBlock&& other) noexcept
    : bytes_(std::exchange(other.bytes_, nullptr)), size_(std::exchange(other.size_, 0)) {}

MemoryBlock& MemoryBlock::operator=(MemoryBlock&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  std::swap(size_, other.size_);
  return *this;
}

}  // namespace manyhands
