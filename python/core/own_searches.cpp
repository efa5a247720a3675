// Optimizers written in Python, and functions of Python for those of modcal.
#include <pybind11/stl.h>

#include "python/core/module.hpp"
#include "python/core/own_functions.hpp"
#include "python/core/watched.hpp"

namespace modcal::python {
namespace {

/// The evaluator of a search, for as long as that lasts.
struct OwnEvaluator {
  Evaluator* evaluator = nullptr;

  Evaluator& get() const {
    MODCAL_REQUIRE(evaluator != nullptr, "{}", "the search of this evaluator is over");
    return *evaluator;
  }
  double value(const py::object& z) const {
    const Numbers at = point_of("z", z, get().dimension());
    const py::gil_scoped_release unlocked;
    return evaluator->value(span_of(at));
  }
  std::pair<double, py::array> value_and_gradient(const py::object& z) const {
    const Numbers at = point_of("z", z, get().dimension());
    double value = 0.0;
    std::vector<double> gradient(get().dimension());
    {
      const py::gil_scoped_release unlocked;
      evaluator->evaluate(span_of(at), {.value = &value, .gradient = gradient.data()});
    }
    return {value, array_of(std::move(gradient))};
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
  std::string_view name() const override { return told_.empty() ? std::string_view("own") : told_; }

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

void add_optimizer(const std::string& name, const py::object& search, const std::string& summary) {
  Optimizer::add(name, summary, std::make_shared<OwnOptimizer>(search, name));
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
py::dict minimize_own(const py::dict& callables, const py::list& variables,
                      const std::string& options, const py::object& progress) {
  const std::vector<Variable> stated = variables_of(variables);
  std::vector<double> start;
  for (const Variable& variable : stated) start.push_back(variable.initial);
  const py::object squares = callables["residuals"];
  const std::size_t residuals =
      squares.is_none() ? 0 : count_residuals(squares, array_of(std::move(start)));
  const OwnFunction function(
      {callables["value"], callables["gradient"], callables["residuals"], callables["jacobian"]},
      stated.size(), residuals);
  const SearchOptions how = SearchOptions::read(options);
  return described(watched(progress, [&](const Watch& watch) {
    return how.optimizer.make()->minimize(function, stated, how.budget, how.telling(watch));
  }));
}

// Our function by Python's optimizer.
py::dict search_with_own(const Search& problem, const py::object& search,
                         const std::string& options, const py::object& progress) {
  const SearchOptions how = SearchOptions::read(options);
  const OwnOptimizer optimizer(search);
  return described(watched(progress, [&](const Watch& watch) {
    return optimizer.minimize(problem.function(), problem.variables(), how.budget,
                              how.telling(watch));
  }));
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
  py::class_<OwnEvaluator>(module, "Evaluator",
                           "The evaluator of a search, for as long as that lasts. Points are "
                           "scaled, z = (x - initial)/scale.")
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
  module.def("minimize", &minimize_own, py::arg("callables"), py::arg("variables"),
             py::arg("options"), py::arg("progress"));
  module.def("add_optimizer", &add_optimizer, py::arg("name"), py::arg("search"),
             py::arg("summary"));
  module.def("search", &search_with_own, py::arg("problem"), py::arg("search"), py::arg("options"),
             py::arg("progress"));
}

}  // namespace modcal::python
