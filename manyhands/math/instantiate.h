// The closed list of number types for which the physics is instantiated.
#pragma once

#include "manyhands/math/lanes.h"

namespace manyhands {

using Lanes4 = Lanes<float, 4>;
using Lanes8 = Lanes<float, 8>;
using Lanes16 = Lanes<float, 16>;

/// The lane type that runs fastest on the instruction set of this build. Programs other than the tests are linked with
/// the kernels of no other (cmake: manyhands_other_lanes), so what makes those is declared MANYHANDS_LANES<W>: weak, of
/// address null where it is not linked in. `for_width` (for_width.h) chooses among those that are there.
#if defined(__AVX512F__)
using NativeLanes = Lanes16;
#define MANYHANDS_LANES4 [[gnu::weak]]
#define MANYHANDS_LANES8 [[gnu::weak]]
#define MANYHANDS_LANES16
#elif defined(__AVX__)
using NativeLanes = Lanes8;
#define MANYHANDS_LANES4 [[gnu::weak]]
#define MANYHANDS_LANES8
#define MANYHANDS_LANES16 [[gnu::weak]]
#else
using NativeLanes = Lanes4;
#define MANYHANDS_LANES4
#define MANYHANDS_LANES8 [[gnu::weak]]
#define MANYHANDS_LANES16 [[gnu::weak]]
#endif

}  // namespace manyhands

#define MANYHANDS_FOR_EACH_NUMBER(macro) \
  macro(double) macro(float) macro(manyhands::Lanes4) macro(manyhands::Lanes8) macro(manyhands::Lanes16)

/// Calls macro(prefix, state's type, parameters' type) for each lane type: every world has parameters of its own, or
/// all share one set.
#define MANYHANDS_FOR_LANES(macro, prefix, Lanes) macro(prefix, Lanes, Lanes) macro(prefix, Lanes, float)
#define MANYHANDS_FOR_ALL_LANES(macro, prefix) \
  MANYHANDS_FOR_LANES(macro, prefix, Lanes4)   \
  MANYHANDS_FOR_LANES(macro, prefix, Lanes8)   \
  MANYHANDS_FOR_LANES(macro, prefix, Lanes16)
