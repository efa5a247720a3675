// Functions written in Python, as the searches take them.
#pragma once

#include <fmt/ranges.h>

#include <algorithm>
#include <initializer_list>

#include "python/core/searches.hpp"

namespace modcal::python {

/// Callables of x; None where there is none.
struct Callables {
  py::object value, gradient, residuals, jacobian;
};

/// Of what is registered the program says whose exception it is; elsewhere that goes to its caller.
template <typename Call>
auto told_by(const std::string& name, const Call& call) {
  try {
    return call();
  } catch (const py::error_already_set& error) {
    if (name.empty() || error.matches(py::module_::import("modcal.errors").attr("SearchOver"))) {
      throw;
    }
    if (error.matches(PyExc_KeyboardInterrupt)) throw Interrupted();
    throw_invalid_input("\"{}\", written in Python, has failed: {}", name, error.what());
  }
}

[[noreturn]] inline void refuse_returned(const char* what, const char* wanted,
                                         const py::object& returned) {
  PyErr_Clear();
  throw_invalid_input("{} returned {} of type {} in the place of {}", what,
                      py::repr(returned).cast<std::string>(), Py_TYPE(returned.ptr())->tp_name,
                      wanted);
}

/// The array that a function of Python returned. Complex numbers would lose a part in silence.
inline Numbers numbers_of(const char* what, const py::object& returned) {
  const py::array array = py::array::ensure(returned);
  if (!array || std::string_view("fiub").find(array.dtype().kind()) == std::string_view::npos) {
    refuse_returned(what, "an array of real numbers", returned);
  }
  return Numbers::ensure(array);
}

/// How many residuals the function has at x. Throws InvalidInput for what is no row of numbers.
inline std::size_t count_residuals(const py::object& residuals, const py::array& x) {
  const py::object returned = residuals(x);
  const Numbers numbers = numbers_of("the residuals", returned);
  if (numbers.ndim() != 1) refuse_returned("the residuals", "a row of numbers", returned);
  MODCAL_REQUIRE(numbers.size() > 0, "{}", "the residuals are empty; return one or more");
  return static_cast<std::size_t>(numbers.size());
}

/// What of a calibration's search is that of Python's function. told: its name where it is
/// registered.
class OwnFunction final : public ObjectiveFunction {
 public:
  OwnFunction(Callables callables, std::size_t dimension, std::size_t residuals,
              std::string told = {})
      : callables_(std::move(callables)),
        dimension_(dimension),
        residual_count_(residuals),
        told_(std::move(told)) {}
  ~OwnFunction() override {
    const py::gil_scoped_acquire locked;
    callables_ = {};
  }
  OwnFunction(const OwnFunction&) = delete;
  OwnFunction& operator=(const OwnFunction&) = delete;
  std::string_view name() const override { return told_.empty() ? std::string_view("own") : told_; }
  std::size_t dimension() const override { return dimension_; }
  std::size_t residual_count() const override { return residual_count_; }
  Capabilities capabilities() const override {
    return {.gradient = !callables_.gradient.is_none(),
            .least_squares = !callables_.jacobian.is_none(),
            .residuals = !callables_.residuals.is_none()};
  }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const py::gil_scoped_acquire locked;
    const py::array at = array_of({x.begin(), x.end()});
    told_by(told_, [&] {
      if (outputs.value != nullptr) *outputs.value = value_at(at);
      fill(callables_.gradient, at, {dimension_}, kGradient, outputs.gradient);
      fill(callables_.residuals, at, {residual_count_}, kResiduals, outputs.residuals);
      fill(callables_.jacobian, at, {residual_count_, dimension_}, kJacobian, outputs.jacobian);
    });
  }
  // Of residuals alone it is half their sum of squares.
  double value_at(const py::array& at) const {
    if (!callables_.value.is_none()) {
      return number_of(callables_.value(at));
    }
    std::vector<double> residuals(residual_count_);
    fill(callables_.residuals, at, {residual_count_}, kResiduals, residuals.data());
    double sum = 0.0;
    for (const double residual : residuals) sum += residual * residual;
    return 0.5 * sum;
  }
  // A float is one at a glance; a complex number of NumPy calls itself one.
  static double number_of(const py::object& returned) {
    constexpr const char* kWhat = "the objective";
    if (!PyFloat_Check(returned.ptr())) {
      const py::array array = py::array::ensure(returned);
      if (array && array.dtype().kind() == 'c') refuse_returned(kWhat, "a real number", returned);
    }
    const double value = PyFloat_AsDouble(returned.ptr());
    if (PyErr_Occurred() != nullptr) refuse_returned(kWhat, "a number", returned);
    return value;
  }
  /// What a function returns, and how.
  struct Returned {
    const char *name, *remedy;
  };
  static constexpr Returned kGradient{"the gradient", "return a number for each variable"};
  static constexpr Returned kResiduals{"the residuals", "return as many at every x"};
  static constexpr Returned kJacobian{
      "the Jacobian", "return a row for each residual, with a number for each variable"};

  static void fill(const py::object& callable, const py::array& at,
                   std::initializer_list<std::size_t> shape, const Returned& what, double* target) {
    if (target == nullptr) return;
    const Numbers numbers = numbers_of(what.name, callable(at));
    const auto same = [](std::size_t wanted, py::ssize_t has) {
      return static_cast<py::ssize_t>(wanted) == has;
    };
    MODCAL_REQUIRE(std::equal(shape.begin(), shape.end(), numbers.shape(),
                              numbers.shape() + numbers.ndim(), same),
                   "{} of the objective has the shape ({}) in the place of ({}); {}", what.name,
                   fmt::join(numbers.shape(), numbers.shape() + numbers.ndim(), ", "),
                   fmt::join(shape, ", "), what.remedy);
    std::copy_n(numbers.data(), numbers.size(), target);
  }

  Callables callables_;
  std::size_t dimension_, residual_count_;
  std::string told_;
};

}  // namespace modcal::python
