// How the functions of manyhands.pybullet take their arguments and give their results, over CPython's own API: they
// must be built-in functions, which PyBullet's clients look for.
#pragma once

#include <Python.h>

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "manyhands/bullet/client.h"
#include "manyhands/math/quaternion.h"

namespace manyhands::pybullet {

using bullet::Client;
using bullet::Error;

/// Python has raised an exception already.
struct PythonError {};

/// The parameters of a function: "bodyUniqueId, jointIndex | flags=0", those behind the bar being optional.
class Signature {
 public:
  explicit Signature(std::string_view text);

  struct Parameter {
    std::string name, fallback;
  };
  [[nodiscard]] const std::vector<Parameter>& parameters() const { return parameters_; }
  [[nodiscard]] std::size_t required() const { return required_; }
  /// The number of a parameter, or -1; "bodyIndex" is an old name for the first.
  [[nodiscard]] int find(PyObject* name) const;
  /// As Python writes it, for inspect.signature.
  [[nodiscard]] std::string text(const std::string& function) const;

 private:
  std::vector<Parameter> parameters_;
  std::vector<PyObject*> interned_;
  std::size_t required_ = 0;
};

/// The arguments of one call by their position in the signature. What was not given, or is None where that may be, is
/// unset.
class Arguments {
 public:
  static constexpr std::size_t kMost = 40;

  Arguments(const char* function, const Signature& signature, PyObject* const* args, Py_ssize_t count, PyObject* names);

  [[nodiscard]] bool has(std::size_t i) const { return values_[i] != nullptr && values_[i] != Py_None; }
  [[nodiscard]] PyObject* object(std::size_t i) const { return values_[i]; }
  [[nodiscard]] int integer(std::size_t i) const;
  [[nodiscard]] int integer(std::size_t i, int fallback) const { return has(i) ? integer(i) : fallback; }
  [[nodiscard]] double number(std::size_t i) const;
  [[nodiscard]] double number(std::size_t i, double fallback) const { return has(i) ? number(i) : fallback; }
  [[nodiscard]] std::string text(std::size_t i) const;
  [[nodiscard]] std::string text(std::size_t i, const char* fallback) const { return has(i) ? text(i) : fallback; }
  /// Any sequence of numbers; raises Error with `what` unless there are n.
  [[nodiscard]] std::vector<double> numbers(std::size_t i) const;
  [[nodiscard]] std::vector<int> integers(std::size_t i) const;
  [[nodiscard]] Vec3<double> vec3(std::size_t i, const char* error) const;
  [[nodiscard]] Vec3<double> vec3(std::size_t i, const Vec3<double>& fallback, const char* error) const;
  [[nodiscard]] Quat<double> quaternion(std::size_t i, const char* error) const;
  [[nodiscard]] Mat3<double> rotation(std::size_t i, const char* error) const;  ///< the identity if unset
  [[nodiscard]] std::optional<double> optional(std::size_t i) const;
  [[nodiscard]] std::optional<Vec3<double>> optional_vec3(std::size_t i, const char* error) const;
  [[nodiscard]] std::vector<Vec3<double>> points(std::size_t i, const char* error) const;

 private:
  const char* function_;
  std::array<PyObject*, kMost> values_{};  // borrowed
};

[[nodiscard]] double number_of(PyObject* object);
[[nodiscard]] int integer_of(PyObject* object);
/// The numbers of any sequence; sets `ok` to false, and no exception, if it is none.
[[nodiscard]] std::vector<double> numbers_of(PyObject* object);
/// The numbers of a number or a sequence; none of null and None.
[[nodiscard]] std::vector<double> one_or_more(PyObject* object);

// ---- results: new references ---------------------------------------------------------------------------------------

[[nodiscard]] PyObject* none();
[[nodiscard]] PyObject* of(double x);
[[nodiscard]] PyObject* of(int x);
[[nodiscard]] PyObject* bytes(std::string_view text);
[[nodiscard]] PyObject* of(const Vec3<double>& a);
[[nodiscard]] PyObject* of(const Quat<double>& r);
[[nodiscard]] PyObject* of(const Mat3<double>& R);  ///< as a quaternion
[[nodiscard]] PyObject* of(std::span<const double> numbers);
/// A tuple that owns the items.
template <class... Items>
[[nodiscard]] PyObject* tuple(Items... items) {
  PyObject* const all = PyTuple_New(sizeof...(items));
  Py_ssize_t i = 0;
  (PyTuple_SetItem(all, i++, items), ...);
  return all;
}
/// A tuple of what `make` makes of each.
template <class Range, class Make>
[[nodiscard]] PyObject* tuple_of(const Range& range, Make&& make) {
  PyObject* const all = PyTuple_New(static_cast<Py_ssize_t>(std::size(range)));
  Py_ssize_t i = 0;
  for (const auto& item : range) PyTuple_SetItem(all, i++, make(item));
  return all;
}

// ---- functions -----------------------------------------------------------------------------------------------------

/// A function of the module. Its last parameter, physicsClientId, goes without saying.
struct Function {
  const char* name;
  const char* signature;
  const char* doc;
  PyObject* (*run)(Client&, const Arguments&);
};

/// The same for functions that need no connection.
struct FreeFunction {
  const char* name;
  const char* signature;
  const char* doc;
  PyObject* (*run)(const Arguments&);
};

/// Calls a function, with exceptions of C++ as Python's.
PyObject* call(const Function& function, const Signature& signature, PyObject* const* args, Py_ssize_t count,
               PyObject* names);
PyObject* call(const FreeFunction& function, const Signature& signature, PyObject* const* args, Py_ssize_t count,
               PyObject* names);

template <const auto& kFunction>
const Signature& signature_of() {
  static const Signature signature(std::string(kFunction.signature));
  return signature;
}

template <const auto& kFunction>
PyObject* entry(PyObject*, PyObject* const* args, Py_ssize_t count, PyObject* names) {
  return call(kFunction, signature_of<kFunction>(), args, count, names);
}

/// Adds a function to the list that the module is made of.
template <const auto& kFunction>
void add_to(std::vector<PyMethodDef>& methods) {
  static const std::string doc = signature_of<kFunction>().text(kFunction.name) + kFunction.doc;
  methods.push_back({kFunction.name, reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(&entry<kFunction>)),
                     METH_FASTCALL | METH_KEYWORDS, doc.c_str()});
}

using Methods = std::vector<PyMethodDef>;
void add_connection(Methods& methods);
void add_bodies(Methods& methods);
void add_states(Methods& methods);
void add_motors(Methods& methods);
void add_dynamics(Methods& methods);
void add_constraints(Methods& methods);
void add_kinematics(Methods& methods);
void add_collision(Methods& methods);
void add_shapes(Methods& methods);
void add_looks(Methods& methods);
void add_debug(Methods& methods);
void add_mathematics(Methods& methods);
void add_extras(Methods& methods);
void add_convex(Methods& methods);
void add_refusals(Methods& methods);
void add_constants(PyObject* module);

/// The viewer's camera for OpenGL.
struct ScreenMatrices {
  std::array<double, 16> view, projection;  ///< by columns
  Vec3<double> forward, right, up;          ///< of length 1
};
[[nodiscard]] ScreenMatrices screen_matrices(const bullet::Screen& screen);

/// The module's exception class, pybullet.error.
extern PyObject* error_class;

}  // namespace manyhands::pybullet
