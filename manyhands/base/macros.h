// The few attributes that the numeric kernels need.
#pragma once

/// Small numeric functions are inlined even in debug builds: a call for every addition would hide the arithmetic.
#define MANYHANDS_INLINE inline __attribute__((always_inline))

/// Hides from the optimiser how the value of a floating-point register came about; costs no instruction.
#if defined(__x86_64__)
#define MANYHANDS_OPAQUE(x) __asm__("" : "+v"(x))
#elif defined(__aarch64__)
#define MANYHANDS_OPAQUE(x) __asm__("" : "+w"(x))
#else
#define MANYHANDS_OPAQUE(x) static_cast<void>(x)
#endif
