// What operating systems do each in its own way: processes, files that must not be there yet, mapped memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace manyhands::system {

/// The number of this process: another one in a child of fork().
[[nodiscard]] int process_id();

/// A file that was not there before, open for writing: no link leads it astray, and no two writers meet.
class NewFile {
 public:
  /// Throws std::system_error: with std::errc::file_exists where anything of that name is.
  explicit NewFile(const std::filesystem::path& path);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// Throws std::system_error.
  void write(std::span<const std::byte> bytes);
  /// Once all that was written is on the disk. Throws std::system_error.
  void close();

 private:
  std::intptr_t handle_;
};

/// `size` > 0 bytes, zero at first: in memory, or, unless `folder` is empty, in a file there that has its room at once
/// and goes with the program, however it ends. Throws std::system_error, and std::bad_alloc where addresses run out.
[[nodiscard]] void* map_memory(std::size_t size, const std::filesystem::path& folder);

/// Gives back what `map_memory` has mapped.
void unmap_memory(void* bytes, std::size_t size);

}  // namespace manyhands::system
