#include "manyhands/base/float_environment.h"

#if !defined(__x86_64__) && !defined(__aarch64__)
#include <cfenv>
#endif

namespace manyhands {

namespace {

// The control register of the vector unit, and those of its bits that say how to round and what becomes of denormals.
// What traps stays as it is.
#if defined(__x86_64__)
constexpr std::uint64_t kMode = 0xe040;  // flush to zero, rounding, denormals are zero
std::uint64_t control() { return __builtin_ia32_stmxcsr(); }
void set_control(std::uint64_t bits) { __builtin_ia32_ldmxcsr(static_cast<unsigned>(bits)); }
#elif defined(__aarch64__)
constexpr std::uint64_t kMode = 0x1c80000;  // FZ16, rounding, flush to zero
std::uint64_t control() {
  std::uint64_t bits;
  __asm__ volatile("mrs %0, fpcr" : "=r"(bits));
  return bits;
}
void set_control(std::uint64_t bits) { __asm__ volatile("msr fpcr, %0" : : "r"(bits)); }
#else
constexpr std::uint64_t kMode = ~std::uint64_t{0};
std::uint64_t control() { return static_cast<std::uint64_t>(std::fegetround()); }
void set_control(std::uint64_t bits) { std::fesetround(static_cast<int>(bits)); }
#endif

}  // namespace

FloatEnvironment::FloatEnvironment() : callers_(control()) {
  if ((callers_ & kMode) != 0) set_control(callers_ & ~kMode);
}

FloatEnvironment::~FloatEnvironment() {
  if ((callers_ & kMode) != 0) set_control((control() & ~kMode) | (callers_ & kMode));
}

}  // namespace manyhands
