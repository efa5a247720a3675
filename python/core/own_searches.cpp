// Objectives and optimizers written in Python.
#include <pybind11/complex.h>
#include <pybind11/stl.h>

#include "python/core/module.hpp"
#include "python/core/searches.hpp"
#include "python/core/watched.hpp"

namespace modcal::python {
namespace {

/// Callables of x; None where there is none.
struct Callables {
  py::object value, gradient, residuals, jacobian;
};

// Of what is registered the program says whose exception it is; elsewhere that goes to its caller.
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
  std::string_view name() const override { return told_.empty() ? "own" : told_; }
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
    if (!callables_.value.is_none()) return callables_.value(at).cast<double>();
    std::vector<double> residuals(residual_count_);
    fill(callables_.residuals, at, residual_count_, "the residuals", residuals.data());
    double sum = 0.0;
    for (const double residual : residuals) sum += residual * residual;
    return 0.5 * sum;
  }
  static void fill(const py::object& callable, const py::array& at, std::size_t size,
                   const char* what, double* target) {
    if (target == nullptr) return;
    const Numbers numbers = callable(at).cast<Numbers>();
    MODCAL_REQUIRE(static_cast<std::size_t>(numbers.size()) == size,
                   "{} of the objective has {} values in the place of {}", what, numbers.size(),
                   size);
    std::copy_n(numbers.data(), size, target);
  }

  Callables callables_;
  std::size_t dimension_, residual_count_;
  std::string told_;
};

/// The evaluator of a search, for as long as that lasts.
struct OwnEvaluator {
  Evaluator* evaluator = nullptr;

  Evaluator& get() const {
    MODCAL_REQUIRE(evaluator != nullptr, "{}", "the search of this evaluator is over");
    return *evaluator;
  }
  std::span<const double> point(const Numbers& z) const {
    MODCAL_REQUIRE(static_cast<std::size_t>(z.size()) == get().dimension(),
                   "z has {} values: the problem has {} variables, give one for each", z.size(),
                   get().dimension());
    return span_of(z);
  }
  double value(const Numbers& z) const {
    const auto at = point(z);
    const py::gil_scoped_release unlocked;
    return evaluator->value(at);
  }
  py::tuple value_and_gradient(const Numbers& z) const {
    const auto at = point(z);
    double value = 0.0;
    std::vector<double> gradient(at.size());
    {
      const py::gil_scoped_release unlocked;
      evaluator->evaluate(at, {.value = &value, .gradient = gradient.data()});
    }
    return py::make_tuple(value, array_of(std::move(gradient)));
  }
};

StopReason reason_named(const py::object& word) {
  if (word.is_none()) return StopReason::kSearchCompleted;
  const auto name = word.cast<std::string>();
  for (int i = 0; i <= static_cast<int>(StopReason::kNoProgress); ++i) {
    if (name_of(static_cast<StopReason>(i)) == name) return static_cast<StopReason>(i);
  }
  throw_invalid_input("unknown reason \"{}\" to end a search: \"converged\", \"small_step\", …",
                      name);
}

/// A search by search(evaluator) -> word or None. told: its name where it is registered.
class OwnOptimizer final : public Optimizer {
 public:
  explicit OwnOptimizer(py::object search, std::string told = {})
      : search_(std::move(search)), told_(std::move(told)) {}
  std::string_view name() const override { return told_.empty() ? "own" : told_; }

 private:
  StopReason search(Evaluator& evaluator) const override {
    const py::gil_scoped_acquire locked;
    const py::object lent = py::cast(OwnEvaluator{&evaluator});
    auto& own = lent.cast<OwnEvaluator&>();
    try {
      const py::object word = told_by(told_, [&] { return search_(lent); });
      own.evaluator = nullptr;
      return reason_named(word);
    } catch (const py::error_already_set& error) {
      own.evaluator = nullptr;
      const py::object over = py::module_::import("modcal.errors").attr("SearchOver");
      if (error.matches(over)) throw Evaluator::Stopped();
      throw;
    } catch (...) {
      own.evaluator = nullptr;
      throw;
    }
  }
  py::object search_;
  std::string told_;
};

py::array spectrum_of(const std::vector<Complex>& spectrum) {
  return py::array_t<Complex>(static_cast<py::ssize_t>(spectrum.size()), spectrum.data());
}

// What an objective of Python's is bound to.
py::object record_of(const CalibrationData& data, const ParameterSet& parameters) {
  std::vector<std::string> names;
  for (const Variable& variable : parameters.variables()) names.push_back(variable.name);
  const auto model = [parameters](const Numbers& x) {
    MODCAL_REQUIRE(static_cast<std::size_t>(x.size()) == parameters.size(),
                   "x has {} values: the problem has {} variables, give one for each", x.size(),
                   parameters.size());
    const ModelPoint point = parameters.model(span_of(x));
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

/// An objective by bind(record) -> function of x.
class OwnObjective final : public Objective {
 public:
  OwnObjective(py::object bind, std::string told)
      : bind_(std::move(bind)), told_(std::move(told)) {}
  Capabilities capabilities() const override { return {}; }

 private:
  std::unique_ptr<const ObjectiveFunction> do_bind(const CalibrationData& data,
                                                   const ParameterSet& parameters) const override {
    const py::gil_scoped_acquire locked;
    const py::object value = told_by(told_, [&] { return bind_(record_of(data, parameters)); });
    return std::make_unique<OwnFunction>(Callables{value, py::none(), py::none(), py::none()},
                                         parameters.size(), 0, told_);
  }
  py::object bind_;
  std::string told_;
};

void add_optimizer(const std::string& name, const py::object& search, const std::string& summary) {
  Optimizer::add(name, summary, std::make_shared<OwnOptimizer>(search, name));
}

void add_objective(const std::string& name, const py::object& bind, const std::string& summary) {
  Objective::add(name, summary, std::make_shared<OwnObjective>(bind, name));
}

std::vector<Variable> variables_of(const py::list& list) {
  std::vector<Variable> variables;
  for (const py::handle one : list) {
    variables.push_back({.name = one["name"].cast<std::string>(),
                         .unit = one["unit"].cast<std::string>(),
                         .initial = one["initial"].cast<double>(),
                         .lower = one["lower"].cast<double>(),
                         .upper = one["upper"].cast<double>(),
                         .scale = one["scale"].cast<double>()});
  }
  return variables;
}

// Python's function by our optimizer.
py::dict minimize(const py::dict& callables, std::size_t residuals, const py::list& variables,
                  const std::string& options, const py::object& progress) {
  const std::vector<Variable> stated = variables_of(variables);
  const OwnFunction function(
      {callables["value"], callables["gradient"], callables["residuals"], callables["jacobian"]},
      stated.size(), residuals);
  const SearchOptions how = SearchOptions::read(options);
  return described(watched(progress, [&](const Watch& watch) {
    return how.optimizer.make()->minimize(function, stated, how.budget, polling_clock(watch.stop));
  }));
}

// Our function by Python's optimizer.
py::dict search(const Search& problem, const py::object& search, const std::string& options) {
  return described(OwnOptimizer(search).minimize(problem.function(), problem.variables(),
                                                 SearchOptions::read(options).budget));
}

}  // namespace

void add_own_searches(py::module_& module) {
  py::register_exception_translator([](std::exception_ptr error) {
    try {
      std::rethrow_exception(std::move(error));
    } catch (const Evaluator::Stopped&) {
      const py::object over = py::module_::import("modcal.errors").attr("SearchOver");
      PyErr_SetString(over.ptr(), "the budget of the search is spent, or its target is reached");
    }
  });
  const auto scaled = [](std::span<const double> numbers) {
    return array_of({numbers.begin(), numbers.end()});
  };
  py::class_<OwnEvaluator>(module, "Evaluator")
      .def_property_readonly("dimension",
                             [](const OwnEvaluator& self) { return self.get().dimension(); })
      .def_property_readonly("start",
                             [](const OwnEvaluator& self) { return array_of(self.get().start()); })
      .def_property_readonly("lower",
                             [=](const OwnEvaluator& self) { return scaled(self.get().lower()); })
      .def_property_readonly("upper",
                             [=](const OwnEvaluator& self) { return scaled(self.get().upper()); })
      .def_property_readonly("evaluations",
                             [](const OwnEvaluator& self) { return self.get().evaluations(); })
      .def_property_readonly("evaluations_left",
                             [](const OwnEvaluator& self) { return self.get().evaluations_left(); })
      .def("value", &OwnEvaluator::value, py::arg("z"))
      .def("value_and_gradient", &OwnEvaluator::value_and_gradient, py::arg("z"));
  module.def("minimize", &minimize, py::arg("callables"), py::arg("residuals"),
             py::arg("variables"), py::arg("options"), py::arg("progress"));
  module.def("add_optimizer", &add_optimizer, py::arg("name"), py::arg("search"),
             py::arg("summary"));
  module.def("add_objective", &add_objective, py::arg("name"), py::arg("bind"), py::arg("summary"));
  module.def("search", &search, py::arg("problem"), py::arg("search"), py::arg("options"));
}

}  // namespace modcal::python
