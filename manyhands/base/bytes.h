// Values as bytes, and back: what a process hands to another of the same build, as Python's pickle does.
#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "manyhands/base/hash.h"

namespace manyhands {

/// Adds values to bytes, in order. Structures are taken apart by `visit_fields(archive, structure)`, which is found by
/// their namespace, and those that can be copied as bytes are.
class ByteWriter {
 public:
  template <class... Values>
  void operator()(const Values&... values) {
    (put(values), ...);
  }

  /// The bytes with their check sum; the writer is empty then.
  [[nodiscard]] std::vector<std::uint8_t> finish() {
    put(check_sum(bytes_));
    return std::exchange(bytes_, {});
  }

  [[nodiscard]] static std::uint64_t check_sum(std::span<const std::uint8_t> bytes) {
    Hash hash;
    for (const std::uint8_t byte : bytes) hash.add(byte);
    return hash.value();
  }

 private:
  template <class T>
  void put(const T& value) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      put_raw(&value, sizeof(T));
    } else {
      visit_fields(*this, value);
    }
  }
  template <class T>
  void put(const std::vector<T>& items) {
    put(items.size());
    if constexpr (std::is_trivially_copyable_v<T>) {
      put_raw(items.data(), items.size() * sizeof(T));
    } else {
      for (const T& item : items) put(item);
    }
  }
  void put(const std::string& text) {
    put(text.size());
    put_raw(text.data(), text.size());
  }
  template <class T>
    requires(!std::is_trivially_copyable_v<T>)
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  template <class Value, class Order>
  void put(const std::map<std::string, Value, Order>& entries) {
    put(entries.size());
    for (const auto& [name, value] : entries) (*this)(name, value);
  }
  void put_raw(const void* first, std::size_t size) {
    const auto* const bytes = static_cast<const std::uint8_t*>(first);
    bytes_.insert(bytes_.end(), bytes, bytes + size);
  }

  std::vector<std::uint8_t> bytes_;
};

/// Reads what a ByteWriter of the same build wrote. Throws std::invalid_argument on damaged bytes.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) {
    std::uint64_t sum = 0;
    const bool whole = bytes.size() >= sizeof(sum);
    rest_ = whole ? bytes.first(bytes.size() - sizeof(sum)) : bytes;
    if (whole) std::memcpy(&sum, bytes.data() + rest_.size(), sizeof(sum));
    if (!whole || sum != ByteWriter::check_sum(rest_)) throw std::invalid_argument("the bytes are damaged");
  }

  template <class... Values>
  void operator()(Values&... values) {
    (take(values), ...);
  }

 private:
  template <class T>
  void take(T& value) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      take_raw(&value, sizeof(T));
    } else {
      visit_fields(*this, value);
    }
  }
  template <class T>
  void take(std::vector<T>& items) {
    items.resize(take_size());
    if constexpr (std::is_trivially_copyable_v<T>) {
      take_raw(items.data(), items.size() * sizeof(T));
    } else {
      for (T& item : items) take(item);
    }
  }
  void take(std::string& text) {
    text.resize(take_size());
    take_raw(text.data(), text.size());
  }
  template <class T>
    requires(!std::is_trivially_copyable_v<T>)
  void take(std::optional<T>& value) {
    bool is_there = false;
    take(is_there);
    value.reset();
    if (is_there) take(value.emplace());
  }
  template <class Value, class Order>
  void take(std::map<std::string, Value, Order>& entries) {
    entries.clear();
    for (std::size_t left = take_size(); left > 0; --left) {
      std::pair<std::string, Value> entry{};
      (*this)(entry.first, entry.second);
      entries.insert(std::move(entry));
    }
  }
  [[nodiscard]] std::size_t take_size() {
    std::size_t size = 0;
    take(size);
    if (size > rest_.size()) throw std::invalid_argument("the bytes are of another build");
    return size;
  }
  void take_raw(void* to, std::size_t size) {
    if (size > rest_.size()) throw std::invalid_argument("the bytes are of another build");
    if (size > 0) std::memcpy(to, rest_.data(), size);
    rest_ = rest_.subspan(size);
  }

  std::span<const std::uint8_t> rest_;
};

}  // namespace manyhands
