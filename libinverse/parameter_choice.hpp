// Parameter choices: which amount of regularization suits the data.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libinverse/regularizer.hpp"

namespace modcal {

enum class Measure;
struct SpectralData;

/// Parameters searched and the measure of the solution: options that every choice has.
struct CurveOptions {
  std::int64_t points = 400;  ///< logarithmically spaced
  /// Range in the unit of the singular values (N/N for reactions). NaN: from the smallest singular
  /// value > 0, but at most 8 decades down, to the largest.
  double lowest = std::numeric_limits<double>::quiet_NaN();
  double highest = std::numeric_limits<double>::quiet_NaN();
  std::string measure = "derivative";  ///< derivative: ‖dF/dt‖; solution: ‖F‖

  void visit(OptionVisitor& visitor);
};

/// A regularizer's curve over the searched range, with what it is a curve of.
struct TracedCurve {
  const Regularizer& regularizer;
  const SpectralData& data;
  Measure measure;
  std::span<CurvePoint> curve;  ///< at least one point, unless the rule allows none
};

class ParameterChoice {
 public:
  static constexpr std::string_view kKind = "parameter_choice";
  static Registry<ParameterChoice> registry();

  virtual ~ParameterChoice() = default;

  /// Traces the regularizer's curve over the searched range and chooses on it.
  /// Throws InvalidInput where the data do not allow the rule (no derivative, unknown noise) or the
  /// range is empty.
  ChosenParameter choose(const Regularizer& regularizer, const SpectralData& data) const;

  struct Pick {
    double parameter = 0.0;
    ChoiceStatus status = ChoiceStatus::kNotComputed;
    std::string explanation;
  };
  /// The point of the smallest criterion; at either end of where the criterion is
  /// defined the status is kEdgeOfRange.
  static Pick smallest_criterion(std::span<const CurvePoint> curve, std::string_view what);

 protected:
  /// Throws InvalidInput for fewer than `least_points` points, an empty range, an unknown measure.
  ParameterChoice(CurveOptions options, std::int64_t least_points);

 private:
  /// Fills the criterion of every point of the curve and picks a parameter.
  virtual Pick pick(const TracedCurve& traced) const = 0;

  std::vector<double> search_grid(std::span<const double> falling_sigma) const;
  CurvePoint point_at(double parameter, const Regularizer& regularizer, const SpectralData& data,
                      std::span<const CurvePoint> curve) const;

  CurveOptions options_;
  Measure measure_;
};

/// A sentence that names the rules which would have chosen, inside the same range, a parameter more
/// than a factor of 10 from the chosen one, with their parameters; empty where none would, or where
/// nothing was chosen. Asked are the rules that the traced curve answers without another pass over
/// the data: generalized cross validation, the minimal product and, where the noise level is known
/// (not NaN), the discrepancy principle. `rows`: real numbers in the data.
std::string disagreement_of(const ChosenParameter& choice, std::size_t rows, double noise_rms);

}  // namespace modcal
