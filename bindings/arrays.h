// Spans as numpy arrays.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

namespace manyhands::bindings {

/// A C-contiguous array given from Python, converted if need be.
template <class T, std::size_t dims>
using Array = nanobind::ndarray<const T, nanobind::ndim<dims>, nanobind::c_contig, nanobind::device::cpu>;

template <class T, class... Options>
[[nodiscard]] std::span<const T> as_span(const nanobind::ndarray<const T, Options...>& array) {
  return {array.data(), array.size()};
}

/// A new numpy array of its own memory.
template <class T>
[[nodiscard]] nanobind::object copied(const T* data, std::initializer_list<std::size_t> shape) {
  nanobind::ndarray<nanobind::numpy, T> array(const_cast<T*>(data), shape.size(), shape.begin());
  return nanobind::cast(array, nanobind::rv_policy::copy);
}

/// A read-only numpy array over memory that `owner` keeps alive.
template <class T>
[[nodiscard]] nanobind::object viewed(const T* data, std::initializer_list<std::size_t> shape, nanobind::handle owner) {
  nanobind::ndarray<nanobind::numpy, const T> array(data, shape.size(), shape.begin(), owner);
  return nanobind::cast(array, nanobind::rv_policy::reference);
}

/// Bytes 0 and 1 as a numpy array of bool.
[[nodiscard]] inline nanobind::object copied_bools(std::span<const unsigned char> bytes) {
  static_assert(sizeof(bool) == 1);
  return copied(reinterpret_cast<const bool*>(bytes.data()), {bytes.size()});
}

[[nodiscard]] inline nanobind::bytes as_bytes(std::span<const std::uint8_t> bytes) {
  return nanobind::bytes(bytes.data(), bytes.size());
}

[[nodiscard]] inline std::span<const std::uint8_t> as_bytes(const nanobind::bytes& bytes) {
  return {static_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

}  // namespace manyhands::bindings
