// Messages for arguments that do not fit a bound function. nanobind has no hook for its own, which list signatures and
// types alone, so calls pass through here and what it refuses is told by manyhands.refusals.
#include <array>
#include <string_view>
#include <utility>

#include "bindings/bindings.h"
#include "bindings/vectors.h"

namespace nb = nanobind;

namespace manyhands {

namespace {

constexpr std::size_t kMostKinds = 8;  // nanobind calls functions in six ways, by the kinds of their arguments
std::array<vectorcallfunc, kMostKinds> nanobinds_calls{};

/// Behind the head of nanobind's objects: the stable ABI does not tell the type's offset.
vectorcallfunc& call_of(PyObject* function) {
  return *reinterpret_cast<vectorcallfunc*>(reinterpret_cast<char*>(function) + sizeof(PyVarObject));
}

/// How many of `args` came by position; nanobind keeps marks in the upper bits of that number.
std::size_t positional(std::size_t nargsf) { return nargsf & 0xffffffff; }

/// The error that says what was wrong, or an invalid object if it is not known.
nb::object told(nb::handle function, PyObject* const* args, std::size_t n, nb::handle names) {
  nb::list given;
  nb::dict named;
  for (std::size_t i = 0; i < n; ++i) given.append(nb::handle(args[i]));
  const std::size_t num_named = names.is_valid() ? nb::len(names) : 0;
  for (std::size_t i = 0; i < num_named; ++i) named[names[i]] = nb::handle(args[n + i]);
  const bindings::RefusedVector refused = std::exchange(bindings::refused_vector, {});
  nb::object vector = nb::none();
  for (std::size_t i = 0; i < n + num_named; ++i) {
    if (args[i] == refused.value) vector = nb::make_tuple(nb::handle(args[i]), refused.expected);
  }
  return nb::module_::import_("manyhands.refusals").attr("refusal")(function, given, named, vector);
}

/// Replaces nanobind's error by ours; any other stays.
void tell(PyObject* function, PyObject* const* args, std::size_t nargsf, PyObject* names) noexcept {
  try {
    nb::python_error original;
    if (std::string_view(original.what()).find("incompatible function arguments") == std::string_view::npos) {
      original.restore();
      return;
    }
    try {
      const nb::object error = told(function, args, positional(nargsf), names);
      PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
    } catch (nb::python_error&) {
      original.restore();
    }
  } catch (const std::exception& e) {
    PyErr_SetString(PyExc_TypeError, e.what());
  }
}

template <std::size_t kind>
PyObject* call(PyObject* function, PyObject* const* args, std::size_t nargsf, PyObject* names) noexcept {
  PyObject* const result = nanobinds_calls[kind](function, args, nargsf, names);
  if (result == nullptr && PyErr_ExceptionMatches(PyExc_TypeError)) tell(function, args, nargsf, names);
  return result;
}

template <std::size_t... kinds>
constexpr std::array<vectorcallfunc, sizeof...(kinds)> all_calls(std::index_sequence<kinds...>) {
  return {&call<kinds>...};
}
constexpr auto kCalls = all_calls(std::make_index_sequence<kMostKinds>());

void redirect(PyObject* function) {
  vectorcallfunc& present = call_of(function);
  for (std::size_t kind = 0; kind < kMostKinds; ++kind) {
    if (present == kCalls[kind]) return;
    if (nanobinds_calls[kind] == nullptr) nanobinds_calls[kind] = present;
    if (nanobinds_calls[kind] == present) {
      present = kCalls[kind];
      return;
    }
  }
}

void redirect_all(nb::handle scope) {
  for (const auto [name, member] : nb::steal<nb::dict>(PyObject_CallFunction(
           reinterpret_cast<PyObject*>(&PyDict_Type), "O", nb::object(scope.attr("__dict__")).ptr()))) {
    if (nb::hasattr(member, "__nb_signature__")) {
      redirect(member.ptr());
    } else if (nb::isinstance<nb::module_>(member) || PyType_Check(member.ptr())) {
      redirect_all(member);
    } else if (Py_TYPE(member.ptr()) == &PyProperty_Type) {
      for (const char* part : {"fget", "fset"}) {
        const nb::object function = member.attr(part);
        if (nb::hasattr(function, "__nb_signature__")) redirect(function.ptr());
      }
    }
  }
}

}  // namespace

void explain_refusals(nb::module_& m) { redirect_all(m); }

}  // namespace manyhands
