// Pickling and copying: values as bytes, which say by a check sum whether they are whole.
#pragma once

#include <nanobind/nanobind.h>

#include <functional>
#include <span>

#include "bindings/arrays.h"
#include "manyhands/base/bytes.h"

namespace manyhands::bindings {

/// `archived(const Value&)` gives the bytes, `unarchived(bytes)` the value.
template <class Bound, class Archived, class Unarchived>
void pickle_by(Bound& bound, Archived archived, Unarchived unarchived) {
  using Value = typename Bound::Type;
  bound.def("__getstate__", [archived](const Value& self) { return as_bytes(std::invoke(archived, self)); })
      .def(
          "__setstate__",
          [unarchived](Value& self, const nanobind::bytes& state) { new (&self) Value(unarchived(as_bytes(state))); },
          nanobind::arg("state"));
}

/// For values that an archive takes as they are or by their fields; `require` throws on those that cannot be.
template <class Bound, class Require>
void pickle_by_fields(Bound& bound, Require require) {
  using Value = typename Bound::Type;
  pickle_by(
      bound,
      [](const Value& value) {
        ByteWriter out;
        out(value);
        return out.finish();
      },
      [require](std::span<const std::uint8_t> bytes) {
        Value value;
        ByteReader in(bytes);
        in(value);
        require(value);
        return value;
      });
}

}  // namespace manyhands::bindings
