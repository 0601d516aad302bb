#include "bindings/pybullet/arguments.h"

#include <climits>

#include "bindings/pybullet/clients.h"

namespace manyhands::pybullet {

PyObject* error_class = nullptr;

namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

}  // namespace

Signature::Signature(std::string_view text) {
  const std::string_view whole = text;
  const auto take = [&](std::string_view list) {
    int depth = 0;
    std::size_t begin = 0;
    for (std::size_t i = 0; i <= list.size(); ++i) {
      if (i < list.size() && (list[i] == '[' || list[i] == '(')) ++depth;
      if (i < list.size() && (list[i] == ']' || list[i] == ')')) --depth;
      if (i < list.size() && (list[i] != ',' || depth > 0)) continue;
      const std::string_view one = trimmed(list.substr(begin, i - begin));
      begin = i + 1;
      if (one.empty()) continue;
      const std::size_t equals = one.find('=');
      parameters_.push_back(
          {std::string(one.substr(0, equals)), equals == one.npos ? "" : std::string(one.substr(equals + 1))});
    }
  };
  const std::size_t bar = whole.find('|');
  take(whole.substr(0, bar));
  required_ = parameters_.size();
  if (bar != whole.npos) take(whole.substr(bar + 1));
  parameters_.push_back({"physicsClientId", "0"});
  for (const Parameter& p : parameters_) interned_.push_back(PyUnicode_InternFromString(p.name.c_str()));
}

int Signature::find(PyObject* name) const {
  for (std::size_t i = 0; i < interned_.size(); ++i) {
    if (interned_[i] == name) return static_cast<int>(i);
  }
  for (std::size_t i = 0; i < interned_.size(); ++i) {
    if (PyUnicode_Compare(interned_[i], name) == 0) return static_cast<int>(i);
  }
  const bool is_old = PyUnicode_CompareWithASCIIString(name, "bodyIndex") == 0;
  return is_old && parameters_[0].name == "bodyUniqueId" ? 0 : -1;
}

std::string Signature::text(const std::string& function) const {
  std::string all = function + "(";
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const Parameter& p = parameters_[i];
    all += (i > 0 ? ", " : "") + p.name;
    if (i >= required_) all += "=" + (p.fallback.empty() ? std::string("None") : p.fallback);
  }
  return all + ")\n--\n\n";
}

Arguments::Arguments(const char* function, const Signature& signature, PyObject* const* args, Py_ssize_t count,
                     PyObject* names)
    : function_(function) {
  const auto n = static_cast<std::size_t>(count);
  const std::size_t size = signature.parameters().size();
  if (n > size) {
    PyErr_Format(PyExc_TypeError, "%s() takes at most %zu arguments (%zu given)", function, size, n);
    throw PythonError{};
  }
  for (std::size_t i = 0; i < n; ++i) values_[i] = args[i];
  const Py_ssize_t named = names == nullptr ? 0 : PyTuple_Size(names);
  for (Py_ssize_t k = 0; k < named; ++k) {
    PyObject* const name = PyTuple_GetItem(names, k);
    const int i = signature.find(name);
    if (i < 0) {
      PyErr_Format(PyExc_TypeError, "'%U' is an invalid keyword argument for %s()", name, function);
      throw PythonError{};
    }
    if (values_[static_cast<std::size_t>(i)] != nullptr) {
      PyErr_Format(PyExc_TypeError, "argument for %s() given by name ('%U') and position (%d)", function, name, i + 1);
      throw PythonError{};
    }
    values_[static_cast<std::size_t>(i)] = args[count + k];
  }
  for (std::size_t i = 0; i < signature.required(); ++i) {
    if (values_[i] != nullptr) continue;
    PyErr_Format(PyExc_TypeError, "%s() missing required argument '%s' (pos %zu)", function,
                 signature.parameters()[i].name.c_str(), i + 1);
    throw PythonError{};
  }
}

double number_of(PyObject* object) {
  if (PyFloat_CheckExact(object)) return PyFloat_AsDouble(object);
  const double x = PyFloat_AsDouble(object);
  if (x == -1.0 && PyErr_Occurred() != nullptr) throw PythonError{};
  return x;
}

int integer_of(PyObject* object) {
  long x = 0;
  if (PyLong_CheckExact(object)) {
    x = PyLong_AsLong(object);
  } else {
    PyObject* const index = PyNumber_Index(object);
    if (index == nullptr) throw PythonError{};
    x = PyLong_AsLong(index);
    Py_DecRef(index);
  }
  if (x == -1 && PyErr_Occurred() != nullptr) {
    if (PyErr_ExceptionMatches(PyExc_OverflowError) == 0) throw PythonError{};
    PyErr_Clear();
    return -1;
  }
  if (x > INT_MAX || x < INT_MIN) {
    PyErr_SetString(PyExc_OverflowError, "signed integer is greater than maximum");
    throw PythonError{};
  }
  return static_cast<int>(x);
}

namespace {

/// A sequence's items while it is read.
class Items {
 public:
  explicit Items(PyObject* object) {
    if (object == nullptr || PyUnicode_Check(object) || PyBytes_Check(object)) return;
    list_ = PySequence_Check(object) != 0 ? PySequence_Fast(object, "expected a sequence") : nullptr;
    if (list_ == nullptr) PyErr_Clear();
  }
  Items(const Items&) = delete;
  Items& operator=(const Items&) = delete;
  ~Items() { Py_DecRef(list_); }

  [[nodiscard]] explicit operator bool() const { return list_ != nullptr; }
  [[nodiscard]] Py_ssize_t size() const { return PySequence_Size(list_); }
  /// Borrowed.
  [[nodiscard]] PyObject* operator[](Py_ssize_t i) const {
    return PyList_Check(list_) ? PyList_GetItem(list_, i) : PyTuple_GetItem(list_, i);
  }

 private:
  PyObject* list_ = nullptr;
};

}  // namespace

std::vector<double> numbers_of(PyObject* object) {
  const Items items(object);
  if (!items) {
    PyErr_SetString(PyExc_TypeError, "expected a sequence of numbers");
    throw PythonError{};
  }
  std::vector<double> numbers;
  const Py_ssize_t n = items.size();
  numbers.reserve(static_cast<std::size_t>(n));
  for (Py_ssize_t i = 0; i < n; ++i) numbers.push_back(number_of(items[i]));
  return numbers;
}

std::vector<double> one_or_more(PyObject* object) {
  if (object == nullptr || object == Py_None) return {};
  return PySequence_Check(object) != 0 ? numbers_of(object) : std::vector<double>{number_of(object)};
}

int Arguments::integer(std::size_t i) const { return integer_of(values_[i]); }
double Arguments::number(std::size_t i) const { return number_of(values_[i]); }

std::string Arguments::text(std::size_t i) const {
  if (PyUnicode_Check(values_[i]) == 0) {
    PyErr_Format(PyExc_TypeError, "%s() argument %zu must be str", function_, i + 1);
    throw PythonError{};
  }
  Py_ssize_t size = 0;
  const char* const text = PyUnicode_AsUTF8AndSize(values_[i], &size);
  if (text == nullptr) throw PythonError{};
  return {text, static_cast<std::size_t>(size)};
}

std::vector<double> Arguments::numbers(std::size_t i) const {
  return has(i) ? numbers_of(values_[i]) : std::vector<double>{};
}

std::vector<int> Arguments::integers(std::size_t i) const {
  std::vector<int> all;
  if (!has(i)) return all;
  const Items items(values_[i]);
  if (!items) {
    PyErr_Format(PyExc_TypeError, "%s() argument %zu must be a sequence of integers", function_, i + 1);
    throw PythonError{};
  }
  for (Py_ssize_t k = 0; k < items.size(); ++k) {
    PyObject* const item = items[k];
    all.push_back(PyFloat_Check(item) ? static_cast<int>(PyFloat_AsDouble(item)) : integer_of(item));
  }
  return all;
}

Vec3<double> Arguments::vec3(std::size_t i, const char* error) const {
  const Items items(values_[i]);
  if (!items || items.size() != 3) throw Error(error);
  const Vec3<double> v{number_of(items[0]), number_of(items[1]), number_of(items[2])};
  if (!is_finite(v.x) || !is_finite(v.y) || !is_finite(v.z))
    throw Error(std::string(error) + " It holds a number that is not finite.");
  return v;
}

Vec3<double> Arguments::vec3(std::size_t i, const Vec3<double>& fallback, const char* error) const {
  return has(i) ? vec3(i, error) : fallback;
}

Quat<double> Arguments::quaternion(std::size_t i, const char* error) const {
  const Items items(values_[i]);
  if (!items || items.size() != 4) throw Error(error);
  const Quat<double> r{number_of(items[0]), number_of(items[1]), number_of(items[2]), number_of(items[3])};
  const double length = r.x * r.x + r.y * r.y + r.z * r.z + r.w * r.w;
  if (!is_finite(length)) throw Error(std::string(error) + " It holds a number that is not finite.");
  return r;
}

Mat3<double> Arguments::rotation(std::size_t i, const char* error) const {
  if (!has(i)) return Mat3<double>::identity();
  const Quat<double> r = quaternion(i, error);
  const double length = r.x * r.x + r.y * r.y + r.z * r.z + r.w * r.w;
  return length > 1e-20 ? to_matrix(normalized(r)) : Mat3<double>::identity();
}

std::optional<double> Arguments::optional(std::size_t i) const {
  return has(i) ? std::optional(number(i)) : std::nullopt;
}

std::optional<Vec3<double>> Arguments::optional_vec3(std::size_t i, const char* error) const {
  return has(i) ? std::optional(vec3(i, error)) : std::nullopt;
}

std::vector<Vec3<double>> Arguments::points(std::size_t i, const char* error) const {
  std::vector<Vec3<double>> all;
  if (!has(i)) return all;
  const Items rows(values_[i]);
  if (!rows) throw Error(error);
  const Py_ssize_t n = rows.size();
  all.reserve(static_cast<std::size_t>(n));
  for (Py_ssize_t k = 0; k < n; ++k) {
    const Items row(rows[k]);
    if (!row || row.size() != 3) throw Error(error);
    all.push_back({number_of(row[0]), number_of(row[1]), number_of(row[2])});
  }
  return all;
}

// ---- results -------------------------------------------------------------------------------------------------------

PyObject* none() {
  Py_IncRef(Py_None);
  return Py_None;
}
PyObject* of(double x) { return PyFloat_FromDouble(x); }
PyObject* of(int x) { return PyLong_FromLong(x); }
PyObject* bytes(std::string_view text) {
  return PyBytes_FromStringAndSize(text.data(), static_cast<Py_ssize_t>(text.size()));
}
PyObject* of(const Vec3<double>& a) { return tuple(of(a.x), of(a.y), of(a.z)); }
PyObject* of(const Quat<double>& r) { return tuple(of(r.x), of(r.y), of(r.z), of(r.w)); }
PyObject* of(const Mat3<double>& R) { return of(normalized(to_quat(R))); }
PyObject* of(std::span<const double> numbers) {
  return tuple_of(numbers, [](double x) { return of(x); });
}

// ---- calls ---------------------------------------------------------------------------------------------------------

namespace {

template <class Run>
PyObject* guarded(const char* function, Run&& run) {
  try {
    return run();
  } catch (const PythonError&) {
    return nullptr;
  } catch (const Error& error) {
    PyErr_SetString(error_class, error.what());
  } catch (const std::bad_alloc&) {
    PyErr_NoMemory();
  } catch (const std::exception& error) {
    PyErr_Format(error_class, "%s: %s", function, error.what());
  }
  return nullptr;
}

}  // namespace

PyObject* call(const Function& function, const Signature& signature, PyObject* const* args, Py_ssize_t count,
               PyObject* names) {
  return guarded(function.name, [&] {
    const Arguments arguments(function.name, signature, args, count, names);
    const ClientLock client(arguments.integer(signature.parameters().size() - 1, 0));
    return function.run(*client, arguments);
  });
}

PyObject* call(const FreeFunction& function, const Signature& signature, PyObject* const* args, Py_ssize_t count,
               PyObject* names) {
  return guarded(function.name, [&] { return function.run(Arguments(function.name, signature, args, count, names)); });
}

}  // namespace manyhands::pybullet
