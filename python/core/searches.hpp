// The search of a calibration as a function of its parameters.
#pragma once

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "python/core/models.hpp"

namespace modcal::python {

class Search {
 public:
  explicit Search(std::shared_ptr<const SearchTask> task);

  const SearchTask& task() const { return *task_; }
  const std::vector<Variable>& variables() const { return variables_; }
  const ObjectiveFunction& function() const { return *task_->bound.function; }

  double value(const Numbers& x) const;
  py::array gradient(const Numbers& x) const;
  py::array residuals(const Numbers& x) const;
  py::array jacobian(const Numbers& x) const;
  Model model(const Numbers& x) const;

 private:
  std::span<const double> point(const Numbers& x) const;

  std::shared_ptr<const SearchTask> task_;
  std::vector<Variable> variables_;
};

/// [{name, unit, initial, lower, upper, scale}]
py::list described(const std::vector<Variable>& variables);
/// What a search found.
py::dict described(const OptimizationResult& result);
/// Keys "optimizer" and "budget" of a YAML map.
struct SearchOptions {
  Choice<Optimizer> optimizer{"nlopt"};
  Budget budget;
  /// Throws Refusal.
  static SearchOptions read(const std::string& yaml);
};
/// With a clock that ends the search where `stop` says so.
SecondsClock polling_clock(const std::atomic<bool>& stop);

}  // namespace modcal::python
