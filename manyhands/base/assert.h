// Asserts: what the code around them guarantees, checked in the dev and sanitizer builds and gone with NDEBUG.
#pragma once

#ifdef NDEBUG
// The condition is compiled, never run.
#define MANYHANDS_ASSERT(...) static_cast<void>(sizeof(static_cast<bool>(__VA_ARGS__)))
#else
#include <cstdio>
#include <cstdlib>

namespace manyhands::internal {

/// Says what did not hold, and where, on stderr; then aborts.
[[noreturn]] inline void fail_assert(const char* file, int line, const char* condition) {
  std::fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, condition);
  std::abort();
}

}  // namespace manyhands::internal

/// Aborts with file, line and condition unless it holds.
#define MANYHANDS_ASSERT(...) \
  ((__VA_ARGS__) ? static_cast<void>(0) : ::manyhands::internal::fail_assert(__FILE__, __LINE__, #__VA_ARGS__))
#endif
