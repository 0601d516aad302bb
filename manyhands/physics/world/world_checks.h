// Checks of what people hand to a World or a Batch; messages name the argument.
#pragma once

#include <span>
#include <stdexcept>
#include <string>

#include "manyhands/math/number.h"
#include "manyhands/math/vec3.h"
#include "manyhands/physics/contact/contact_solver.h"

namespace manyhands::internal {

template <Real R>
void require_size(const std::string& name, std::span<const R> values, std::size_t size) {
  if (values.size() == size) return;
  throw std::invalid_argument(name + " has shape (" + std::to_string(values.size()) + ",); expected (" +
                              std::to_string(size) + ",)");
}

template <Real R>
void require_finite(const std::string& name, std::span<const R> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!is_finite(values[i])) throw std::invalid_argument(name + "[" + std::to_string(i) + "] is not a finite number");
  }
}

template <Real R>
void require_numbers(const std::string& name, std::span<const R> values, std::size_t size) {
  require_size(name, values, size);
  require_finite(name, values);
}

template <Real R>
void require_not_negative(const std::string& name, std::span<const R> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] >= 0))
      throw std::invalid_argument(name + "[" + std::to_string(i) + "] is negative; expected 0 or more");
  }
}

inline void require_vector(const std::string& name, const Vec3<double>& a) {
  require_finite<double>(name, std::span(&a.x, 3));
}

inline void require_pose(const std::string& name, const Transform<double>& X) {
  require_vector(name + "'s position", X.p);
  require_finite<double>(name + "'s rotation", std::span(&X.R.x.x, 9));
}

inline void require_time_step(double time_step) {
  if (time_step > 0 && is_finite(time_step)) return;
  throw std::invalid_argument("time_step is " + std::to_string(time_step) + " s; expected a finite number above 0");
}

/// Throws std::invalid_argument unless max_iterations is 1 or more and the tolerance 0 or more.
inline void require_solver(const SolverSettings& settings) {
  if (settings.max_iterations < 1) {
    throw std::invalid_argument("max_iterations is " + std::to_string(settings.max_iterations) +
                                "; expected 1 or more");
  }
  if (!(settings.tolerance >= 0) || !is_finite(settings.tolerance)) {
    throw std::invalid_argument("tolerance is " + std::to_string(settings.tolerance) + "; expected 0 or more");
  }
}

}  // namespace manyhands::internal
