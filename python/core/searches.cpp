#include "python/core/searches.hpp"

#include <pybind11/stl.h>

#include "python/core/errors.hpp"
#include "python/core/module.hpp"
#include "python/core/watched.hpp"

namespace modcal::python {
namespace {

py::dict capabilities_of(const ObjectiveFunction& function) {
  const Capabilities known = function.capabilities();
  py::dict told;
  told["gradient"] = known.gradient;
  told["residuals"] = known.sum_of_squares();
  told["jacobian"] = known.least_squares;
  return told;
}

py::dict minimize(const Search& search, const std::string& options, const py::object& progress) {
  const SearchOptions stated = SearchOptions::read(options);
  return described(watched(progress, [&](const Watch& watch) {
    return stated.optimizer.make()->minimize(search.function(), search.variables(), stated.budget,
                                             polling_clock(watch.stop));
  }));
}

}  // namespace

Search::Search(std::shared_ptr<const SearchTask> task)
    : task_(std::move(task)), variables_(task_->bound.parameters.variables()) {}

std::span<const double> Search::point(const Numbers& x) const {
  MODCAL_REQUIRE(x.ndim() == 1 && static_cast<std::size_t>(x.size()) == variables_.size(),
                 "x has {} values: the problem has {} variables, give one for each", x.size(),
                 variables_.size());
  return span_of(x);
}

double Search::value(const Numbers& x) const {
  const auto at = point(x);
  const py::gil_scoped_release unlocked;
  return function().value(at);
}

py::array Search::gradient(const Numbers& x) const {
  const auto at = point(x);
  std::vector<double> gradient;
  {
    const py::gil_scoped_release unlocked;
    gradient = gradient_at(function(), variables_, at);
  }
  return array_of(std::move(gradient));
}

py::array Search::residuals(const Numbers& x) const {
  const auto at = point(x);
  std::vector<double> residuals(function().residual_count());
  {
    const py::gil_scoped_release unlocked;
    function().evaluate(at, {.residuals = residuals.data()});
  }
  return array_of(std::move(residuals));
}

py::array Search::jacobian(const Numbers& x) const {
  const auto at = point(x);
  const std::size_t rows = function().residual_count();
  std::vector<double> jacobian(rows * at.size());
  {
    const py::gil_scoped_release unlocked;
    function().evaluate(at, {.jacobian = jacobian.data()});
  }
  return array_of(std::move(jacobian))
      .reshape({static_cast<py::ssize_t>(rows), static_cast<py::ssize_t>(at.size())});
}

Model Search::model(const Numbers& x) const {
  const ModelPoint point = task_->bound.parameters.model(this->point(x));
  return Model::of_basis(point.basis, point.contact, task_->truth.empty());
}

py::list described(const std::vector<Variable>& variables) {
  py::list list;
  for (const Variable& variable : variables) {
    py::dict one;
    one["name"] = variable.name;
    one["unit"] = variable.unit;
    one["initial"] = variable.initial;
    one["lower"] = variable.lower;
    one["upper"] = variable.upper;
    one["scale"] = variable.scale;
    list.append(one);
  }
  return list;
}

py::dict described(const OptimizationResult& result) {
  std::vector<double> evaluations, seconds, values;
  for (const TracePoint& point : result.trace) {
    evaluations.push_back(static_cast<double>(point.evaluations));
    seconds.push_back(point.seconds);
    values.push_back(point.value);
  }
  py::dict trace, told;
  trace["evaluations"] = array_of(std::move(evaluations));
  trace["seconds"] = array_of(std::move(seconds));
  trace["value"] = array_of(std::move(values));
  told["stop"] = name_of(result.stop);
  told["message"] = explain(result.stop);
  told["x"] = array_of(result.x);
  told["value"] = result.value;
  told["initial_value"] = result.initial_value;
  told["evaluations"] = result.evaluations;
  told["seconds"] = result.seconds;
  told["trace"] = trace;
  return told;
}

SearchOptions SearchOptions::read(const std::string& yaml) {
  SearchOptions options;
  read_keys(yaml, [&options](OptionVisitor& visitor) {
    visitor("optimizer", "how it is searched", options.optimizer);
    visitor("budget", "what the search may spend", options.budget);
  });
  return options;
}

SecondsClock polling_clock(const std::atomic<bool>& stop) {
  return [token = StopToken(stop), clock = steady_seconds()] {
    token.throw_if_requested();
    return clock();
  };
}

void add_searches(py::module_& module) {
  py::class_<Search>(module, "Search")
      .def_property_readonly("variables",
                             [](const Search& self) { return described(self.variables()); })
      .def_property_readonly("objective", [](const Search& self) { return self.function().name(); })
      .def_property_readonly("truth",
                             [](const Search& self) { return array_of(self.task().truth); })
      .def_property_readonly("bound",
                             [](const Search& self) {
                               std::vector<double> bound;
                               {
                                 const py::gil_scoped_release unlocked;
                                 bound = self.task().bound_deviations();
                               }
                               return array_of(std::move(bound));
                             })
      .def_property_readonly("blind", [](const Search& self) { return self.task().bound.blind; })
      .def_property_readonly("residual_count",
                             [](const Search& self) { return self.function().residual_count(); })
      .def_property_readonly("capabilities",
                             [](const Search& self) { return capabilities_of(self.function()); })
      .def("value", &Search::value, py::arg("x"))
      .def("gradient", &Search::gradient, py::arg("x"))
      .def("residuals", &Search::residuals, py::arg("x"))
      .def("jacobian", &Search::jacobian, py::arg("x"))
      .def("model", &Search::model, py::arg("x"))
      .def("minimize", &minimize, py::arg("options"), py::arg("progress"));
}

}  // namespace modcal::python
