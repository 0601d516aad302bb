// Checkpoint files: a checked, whole-or-nothing binary archive of plain values and arrays. Messages between processes.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace manyhands::learn {

/// A checkpoint that cannot be written, is not whole, or belongs to something else. The message names the file.
class CheckpointError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// Values as they travel between processes of one build.
using Message = std::vector<std::byte>;

/// Collects values in memory; `commit` writes the file.
class ArchiveWriter {
 public:
  template <Plain T>
  void value(T value) {
    append(&value, sizeof value);
  }
  template <Plain T>
  void array(std::span<T> values) {
    value(static_cast<std::uint64_t>(values.size()));
    append(values.data(), values.size_bytes());
  }
  void text(const std::string& text) { array(std::span(text)); }
  void message(std::span<const std::byte> bytes) { array(bytes); }

  /// Writes header, checksum and values beside `path` and renames it into place: a reader sees the old file or the new
  /// one, whole. Throws CheckpointError, leaving `path` as it was.
  void commit(const std::filesystem::path& path) const;

  /// The values alone, as a message.
  [[nodiscard]] Message take() && { return std::move(bytes_); }

 private:
  void append(const void* data, std::size_t bytes);

  std::vector<std::byte> bytes_;
};

/// Reads back in the same order. Everything that does not fit throws CheckpointError.
class ArchiveReader {
 public:
  /// Reads the whole file and verifies its header, length and checksum.
  explicit ArchiveReader(const std::filesystem::path& path);
  /// Reads a message; `what` it is, for errors.
  ArchiveReader(std::span<const std::byte> message, std::string what)
      : what_(std::move(what)), bytes_(message.begin(), message.end()) {}

  template <Plain T>
  void value(T& value) {
    extract(&value, sizeof value);
  }
  template <Plain T>
  [[nodiscard]] T value() {
    T result{};
    value(result);
    return result;
  }
  /// Throws unless the stored array has exactly the length of `values`.
  template <Plain T>
  void array(std::span<T> values) {
    check(value<std::uint64_t>() == values.size(), "an array has another length than this trainer's");
    extract(values.data(), values.size_bytes());
  }
  [[nodiscard]] std::string text();
  [[nodiscard]] Message message();

  /// Throws unless the stored value equals `own`.
  template <class T>
  void expect(const std::string& what, const T& own) {
    if constexpr (Plain<T>) {
      const T stored = value<T>();
      if (stored != own) mismatch(what, std::to_string(stored), std::to_string(own));
    } else {
      const std::string stored = text();
      if (stored != own) mismatch(what, stored, own);
    }
  }
  void check(bool holds, const std::string& complaint) const;
  /// Throws if values are left over.
  void finish() const;

 private:
  void extract(void* data, std::size_t bytes);
  [[noreturn]] void mismatch(const std::string& what, const std::string& stored, const std::string& own) const;

  std::string what_;
  std::vector<std::byte> bytes_;
  std::size_t at_ = 0;
};

}  // namespace manyhands::learn
