#include "libcalib/problem/objective_function.hpp"

#include <cassert>

#include "libcalib/problem/stop_reason.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

void ObjectiveFunction::evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const {
  MODCAL_REQUIRE(x.size() == dimension(), "objective \"{}\" has {} variables, {} were given",
                 name(), dimension(), x.size());
  const Capabilities known = capabilities();
  MODCAL_REQUIRE(outputs.gradient == nullptr || known.gradient, "objective \"{}\" has no gradient",
                 name());
  MODCAL_REQUIRE(outputs.residuals == nullptr || known.sum_of_squares(),
                 "objective \"{}\" is no sum of squares: it has no residuals", name());
  MODCAL_REQUIRE(outputs.jacobian == nullptr || known.least_squares,
                 "objective \"{}\" has no Jacobian", name());
  MODCAL_REQUIRE(outputs.information == nullptr || known.information,
                 "objective \"{}\" has no Fisher information", name());
  const auto n = static_cast<Eigen::Index>(dimension());
  if (outputs.noise) outputs.noise->setZero(n, n);
  if (outputs.prior) outputs.prior->setZero(n, n);
  do_evaluate(x, outputs);
}

double ObjectiveFunction::value(std::span<const double> x) const {
  double result = 0.0;
  evaluate(x, {.value = &result});
  return result;
}

std::unique_ptr<CoordinateScanner> ObjectiveFunction::scanner(std::span<const double> x) const {
  return std::make_unique<EvaluatingScanner>(*this, x);
}

std::unique_ptr<const ObjectiveFunction> ObjectiveFunction::damped(double sigma) const {
  throw_invalid_input(
      "objective \"{}\" has no form for a record damped by {:g} 1/s: state damping: 0, or take "
      "objective joint_likelihood",
      name(), sigma);
}

StopReason ObjectiveFunction::follow_schedule(Evaluator& /*evaluator*/,
                                              const ScheduleOptions& /*options*/) const {
  throw_invalid_input("objective \"{}\" has no schedule of stages of its own", name());
}

void EvaluatingScanner::scan(std::size_t i, std::span<const double> candidates,
                             std::span<double> values) {
  assert(candidates.size() == values.size() && i < x_.size());
  const double current = x_[i];
  for (std::size_t j = 0; j < candidates.size(); ++j) {
    x_[i] = candidates[j];
    values[j] = function_.value(x_);
  }
  x_[i] = current;
}

}  // namespace modcal
