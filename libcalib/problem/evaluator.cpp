#include "libcalib/problem/evaluator.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/base/stop_scope.hpp"

namespace modcal {
namespace {

void require_valid(const Variable& variable) {
  const std::string unit = variable.unit.empty() ? "" : " " + variable.unit;
  MODCAL_REQUIRE(variable.lower <= variable.initial && variable.initial <= variable.upper &&
                     std::isfinite(variable.lower) && std::isfinite(variable.upper),
                 "initial value {:g}{} of \"{}\" must lie in its finite bounds [{:g}, {:g}]",
                 variable.initial, unit, variable.name, variable.lower, variable.upper);
  MODCAL_REQUIRE(variable.lower < variable.upper,
                 "\"{}\" has no room between its bounds {:g} and {:g}{}: leave it out of the free "
                 "parameters or widen its range",
                 variable.name, variable.lower, variable.upper, unit);
  MODCAL_REQUIRE(variable.scale > 0.0 && std::isfinite(variable.scale),
                 "scale {:g} of \"{}\" must be > 0", variable.scale, variable.name);
}

bool all_finite(const double* values, std::size_t count) {
  return std::all_of(values, values + count, [](double value) { return std::isfinite(value); });
}

}  // namespace

Evaluator::Evaluator(const ObjectiveFunction& function, std::span<const Variable> variables,
                     const Budget& budget, SecondsClock clock)
    : function_(function),
      variables_(variables.begin(), variables.end()),
      budget_(budget),
      clock_(std::move(clock)),
      begin_(clock_()),
      best_value_(std::numeric_limits<double>::infinity()),
      worst_value_(-best_value_) {
  budget_.require_valid();
  MODCAL_REQUIRE(variables.size() == function.dimension() && !variables.empty(),
                 "objective \"{}\" has {} variables, {} are described", function.name(),
                 function.dimension(), variables.size());
  for (const Variable& variable : variables_) {
    require_valid(variable);
    lower_.push_back((variable.lower - variable.initial) / variable.scale);
    upper_.push_back((variable.upper - variable.initial) / variable.scale);
    x_.push_back(variable.initial);
  }
  // So that searches that allocate nothing are not made to.
  result_.trace.reserve(256);
  best_.reserve(x_.size());
}

Evaluator::Evaluator(Evaluator& parent, const ObjectiveFunction& function,
                     std::span<const Variable> variables, std::vector<std::size_t> places,
                     std::vector<double> held)
    : Evaluator(function, variables, Budget{}, parent.clock_) {
  parent_ = &parent;
  places_ = std::move(places);
  held_ = std::move(held);
}

std::int64_t Evaluator::evaluations_left() const {
  if (parent_) return parent_->evaluations_left();
  const std::int64_t kept = scanner_ ? 1 : 0;
  return std::max<std::int64_t>(0, budget_.evaluations - kept - result_.evaluations);
}

void Evaluator::stop(StopReason reason) {
  stop_ = reason;
  throw Stopped{};
}

void Evaluator::require_budget(std::int64_t evaluations) {
  throw_if_stopped();
  if (stopped()) throw Stopped{};
  if (parent_) return parent_->require_budget(evaluations);
  if (evaluations > evaluations_left()) stop(StopReason::kEvaluationBudget);
  if (seconds() >= budget_.seconds) stop(StopReason::kTimeBudget);
}

void Evaluator::count(std::int64_t evaluations) {
  result_.evaluations += evaluations;
  if (parent_) parent_->count(evaluations);
}

void Evaluator::to_user(std::span<const double> z) {
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const Variable& variable = variables_[i];
    x_[i] = std::clamp(variable.initial + variable.scale * z[i], variable.lower, variable.upper);
  }
}

void Evaluator::to_scaled(const ObjectiveOutputs& outputs) const {
  const std::size_t n = dimension();
  for (std::size_t i = 0; i < n; ++i) {
    if (outputs.gradient) outputs.gradient[i] *= variables_[i].scale;
    if (!outputs.jacobian) continue;
    for (std::size_t j = 0; j < residual_count(); ++j) {
      outputs.jacobian[j * n + i] *= variables_[i].scale;
    }
  }
  for (Eigen::MatrixXd* matrix : {outputs.information, outputs.noise, outputs.prior}) {
    if (!matrix) continue;
    const auto rows = static_cast<std::size_t>(matrix->rows());
    for (std::size_t i = 0; i < rows; ++i) {
      const double row = variables_[rows == n ? i : (*outputs.rows)[i]].scale;
      for (std::size_t j = 0; j < n; ++j) {
        (*matrix)(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) *=
            row * variables_[j].scale;
      }
    }
  }
}

void Evaluator::note(double value) {
  if (std::isfinite(value)) worst_value_ = std::max(worst_value_, value);
  if (!(value < best_value_)) return;
  best_value_ = value;
  best_ = x_;
  result_.trace.push_back({result_.evaluations, seconds(), value});
  if (!parent_ || places_.empty()) return;
  parent_->x_ = held_;
  for (std::size_t i = 0; i < places_.size(); ++i) parent_->x_[places_[i]] = x_[i];
  parent_->note(value);
  if (value <= parent_->budget_.target) stop(parent_->stop_ = StopReason::kTargetReached);
}

bool Evaluator::evaluate(std::span<const double> z, const ObjectiveOutputs& outputs) {
  const Capabilities known = function_.capabilities();
  const bool gradient_missing = outputs.gradient && !known.gradient;
  if (gradient_missing && known.least_squares) return gradient_from_residuals(z, outputs);
  if (gradient_missing || (outputs.jacobian && !known.least_squares)) {
    return evaluate_with_differences(z, outputs);
  }
  return evaluate_given(z, outputs);
}

bool Evaluator::finite(const ObjectiveOutputs& outputs) const {
  const std::size_t n = dimension();
  const std::size_t m = residual_count();
  return (!outputs.gradient || all_finite(outputs.gradient, n)) &&
         (!outputs.residuals || all_finite(outputs.residuals, m)) &&
         (!outputs.information || outputs.information->allFinite()) &&
         (!outputs.jacobian || all_finite(outputs.jacobian, n * m));
}

bool Evaluator::evaluate_given(std::span<const double> z, const ObjectiveOutputs& outputs) {
  assert(z.size() == dimension());
  require_budget(1);
  if (!all_finite(z.data(), z.size())) stop(StopReason::kNotFinite);
  to_user(z);
  double value = 0.0;
  ObjectiveOutputs asked = outputs;
  asked.value = &value;
  count(1);
  function_.evaluate(x_, asked);
  if (!std::isfinite(value) || !finite(asked)) {
    if (outputs.value) *outputs.value = std::numeric_limits<double>::infinity();
    return false;
  }
  if (outputs.value) *outputs.value = value;
  to_scaled(asked);
  note(value);
  if (value <= budget_.target) stop(StopReason::kTargetReached);
  return true;
}

double Evaluator::value(std::span<const double> z) {
  double result = 0.0;
  evaluate(z, {.value = &result});
  return result;
}

Evaluator::Trial Evaluator::try_evaluate(std::span<const double> z,
                                         const ObjectiveOutputs& outputs) noexcept {
  const bool slopes = outputs.gradient || outputs.jacobian;
  try {
    if (evaluate(z, outputs)) {
      slopes_known_ = slopes_known_ || slopes;
      return Trial::kFinite;
    }
    if (!std::isfinite(best_value_) || (slopes && !slopes_known_)) stop(StopReason::kNotFinite);
    fill_rejected(outputs);
    return Trial::kRejected;
  } catch (const Stopped&) {
  } catch (...) {
    error_ = std::current_exception();
  }
  return Trial::kOver;
}

// Interpolating line searches and models are led astray by a value far above the others.
void Evaluator::fill_rejected(const ObjectiveOutputs& outputs) const {
  const double above = std::max({worst_value_ - best_value_, std::abs(worst_value_), 1e-300});
  const double value = std::min(worst_value_ + above, std::numeric_limits<double>::max());
  const std::size_t n = dimension();
  const std::size_t m = residual_count();
  if (outputs.value) *outputs.value = value;
  if (outputs.gradient) std::fill_n(outputs.gradient, n, 0.0);
  if (outputs.residuals) {
    std::fill_n(outputs.residuals, m, std::sqrt(value / static_cast<double>(m)) * std::sqrt(2.0));
  }
  if (outputs.jacobian) std::fill_n(outputs.jacobian, m * n, 0.0);
}

void Evaluator::begin() {
  assert(result_.evaluations == 0);
  double value = 0.0;
  require_budget(1);
  to_user(start());
  count(1);
  function_.evaluate(x_, {.value = &value});
  result_.initial_value = value;
  // What starts at +∞ can still be searched point by point.
  if (!(value > -std::numeric_limits<double>::infinity())) stop(StopReason::kNotFinite);
  note(value);
  if (value <= budget_.target) stop(StopReason::kTargetReached);
}

void Evaluator::open_scan() {
  position_.clear();
  for (const Variable& variable : variables_) position_.push_back(variable.initial);
  scanner_ = function_.scanner(position_);
}

void Evaluator::scan(std::size_t i, std::span<const double> candidates, std::span<double> values) {
  assert(scanner_ && i < dimension() && candidates.size() == values.size());
  require_budget(static_cast<std::int64_t>(candidates.size()));
  count(static_cast<std::int64_t>(candidates.size()));
  scanner_->scan(i, candidates, values);
  std::replace_if(
      values.begin(), values.end(), [](double value) { return !std::isfinite(value); },
      std::numeric_limits<double>::infinity());
}

void Evaluator::move(std::size_t i, double x) {
  moved_ = true;
  position_[i] = std::clamp(x, variables_[i].lower, variables_[i].upper);
  scanner_->move(i, position_[i]);
}

void Evaluator::answer(std::vector<double> x, double value) {
  best_ = std::move(x);
  best_value_ = value;
  result_.trace.push_back({result_.evaluations, seconds(), value});
}

OptimizationResult Evaluator::finish(StopReason reason) {
  if (error_) std::rethrow_exception(error_);
  if (scanner_) {
    // Nothing moved: the value is known, and the budget may not allow another evaluation.
    best_ = position_;
    best_value_ = moved_ ? function_.value(position_) : result_.initial_value;
    if (moved_) {
      count(1);
      result_.trace.push_back({result_.evaluations, seconds(), best_value_});
    }
  }
  if (stop_ == StopReason::kNotRun && parent_) stop_ = parent_->stop_;
  result_.stop = stop_ == StopReason::kNotRun ? reason : stop_;
  if (best_.empty()) {
    // Nothing better than infinity was met: the initial point stands.
    for (const Variable& variable : variables_) best_.push_back(variable.initial);
    best_value_ = result_.initial_value;
  }
  result_.x = best_;
  result_.value = best_value_;
  result_.seconds = seconds();
  return std::move(result_);
}

std::vector<double> gradient_at(const ObjectiveFunction& function,
                                std::span<const Variable> variables, std::span<const double> x) {
  std::vector<double> gradient(x.size());
  if (function.capabilities().gradient) {
    function.evaluate(x, {.gradient = gradient.data()});
    return gradient;
  }
  Evaluator evaluator(function, variables, {});
  std::vector<double> z(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    z[i] = (x[i] - variables[i].initial) / variables[i].scale;
  }
  double value = 0.0;
  evaluator.evaluate(z, {.value = &value, .gradient = gradient.data()});
  for (std::size_t i = 0; i < x.size(); ++i) gradient[i] /= variables[i].scale;
  return gradient;
}

}  // namespace modcal
