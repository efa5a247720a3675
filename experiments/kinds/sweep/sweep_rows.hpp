// Draws of a sweep summed up row by row, and held against published figures.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/kinds/sweep/sweep_study.hpp"

namespace modcal {

/// Published figures of one noise level, by side.
struct PublishedRow {
  double correlation[2];
  double parameter[2];
};

using PublishedTable = std::map<double, PublishedRow>;  ///< by noise in percent

/// Throws InvalidInput where the file is no such table.
PublishedTable read_published(const std::filesystem::path& path);

/// One row of the table: all draws of one noise level on one side.
struct SweepRow {
  double noise_percent = 0.0;
  std::string side;
  std::vector<double> correlation;
  std::vector<double> rms_error;
  std::vector<double> anti_aliased;
  std::vector<double> whole, whole_rms_error, whole_anti_aliased;
  std::vector<double> misfit;
  std::vector<double> parameter;
  std::size_t stand_ins = 0;  ///< parameters that no rule has chosen
  std::size_t warned = 0;     ///< draws whose estimate carries a warning
  std::size_t failures = 0;
  double median = 0.0, q10 = 0.0, q90 = 0.0, rms_median = 0.0, parameter_median = 0.0;
  std::optional<double> published_correlation, published_parameter;
};

/// Mean of what is not NaN; NaN where nothing is.
double mean_of(const std::vector<double>& values);

/// Rows by side and noise. Outcomes that are not there yet are left out.
std::vector<SweepRow> sweep_rows(const std::vector<SweepCell>& cells,
                                 const std::vector<std::optional<TaskOutcome>>& outcomes,
                                 const PublishedTable& published);

/// How the rows agree with the published ones.
struct Judgement {
  std::size_t cells = 0, inside_band = 0, parameter_cells = 0;
  double sum_difference = 0.0;
  double mean_difference() const { return sum_difference / static_cast<double>(cells); }
};

Judgement judge(const std::vector<SweepRow>& rows, const ComparisonOptions& options);

}  // namespace modcal
