// Slopes that an objective does not give.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libcalib/problem/evaluator.hpp"

namespace modcal {
namespace {

/// Two displacements of a variable and the weights of f(z + step) in df/dz.
struct Stencil {
  std::array<double, 2> step{};
  std::array<double, 2> weight{};
  double center = 0.0;  ///< weight of f(z)
};

double wanted_step(double z) {
  return std::cbrt(std::numeric_limits<double>::epsilon()) * std::max(1.0, std::abs(z));
}

// Forward or backward, by the sign of room, which is how far it is to the bound.
Stencil one_sided(double z, double room) {
  const double step = std::copysign(std::min(wanted_step(z), 0.5 * std::abs(room)), room);
  return {{step, 2.0 * step}, {2.0 / step, -0.5 / step}, -1.5 / step};
}

Stencil stencil_at(double z, double lower, double upper) {
  const double wanted = wanted_step(z);
  if (wanted <= z - lower && wanted <= upper - z) {
    // What is added to z is rounded: the step that is made counts.
    const double above = (z + wanted) - z;
    const double below = z - (z - wanted);
    return {{above, -below}, {1.0 / (above + below), -1.0 / (above + below)}, 0.0};
  }
  return one_sided(z, upper - z >= z - lower ? upper - z : lower - z);
}

// Jᵀr, J row-major.
void gradient_of(std::span<const double> jacobian, std::span<const double> residuals,
                 double* gradient) {
  const std::size_t n = jacobian.size() / residuals.size();
  std::fill_n(gradient, n, 0.0);
  for (std::size_t j = 0; j < residuals.size(); ++j) {
    for (std::size_t i = 0; i < n; ++i) gradient[i] += jacobian[j * n + i] * residuals[j];
  }
}

}  // namespace

void Evaluator::difference(std::span<const double> z, const Sample& sample,
                           std::span<const double> numbers, double* slopes) {
  const std::size_t n = dimension();
  std::vector<double> moved(n);
  for (std::size_t i = 0; i < n; ++i) moved[i] = std::clamp(z[i], lower_[i], upper_[i]);
  std::vector<double> shifted(numbers.size());
  for (std::size_t i = 0; i < n; ++i) {
    const double at = moved[i];
    // The step after which the objective was not finite; 0 where all was well.
    const auto fill_column = [&](const Stencil& stencil) {
      for (std::size_t j = 0; j < numbers.size(); ++j) {
        slopes[j * n + i] = stencil.center == 0.0 ? 0.0 : stencil.center * numbers[j];
      }
      double failed = 0.0;
      for (std::size_t side = 0; side < 2 && failed == 0.0; ++side) {
        moved[i] = at + stencil.step[side];
        if (!sample(moved, shifted.data())) failed = stencil.step[side];
        for (Evaluator* evaluator = this; evaluator; evaluator = evaluator->parent_) {
          ++evaluator->result_.difference_evaluations;
        }
        for (std::size_t j = 0; j < numbers.size(); ++j) {
          slopes[j * n + i] += stencil.weight[side] * shifted[j];
        }
      }
      moved[i] = at;
      return failed;
    };
    const Stencil first = stencil_at(at, lower_[i], upper_[i]);
    const double failed = fill_column(first);
    if (failed == 0.0) continue;
    const double room = failed > 0.0 ? lower_[i] - at : upper_[i] - at;
    if (room == 0.0 || fill_column(one_sided(at, room)) != 0.0) {
      for (std::size_t j = 0; j < numbers.size(); ++j) {
        slopes[j * n + i] = std::numeric_limits<double>::quiet_NaN();
      }
    }
  }
}

bool Evaluator::evaluate_with_differences(std::span<const double> z,
                                          const ObjectiveOutputs& outputs) {
  double value = 0.0;
  ObjectiveOutputs given = outputs;
  given.value = &value;
  const Capabilities known = function_.capabilities();
  const bool by_residuals = known.residuals && !known.least_squares;
  std::vector<double> residuals(by_residuals ? residual_count() : 0);
  if (by_residuals) given.residuals = residuals.data();
  if (!known.gradient) given.gradient = nullptr;
  if (!known.least_squares) given.jacobian = nullptr;
  const bool base_finite = evaluate_given(z, given);
  if (outputs.value) *outputs.value = value;
  if (!base_finite) return false;
  if (!by_residuals) {
    const Sample sample = [this](std::span<const double> at, double* number) {
      return evaluate_given(at, {.value = number});
    };
    difference(z, sample, {&value, 1}, outputs.gradient);
    return finite(outputs);
  }
  if (outputs.residuals) std::copy(residuals.begin(), residuals.end(), outputs.residuals);
  const Sample sample = [this](std::span<const double> at, double* numbers) {
    return evaluate_given(at, {.residuals = numbers});
  };
  const std::size_t n = dimension();
  std::vector<double> slopes(residuals.size() * n);
  difference(z, sample, residuals, slopes.data());
  if (outputs.jacobian) std::copy(slopes.begin(), slopes.end(), outputs.jacobian);
  if (outputs.gradient && !known.gradient) gradient_of(slopes, residuals, outputs.gradient);
  return finite(outputs);
}

bool Evaluator::gradient_from_residuals(std::span<const double> z,
                                        const ObjectiveOutputs& outputs) {
  const std::size_t n = dimension();
  const std::size_t m = residual_count();
  std::vector<double> residuals(outputs.residuals ? 0 : m);
  std::vector<double> jacobian(outputs.jacobian ? 0 : m * n);
  ObjectiveOutputs given = outputs;
  given.gradient = nullptr;
  if (!given.residuals) given.residuals = residuals.data();
  if (!given.jacobian) given.jacobian = jacobian.data();
  if (!evaluate_given(z, given)) return false;
  gradient_of({given.jacobian, m * n}, {given.residuals, m}, outputs.gradient);
  return finite(outputs);
}

}  // namespace modcal
