// Arrays of a fixed number of numbers from Python: what does not fit is remembered for the message.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>

#include <concepts>
#include <cstddef>

namespace manyhands::bindings {

/// The last argument that was no `expected` numbers, for `explain_refusals`.
struct RefusedVector {
  PyObject* value = nullptr;  // only to be compared with arguments that are alive
  std::size_t expected = 0;
};
inline thread_local RefusedVector refused_vector{};

}  // namespace manyhands::bindings

namespace nanobind::detail {

template <std::floating_point T, std::size_t n>
struct type_caster<std::array<T, n>> : array_caster<std::array<T, n>, T, n> {
  bool from_python(handle source, std::uint32_t flags, cleanup_list* cleanup) noexcept {
    const bool fits = array_caster<std::array<T, n>, T, n>::from_python(source, flags, cleanup);
    if (!fits) manyhands::bindings::refused_vector = {source.ptr(), n};
    return fits;
  }
};

}  // namespace nanobind::detail
