// Eigen as the learner uses it: products on the calling thread only, so that results do not depend on a thread count.
#pragma once

#define EIGEN_DONT_PARALLELIZE

// GCC 12's own AVX-512 intrinsics start from an undefined register and warn about it wherever they are inlined.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <Eigen/Core>
#pragma GCC diagnostic pop
