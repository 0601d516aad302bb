// The few attributes that the numeric kernels need.
#pragma once

/// Small numeric functions are inlined even in debug builds: a call for every addition would hide the arithmetic.
#define MANYHANDS_INLINE inline __attribute__((always_inline))
