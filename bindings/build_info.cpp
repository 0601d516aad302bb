// How this build of the library was made.
#include <nanobind/nanobind.h>

#include "bindings/bindings.h"
#include "manyhands/math/instantiate.h"

namespace nb = nanobind;

#define MANYHANDS_TEXT_OF(number) #number
#define MANYHANDS_TEXT(macro) MANYHANDS_TEXT_OF(macro)

namespace manyhands {

namespace {

constexpr const char* kCompiler =
#if defined(__clang__)
    "Clang " MANYHANDS_TEXT(__clang_major__) "." MANYHANDS_TEXT(__clang_minor__);
#else
    "GCC " __VERSION__;
#endif

}  // namespace

void bind_build_info(nb::module_& m) {
  m.def(
      "build_info",
      [] {
        nb::dict info;
        info["isa"] = MANYHANDS_ISA;
        info["lanes"] = width_v<NativeLanes>;
        info["compiler"] = kCompiler;
        return info;
      },
      nb::sig("def build_info() -> dict[str, typing.Any]"), "How the library was built; see manyhands.build_info.");
}

}  // namespace manyhands
