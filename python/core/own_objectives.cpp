// Objectives written in Python, by name.
#include <pybind11/complex.h>
#include <pybind11/stl.h>

#include "python/core/module.hpp"
#include "python/core/own_functions.hpp"

namespace modcal::python {
namespace {

// What of an objective may be there besides its value.
constexpr const char* kGradient = "gradient";
constexpr const char* kResiduals = "residuals";
constexpr const char* kJacobian = "jacobian";

py::array spectrum_of(const std::vector<Complex>& spectrum) {
  return py::array_t<Complex>(static_cast<py::ssize_t>(spectrum.size()), spectrum.data());
}

// What an objective of Python's is bound to.
py::object record_of(const CalibrationData& data, const ParameterSet& parameters) {
  std::vector<std::string> names;
  for (const Variable& variable : parameters.variables()) names.push_back(variable.name);
  const auto model = [parameters](const py::object& x) {
    const Numbers at = point_of("x", x, parameters.size());
    const ModelPoint point = parameters.model(span_of(at));
    py::dict told;
    told["frequencies"] = array_of(frequencies_of(point.basis));
    told["damping_ratios"] = array_of({point.basis.zeta.begin(), point.basis.zeta.end()});
    told["contact"] = point.contact;
    return told;
  };
  return py::module_::import("types").attr("SimpleNamespace")(
      py::arg("rate") = data.sample_rate, py::arg("samples") = data.samples,
      py::arg("left") = spectrum_of(data.reaction(End::kLeft)),
      py::arg("right") = spectrum_of(data.reaction(End::kRight)), py::arg("names") = names,
      py::arg("x0") = array_of(parameters.start()), py::arg("model") = py::cpp_function(model));
}

/// An objective by bind(record) -> function of x, or what has the functions that it provides.
class OwnObjective final : public Objective {
 public:
  OwnObjective(py::object bind, std::string told, const std::vector<std::string>& provides)
      : bind_(std::move(bind)), told_(std::move(told)) {
    const auto has = [&provides](std::string_view word) {
      return std::ranges::count(provides, word) > 0;
    };
    can_ = {
        .gradient = has(kGradient), .least_squares = has(kJacobian), .residuals = has(kResiduals)};
    MODCAL_REQUIRE(provides.size() == static_cast<std::size_t>(can_.gradient + can_.least_squares +
                                                               can_.residuals),
                   "an objective provides some of \"gradient\", \"residuals\", \"jacobian\", each "
                   "once, not {}",
                   fmt::join(provides, ", "));
    MODCAL_REQUIRE(can_.residuals || !can_.least_squares, "{}",
                   "a Jacobian is that of residuals: provide \"residuals\", too");
  }
  Capabilities capabilities() const override { return can_; }

 private:
  std::unique_ptr<const ObjectiveFunction> do_bind(const CalibrationData& data,
                                                   const ParameterSet& parameters) const override {
    const py::gil_scoped_acquire locked;
    return told_by(told_, [&] {
      const py::object made = bind_(record_of(data, parameters));
      const auto member = [&made](bool provided, const char* name) -> py::object {
        if (!provided) return py::none();
        return made.attr(name);
      };
      const bool alone = !can_.gradient && !can_.residuals;
      const Callables callables{.value = alone ? made : py::getattr(made, "value", py::none()),
                                .gradient = member(can_.gradient, kGradient),
                                .residuals = member(can_.residuals, kResiduals),
                                .jacobian = member(can_.least_squares, kJacobian)};
      MODCAL_REQUIRE(can_.residuals || !callables.value.is_none(), "\"{}\" has no value(x)", told_);
      std::size_t count = 0;
      if (can_.residuals) {
        count = count_residuals(callables.residuals, array_of(parameters.start()));
      }
      return std::make_unique<OwnFunction>(callables, parameters.size(), count, told_);
    });
  }
  py::object bind_;
  std::string told_;
  Capabilities can_;
};

void add_objective(const std::string& name, const py::object& bind, const std::string& summary,
                   const std::vector<std::string>& provides) {
  Objective::add(name, summary, std::make_shared<OwnObjective>(bind, name, provides));
}

}  // namespace

void add_own_objectives(py::module_& module) {
  module.def("add_objective", &add_objective, py::arg("name"), py::arg("bind"), py::arg("summary"),
             py::arg("provides"));
}

}  // namespace modcal::python
