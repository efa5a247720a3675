// Outcomes of a benchmark by method and condition.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/kinds/benchmark/benchmark_study.hpp"
#include "experiments/kinds/sample.hpp"

namespace modcal {

/// What a task is compared by.
struct BenchmarkLabels {
  std::string objective;  ///< "force_mismatch"
  std::string search;     ///< what else tells methods apart: "nlopt LN_SBPLX"
  std::string condition;  ///< what differs in the data, but for the seed: "noise 5 %"
  std::string replicate;  ///< what tells draws of one condition apart: the seed
  std::string method() const { return search + ", " + objective; }
};

/// One finished task of a benchmark.
struct BenchmarkTask {
  std::size_t task = 0;
  std::size_t method = 0;     ///< index: what differs in the calibration
  std::size_t condition = 0;  ///< index: what differs in the data, but for the seed
  std::string replicate;      ///< what tells draws of one condition apart: the seed
  double seconds = 0.0;
  BenchmarkOutcome outcome;
};

/// A benchmark as a grid of methods and conditions.
struct BenchmarkGrid {
  std::vector<std::string> methods;     ///< "nlopt LN_SBPLX, force_mismatch"
  std::vector<std::string> objectives;  ///< of the methods: "force_mismatch"
  std::vector<std::string> searches;    ///< what else tells methods apart: "nlopt LN_SBPLX"
  std::vector<std::string> conditions;  ///< "5 %"
  std::vector<double> noise_levels;     ///< of the conditions [1]
  std::vector<BenchmarkTask> tasks;
};

/// Share of successes with its 95 % interval (Wilson, 1927).
struct SuccessShare {
  double share = 0.0, low = 0.0, high = 0.0;
};
SuccessShare success_share(std::size_t successes, std::size_t n);

/// All draws of one method under one condition.
struct BenchmarkCell {
  std::size_t method = 0;
  std::size_t condition = 0;
  std::size_t n = 0;
  std::size_t successes = 0;
  std::size_t failures = 0;  ///< refused or broke: without any estimate
  SuccessShare success;
  Spread error;                ///< median error of the frequencies; failures left out
  Spread rms;                  ///< rms error of the frequencies
  double rmse = 0.0;           ///< over all modes and draws with an estimate
  double bound = 0.0;          ///< Cramér–Rao bound of rmse; NaN without noise
  double bound_ratio = 0.0;    ///< rmse / bound
  double contact_error = 0.0;  ///< median [m]
  double correlation = 0.0;    ///< median
  double evaluations = 0.0;    ///< median
  double seconds = 0.0;        ///< median
  /// 1 + number of methods that are better beyond doubt under this condition; methods that cannot
  /// be told apart share a rank.
  std::size_t rank = 0;
  /// What most of the draws without success had in common; empty where all succeeded.
  std::string reason;
  std::size_t reason_count = 0;
  std::int64_t task = -1;  ///< the draw with the median error; −1: none has an estimate
};

/// Cells by condition, then method. Ranks compare medians of the frequency error over the draws
/// that two methods share, a draw without an estimate being worse than any other: a method is
/// better where the 95 % interval of the ratio of medians (median_ratio) lies below 1.
std::vector<BenchmarkCell> benchmark_cells(const BenchmarkGrid& grid);

/// Place of a value among others; their number where it is none of them.
std::size_t place_in(const std::vector<std::string>& values, const std::string& value);

/// Distinct values in the order of their first use.
std::vector<std::string> distinct(const std::vector<std::string>& values);

/// "{type: nlopt, algorithm: LN_SBPLX}" → "nlopt LN_SBPLX".
std::string short_label(const std::string& value);

/// A task by what is compared.
struct FairnessTask {
  std::size_t task = 0;
  BenchmarkLabels labels;
};

using CellOptions = std::function<CalibrateOptions(std::size_t task)>;

/// Warnings where methods have different budgets, bounds, starts, noise or problems, where there
/// are fewer than 10 draws to rank them by, and where a search does not come half the way to the
/// minimum of a parabola of as many variables within its budget, though it could with twenty times
/// as much.
std::vector<Finding> lint_fairness(const std::vector<FairnessTask>& tasks,
                                   const CellOptions& options_of);

}  // namespace modcal
