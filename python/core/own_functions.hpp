// Functions written in Python, as the searches take them.
#pragma once

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
      fill(callables_.gradient, at, dimension_, "the gradient", outputs.gradient);
      fill(callables_.residuals, at, residual_count_, "the residuals", outputs.residuals);
      fill(callables_.jacobian, at, residual_count_ * dimension_, "the Jacobian", outputs.jacobian);
    });
  }
  // Of residuals alone it is half their sum of squares.
  double value_at(const py::array& at) const {
    if (!callables_.value.is_none()) {
      const py::object returned = callables_.value(at);
      const double value = PyFloat_AsDouble(returned.ptr());
      if (PyErr_Occurred() != nullptr) refuse("the objective", "a number", returned);
      return value;
    }
    std::vector<double> residuals(residual_count_);
    fill(callables_.residuals, at, residual_count_, "the residuals", residuals.data());
    double sum = 0.0;
    for (const double residual : residuals) sum += residual * residual;
    return 0.5 * sum;
  }
  [[noreturn]] static void refuse(const char* what, const char* wanted,
                                  const py::object& returned) {
    PyErr_Clear();
    throw_invalid_input("{} returned {} of type {} in the place of {}", what,
                        py::repr(returned).cast<std::string>(), Py_TYPE(returned.ptr())->tp_name,
                        wanted);
  }
  static void fill(const py::object& callable, const py::array& at, std::size_t size,
                   const char* what, double* target) {
    if (target == nullptr) return;
    const py::object returned = callable(at);
    const Numbers numbers = Numbers::ensure(returned);
    if (!numbers) refuse(what, "an array of numbers", returned);
    MODCAL_REQUIRE(static_cast<std::size_t>(numbers.size()) == size,
                   "{} of the objective has {} values in the place of {}", what, numbers.size(),
                   size);
    std::copy_n(numbers.data(), size, target);
  }

  Callables callables_;
  std::size_t dimension_, residual_count_;
  std::string told_;
};

}  // namespace modcal::python
