// What a Monte Carlo study of calibrations says at one noise level.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "experiments/kinds/limit/calibration_limit_experiment.hpp"
#include "libcalib/identifiability/expected_limit.hpp"

namespace modcal {

/// Errors of one parameter at one noise level.
struct LimitRow {
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  double noise_percent = 0.0;
  std::string parameter;
  double rmse = kNan, bias = kNan, bound = kNan, reported = kNan;
  double attainable = kNan;  ///< with the force unknown, of the law alone
  std::size_t count = 0, failures = 0;
  bool law = false;  ///< f_0, B, x_c or the damping factor of the law

  double ratio() const { return rmse / bound; }
};

/// One parameter of the law over all levels with noise, which are independent: errors in bounds.
struct PooledRow {
  std::string parameter;
  double ratio = 0.0;     ///< RMSE/bound
  double bias = 0.0;      ///< in bounds
  double sd_ratio = 0.0;  ///< standard deviation reported over the RMSE
  std::size_t count = 0;
};

/// A run is wrong where an error of the law, of a well-seen f_n or of x_c exceeds 7.8 bounds
/// (another minimum, not noise) or where it broke, contradicted where χ² or a stated prior speaks
/// against its result.
struct LimitSummary {
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  double level = 0.0;
  std::vector<LimitRow> rows;
  double mean_chi2 = kNan, mean_law_chi2 = kNan;
  double chi2_scatter = kNan, chi2_deviation = kNan;  ///< found, and stated by the calibrations
  double free_rms = kNan, free_worst = kNan;  ///< RMSE/bound over the modes with a bound < 5e-4
  double median_error = kNan, paper_error = kNan, median_bound = kNan;
  double force_correlation = kNan;  ///< mean of that of the identified force
  std::size_t runs = 0, broken = 0;
  std::size_t contradicted = 0;         ///< by χ²
  std::size_t priors_contradicted = 0;  ///< priors that the data contradict
  std::size_t wrong = 0;                ///< broken ones included
  std::size_t silent = 0;               ///< wrong and not contradicted

  const LimitRow* find(const std::string& parameter) const;
};

LimitSummary summarize_level(const LimitLevel& level, const LimitTruth& truth,
                             const ExpectedLimit& bound);

/// The law's rows of all levels with noise and runs, pooled.
std::vector<PooledRow> pooled_rows(const std::vector<LimitSummary>& levels);

/// Errors over noise: law, x_c, median frequency, with bound and the paper's method.
report::Figure limit_figure(const std::vector<LimitSummary>& levels);

}  // namespace modcal
