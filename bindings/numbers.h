// Numbers from Python for calls of a few microseconds: arrays by the buffer protocol, lists one by one. nanobind's own
// arrays come by DLPack, whose calls into Python take as long as a solve.
#pragma once

#include <nanobind/nanobind.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

namespace manyhands::bindings {

/// What was given as doubles in rows, one after the other. Raises Python's ValueError, which names it, for what is no
/// real numbers, and for NaN and infinities in lists.
class Numbers {
 public:
  Numbers(const char* name, nanobind::handle given) {
    if (!take_list(given) && !take_buffer(given)) {
      converted_ = nanobind::module_::import_("manyhands.arguments").attr("finite_rows")(name, given);
      converted_ = nanobind::module_::import_("numpy").attr("ascontiguousarray")(converted_);
      if (!take_buffer(converted_)) throw nanobind::python_error();
    }
  }
  Numbers(const Numbers&) = delete;
  Numbers& operator=(const Numbers&) = delete;
  ~Numbers() {
    if (view_.obj != nullptr) PyBuffer_Release(&view_);
  }

  [[nodiscard]] std::size_t ndim() const { return shape_.size(); }
  [[nodiscard]] std::size_t shape(std::size_t i) const { return shape_[i]; }
  [[nodiscard]] const double* data() const { return data_; }
  [[nodiscard]] std::size_t size() const {
    std::size_t n = 1;
    for (const std::size_t extent : shape_) n *= extent;
    return n;
  }

 private:
  bool take_list(nanobind::handle given) {
    const bool is_list = PyList_Check(given.ptr()) != 0;
    if (!is_list && PyTuple_Check(given.ptr()) == 0) return false;
    const Py_ssize_t n = is_list ? PyList_Size(given.ptr()) : PyTuple_Size(given.ptr());
    own_.reserve(static_cast<std::size_t>(n));
    for (Py_ssize_t i = 0; i < n; ++i) {
      PyObject* const item = is_list ? PyList_GetItem(given.ptr(), i) : PyTuple_GetItem(given.ptr(), i);
      if (PyFloat_Check(item) == 0 && PyLong_Check(item) == 0) return false;
      const double x = PyFloat_AsDouble(item);
      if (!std::isfinite(x) || PyErr_Occurred() != nullptr) {
        PyErr_Clear();
        return false;
      }
      own_.push_back(x);
    }
    data_ = own_.data();
    shape_ = {own_.size()};
    return true;
  }

  bool take_buffer(nanobind::handle given) {
    if (PyObject_CheckBuffer(given.ptr()) == 0) return false;
    if (PyObject_GetBuffer(given.ptr(), &view_, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) != 0) {
      PyErr_Clear();
      return false;
    }
    if (view_.format == nullptr || std::strcmp(view_.format, "d") != 0) {
      PyBuffer_Release(&view_);
      return false;
    }
    data_ = static_cast<const double*>(view_.buf);
    for (int i = 0; i < view_.ndim; ++i) shape_.push_back(static_cast<std::size_t>(view_.shape[i]));
    return true;
  }

  nanobind::object converted_;
  Py_buffer view_{};
  std::vector<double> own_;
  std::vector<std::size_t> shape_;
  const double* data_ = nullptr;
};

/// A new array of doubles.
[[nodiscard]] inline nanobind::object new_array(const std::vector<double>& numbers) {
  static const nanobind::handle empty = nanobind::object(nanobind::module_::import_("numpy").attr("empty")).release();
  const nanobind::object array = empty(numbers.size());
  Py_buffer view;
  if (PyObject_GetBuffer(array.ptr(), &view, PyBUF_C_CONTIGUOUS | PyBUF_WRITABLE) != 0) throw nanobind::python_error();
  if (!numbers.empty()) std::memcpy(view.buf, numbers.data(), numbers.size() * sizeof(double));
  PyBuffer_Release(&view);
  return array;
}

}  // namespace manyhands::bindings
