// Arrays of states from Python, one row or many, and arrays of results with the same rows.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "bindings/model/python_model.h"

namespace manyhands::bindings {

template <class R>
using Input = nanobind::ndarray<const R, nanobind::c_contig, nanobind::device::cpu>;
template <class R>
using Output = nanobind::ndarray<nanobind::numpy, R>;

[[nodiscard]] inline std::size_t size(int n) { return static_cast<std::size_t>(n); }

/// How many states a call is about, and whether they came as a single row.
struct Batch {
  std::size_t n;
  bool single;
};

template <class Numbers>
[[nodiscard]] std::string shape_of(const Numbers& array) {
  std::string text = "(";
  for (std::size_t i = 0; i < array.ndim(); ++i) text += (i > 0 ? ", " : "") + std::to_string(array.shape(i));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

template <class R>
[[nodiscard]] Batch batch_of(const Input<R>& q, std::size_t nq) {
  if (q.ndim() == 1 && q.shape(0) == nq) return {1, true};
  if (q.ndim() == 2 && q.shape(1) == nq) return {q.shape(0), false};
  const std::string width = std::to_string(nq);
  throw std::invalid_argument("q has shape " + shape_of(q) + "; expected (" + width + ",) or (n, " + width + ")");
}

template <class R>
[[nodiscard]] std::span<const R> rows(const char* name, const Input<R>& array, const Batch& batch,
                                      std::size_t columns) {
  const bool fits = batch.single ? array.ndim() == 1 && array.shape(0) == columns
                                 : array.ndim() == 2 && array.shape(0) == batch.n && array.shape(1) == columns;
  if (fits) return {array.data(), array.size()};
  const std::string width = std::to_string(columns);
  const std::string expected = batch.single ? "(" + width + ",)" : "(" + std::to_string(batch.n) + ", " + width + ")";
  throw std::invalid_argument(std::string(name) + " has shape " + shape_of(array) + "; expected " + expected +
                              ", as q has " + (batch.single ? "one dimension" : std::to_string(batch.n) + " rows"));
}

/// A new array (n, inner...), or (inner...) for a single row.
template <class R>
class Result {
 public:
  Result(const Batch& batch, std::initializer_list<std::size_t> inner) {
    if (!batch.single) shape_.push_back(batch.n);
    shape_.insert(shape_.end(), inner);
    size_ = 1;
    for (const std::size_t extent : shape_) size_ *= extent;
    data_ = std::make_unique<R[]>(size_);
  }

  [[nodiscard]] std::span<R> span() { return {data_.get(), size_}; }

  [[nodiscard]] Output<R> array() {
    R* const data = data_.release();
    // NOLINTNEXTLINE(cppcoreguidelines-owning-memory): the array's capsule owns it
    const nanobind::capsule owner(data, [](void* p) noexcept { delete[] static_cast<R*>(p); });
    return Output<R>(data, shape_.size(), shape_.data(), owner);
  }

 private:
  std::vector<std::size_t> shape_;
  std::size_t size_;
  std::unique_ptr<R[]> data_;
};

/// Runs `body(dynamics)` without the interpreter's lock.
template <Real R, class Body>
void run(PythonModel& model, int width, Body&& body) {
  const nanobind::gil_scoped_release release;
  model.pool<R>().use(width, body);
}

/// Whether no number is NaN or infinite: without branches, so that vectors are looked at.
template <class R>
[[nodiscard]] bool all_finite(std::span<const R> numbers) {
  constexpr R kLargest = std::numeric_limits<R>::max();
  int others = 0;
  for (const R x : numbers) others |= std::abs(x) <= kLargest ? 0 : 1;
  return others == 0;
}

/// Throws std::invalid_argument, which says where, if a number is NaN or infinite.
template <class Numbers>
void require_finite(const char* name, const Numbers& array) {
  if (all_finite(std::span(array.data(), array.size()))) return;
  for (std::size_t i = 0; i < array.size(); ++i) {
    if (std::isfinite(array.data()[i])) continue;
    const std::size_t columns = array.shape(array.ndim() - 1);
    const std::string row = array.ndim() > 1 ? ", row " + std::to_string(i / columns) : "";
    throw std::invalid_argument(std::string(name) + " is " + std::to_string(array.data()[i]) + " at index " +
                                std::to_string(i % columns) + row + "; expected finite numbers");
  }
}

/// Below this length a vector or quaternion has no direction.
inline constexpr double kShortest = 1e-6;
[[noreturn]] inline void refuse_short(const std::string& what) {
  throw std::invalid_argument(what + " is shorter than 1e-06, which leaves its direction open");
}
/// Throws std::invalid_argument if the quaternion (4) leaves its direction open.
template <class R>
void require_rotation(const R* r) {
  if (!(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3] >= R(kShortest) * R(kShortest)))
    refuse_short("a quaternion");
}

/// As `rows`, of finite numbers.
template <class R>
[[nodiscard]] std::span<const R> finite_rows(const char* name, const Input<R>& array, const Batch& batch,
                                             std::size_t columns) {
  const std::span<const R> numbers = rows(name, array, batch, columns);
  require_finite(name, array);
  return numbers;
}

}  // namespace manyhands::bindings
