#include "python/core/searches.hpp"

#include <pybind11/stl.h>

#include "experiments/runs/task_experiment.hpp"
#include "python/core/errors.hpp"
#include "python/core/module.hpp"
#include "python/core/watched.hpp"

namespace modcal::python {
namespace {

std::map<std::string, bool> capabilities_of(const ObjectiveFunction& function) {
  const Capabilities known = function.capabilities();
  return {{"gradient", known.gradient},
          {"residuals", known.sum_of_squares()},
          {"jacobian", known.least_squares}};
}

py::dict minimize(const Search& search, const std::string& options, const py::object& progress) {
  const SearchOptions stated = SearchOptions::read(options);
  return described(watched(progress, [&](const Watch& watch) {
    return stated.optimizer.make()->minimize(search.function(), search.variables(), stated.budget,
                                             stated.telling(watch));
  }));
}

}  // namespace

Search::Search(std::shared_ptr<const SearchTask> task)
    : task_(std::move(task)), variables_(task_->bound.parameters.variables()) {}

Numbers Search::point(const py::object& x) const {
  Numbers at = point_of("x", x, variables_.size());
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    MODCAL_REQUIRE(std::isfinite(at.data()[i]), "x[{}] ({}) is {}; give a finite number", i,
                   variables_[i].name, at.data()[i]);
  }
  return at;
}

void Search::evaluate(const std::function<void()>& work) const {
  constexpr double kLong = 0.02;  // [s]; a thread of its own costs 1e-4 s
  const Stopwatch clock;
  if (*slow_) {
    do_watched(py::none(), [&work](const Watch&) { work(); });
  } else {
    const py::gil_scoped_release unlocked;
    work();
  }
  *slow_ = clock.seconds() > kLong;
}

double Search::value(const py::object& x) const {
  const Numbers at = point(x);
  double value = 0.0;
  evaluate([&] { value = function().value(span_of(at)); });
  return value;
}

py::array Search::gradient(const py::object& x) const {
  const Numbers at = point(x);
  std::vector<double> gradient;
  evaluate([&] { gradient = gradient_at(function(), variables_, span_of(at)); });
  return array_of(std::move(gradient));
}

py::array Search::residuals(const py::object& x) const {
  const Numbers at = point(x);
  std::vector<double> residuals;
  evaluate([&] {
    residuals.resize(function().residual_count());
    function().evaluate(span_of(at), {.residuals = residuals.data()});
  });
  return array_of(std::move(residuals));
}

py::array Search::jacobian(const py::object& x) const {
  const Numbers at = point(x);
  std::vector<double> jacobian;
  const std::size_t columns = variables_.size();
  evaluate([&] {
    jacobian.resize(function().residual_count() * columns);
    function().evaluate(span_of(at), {.jacobian = jacobian.data()});
  });
  const std::size_t rows = jacobian.size() / columns;
  return array_of(std::move(jacobian))
      .reshape({static_cast<py::ssize_t>(rows), static_cast<py::ssize_t>(columns)});
}

Model Search::model(const py::object& x) const {
  const Numbers at = point(x);
  const ModelPoint model = task_->bound.parameters.model(span_of(at));
  return Model::of_basis(model.basis, model.contact, task_->truth.empty());
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

SecondsClock SearchOptions::telling(const Watch& watch) const {
  return [&watch, limit = budget, clock = steady_seconds(), begin = steady_seconds()(),
          reads = std::int64_t{0}]() mutable {
    const double now = clock();
    const double spent = static_cast<double>(++reads) / static_cast<double>(limit.evaluations);
    watch.progress(std::min(1.0, std::max(spent, (now - begin) / limit.seconds)));
    return now;
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
                               return array_of(watched(py::none(), [&self](const Watch&) {
                                 return self.task().bound_deviations();
                               }));
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
