// Rounding modes and flushing of denormals, as another library might leave them.
#pragma once

#include <cfenv>
#include <cstdint>

namespace manyhands::testing {

/// Set while it lives.
class FloatModes {
 public:
#if defined(__x86_64__)
  static constexpr bool kCanFlush = true;
#else
  static constexpr bool kCanFlush = false;
#endif

  FloatModes(int rounding, bool flush_denormals) : rounding_(std::fegetround()), flush_(flush_denormals) {
    std::fesetround(rounding);
    if (flush_) set_flushing(true);
  }
  ~FloatModes() {
    if (flush_) set_flushing(false);
    std::fesetround(rounding_);
  }
  FloatModes(const FloatModes&) = delete;
  FloatModes& operator=(const FloatModes&) = delete;

 private:
  static void set_flushing([[maybe_unused]] bool on) {
#if defined(__x86_64__)
    constexpr std::uint32_t kFlush = 0x8040;  // FTZ, DAZ
    __builtin_ia32_ldmxcsr((__builtin_ia32_stmxcsr() & ~kFlush) | (on ? kFlush : 0));
#endif
  }

  int rounding_;
  bool flush_;
};

}  // namespace manyhands::testing
