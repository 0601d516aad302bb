// The extension module manyhands._processor: which instruction sets the processor has. It is compiled for any
// processor, so that it can say so where manyhands._core would not run.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <string>
#include <vector>

#if defined(__x86_64__) || defined(_M_X64)
#if defined(_MSC_VER)
#include <intrin.h>
#else
#include <cpuid.h>
#endif
#endif

namespace manyhands {

namespace {

#if defined(__x86_64__) || defined(_M_X64)

struct Registers {
  std::uint32_t a = 0, b = 0, c = 0, d = 0;
};

Registers cpuid(std::uint32_t leaf) {
  Registers r;
#if defined(_MSC_VER)
  int values[4];
  __cpuidex(values, static_cast<int>(leaf), 0);
  r = {std::uint32_t(values[0]), std::uint32_t(values[1]), std::uint32_t(values[2]), std::uint32_t(values[3])};
#else
  __get_cpuid_count(leaf, 0, &r.a, &r.b, &r.c, &r.d);
#endif
  return r;
}

/// The registers that the operating system saves for each thread: XCR0.
std::uint64_t saved_registers() {
#if defined(_MSC_VER)
  return _xgetbv(0);
#else
  std::uint32_t low = 0, high = 0;
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return std::uint64_t{high} << 32 | low;
#endif
}

constexpr std::uint32_t bits(std::initializer_list<int> numbers) {
  std::uint32_t mask = 0;
  for (const int number : numbers) mask |= std::uint32_t{1} << number;
  return mask;
}

bool has_all(std::uint64_t value, std::uint64_t mask) { return (value & mask) == mask; }

/// The levels of the x86-64 psABI (section 3.1.1) that have AVX2 and AVX-512, best first.
std::vector<std::string> instruction_sets() {
  constexpr std::uint32_t kBasic = bits({0, 9, 12, 13, 19, 20, 22, 23, 27, 28, 29});  // SSE3 to SSE4.2, FMA, AVX, F16C
  constexpr std::uint32_t kAvx2 = bits({3, 5, 8}), kLzcnt = bits({0, 5});             // with BMI1, BMI2; LAHF
  constexpr std::uint32_t kAvx512 = bits({16, 17, 28, 30, 31});                       // F, DQ, CD, BW, VL
  constexpr std::uint64_t kYmm = bits({1, 2}), kZmm = bits({1, 2, 5, 6, 7});
  std::vector<std::string> found;
  const std::uint32_t more = cpuid(7).b;
  if (!has_all(cpuid(1).c, kBasic) || !has_all(cpuid(0x80000001).c, kLzcnt) || !has_all(more, kAvx2)) return found;
  const std::uint64_t saved = saved_registers();
  if (has_all(more, kAvx512) && has_all(saved, kZmm)) found.emplace_back("x86-64-v4");
  if (has_all(saved, kYmm)) found.emplace_back("x86-64-v3");
  return found;
}

#else

std::vector<std::string> instruction_sets() { return {"armv8"}; }

#endif

}  // namespace

}  // namespace manyhands

NB_MODULE(_processor, m) {
  m.doc() = "What the processor can do.";
  m.def("instruction_sets", &manyhands::instruction_sets,
        "The instruction sets of this processor for which the library can be built, best first.");
}
