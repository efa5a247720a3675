// The search of a calibration as a function of its parameters.
#pragma once

#include <atomic>
#include <functional>

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "python/core/models.hpp"
#include "python/core/watched.hpp"

namespace modcal::python {

class Search {
 public:
  explicit Search(std::shared_ptr<const SearchTask> task);

  const SearchTask& task() const { return *task_; }
  const std::vector<Variable>& variables() const { return variables_; }
  const ObjectiveFunction& function() const { return *task_->bound.function; }

  double value(const py::object& x) const;
  py::array gradient(const py::object& x) const;
  py::array residuals(const py::object& x) const;
  py::array jacobian(const py::object& x) const;
  Model model(const py::object& x) const;

 private:
  Numbers point(const py::object& x) const;
  /// Does the work without the interpreter's lock. What may take long is done beside Python, which
  /// sees Ctrl-C then: the first evaluation, and those after one that was long.
  void evaluate(const std::function<void()>& work) const;

  std::shared_ptr<const SearchTask> task_;
  std::vector<Variable> variables_;
  // Whether the last evaluation took long.
  std::shared_ptr<std::atomic<bool>> slow_ = std::make_shared<std::atomic<bool>>(true);
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
  /// Clock of a search that tells the share of the budget spent. It is read before every evaluation
  /// and at every better point, which counts as another: the share is not too small.
  SecondsClock telling(const Watch& watch) const;
};

}  // namespace modcal::python
