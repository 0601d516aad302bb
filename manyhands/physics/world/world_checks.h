// Checks of what people hand to a World or a Batch; messages name the argument.
#pragma once

#include <span>
#include <stdexcept>
#include <string>

#include "manyhands/math/number.h"
#include "manyhands/math/vec3.h"
#include "manyhands/model/model.h"
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

/// Of n worlds, one row each.
template <Real R>
void require_rows(const std::string& name, std::span<const R> values, std::size_t n, std::size_t columns) {
  if (values.size() != n * columns) {
    throw std::invalid_argument(name + " has " + std::to_string(values.size()) + " numbers; expected " +
                                std::to_string(n) + " rows of " + std::to_string(columns));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (is_finite(values[i])) continue;
    throw std::invalid_argument(name + (n == 1 ? "" : " of world " + std::to_string(i / columns)) +
                                " has a number at " + std::to_string(i % columns) + " that is not finite");
  }
}

/// How far the length of a quaternion may be from 1: what single precision leaves of one after some arithmetic.
inline constexpr double kQuaternionTolerance = 1e-5;

/// Calls visit(the first index in q) for every quaternion of a configuration.
template <class Visit>
void for_each_quaternion(const Model& model, Visit&& visit) {
  for (const Body& body : model.bodies()) {
    if (body.type == JointType::kSpherical) visit(static_cast<std::size_t>(body.iq));
    if (body.type == JointType::kFloating) visit(static_cast<std::size_t>(body.iq + 3));
  }
}

/// The length of the quaternion at q[i]; throws std::invalid_argument unless it is 1 to kQuaternionTolerance. `array`
/// begins its place in the message, as in "q[".
template <Real R, class Q>
R require_unit_quaternion(const Q& q, std::size_t i, const std::string& array) {
  const R length = sqrt(q[i] * q[i] + q[i + 1] * q[i + 1] + q[i + 2] * q[i + 2] + q[i + 3] * q[i + 3]);
  if (abs(length - 1) <= static_cast<R>(kQuaternionTolerance)) return length;
  throw std::invalid_argument("the quaternion at " + array + std::to_string(i) + "] has length " +
                              std::to_string(length) + "; expected 1 (order x, y, z, w)");
}

/// Checks the quaternions of q (nq), and makes their length 1.
template <Real R>
void normalise_quaternions(const Model& model, std::span<R> q, const std::string& row = {}) {
  for_each_quaternion(model, [&](std::size_t i) {
    const R length = require_unit_quaternion<R>(q, i, "q[" + row);
    for (std::size_t k = i; k < i + 4; ++k) q[k] /= length;
  });
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
