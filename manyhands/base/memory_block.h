// Bytes that may be many: in memory, or in a file that the system keeps on a disk and reads as it is needed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace manyhands {

/// `size` bytes, zero at first.
class MemoryBlock {
 public:
  MemoryBlock() = default;
  /// In memory, which is taken as it is written to; or, unless `folder` is empty, in a file there, whose room is taken
  /// at once. The file has no name: it goes with the block, however the program ends.
  /// Throws std::system_error, naming the folder, if it is none, cannot be written to, or its disk is full, and
  /// std::bad_alloc.
  explicit MemoryBlock(std::size_t size, const std::filesystem::path& folder = {});
  ~MemoryBlock();
  MemoryBlock(MemoryBlock&& other) noexcept;
  MemoryBlock& operator=(MemoryBlock&& other) noexcept;

  template <class T>
  [[nodiscard]] T* as() {
    return static_cast<T*>(bytes_);
  }
  template <class T>
  [[nodiscard]] const T* as() const {
    return static_cast<const T*>(bytes_);
  }

 private:
  void* bytes_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace manyhands
