// Error of the calibration over noise: tables and acceptance.
#include <cmath>
#include <limits>

#include "experiments/kinds/limit/limit_summary.hpp"
#include "libcalib/identifiability/rms_interval.hpp"

namespace modcal {
namespace {

report::Cell number_or_none(double value) {
  return std::isfinite(value) ? report::Cell(value) : report::Cell();
}

RmsInterval interval_of(std::size_t count) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  return count > 0 ? rms_interval(count) : RmsInterval{kNan, kNan};
}

report::Table row_table(const std::vector<LimitSummary>& levels, const std::string& command) {
  report::Table table{.id = "calibration_limit",
                      .title = "Error and bound",
                      .caption =
                          "Frequencies f_n as shares of f_n; efficiency is bound/RMSE; the "
                          "intervals hold the true ratio with 95 % (chi-square of n draws); a "
                          "failure is an error beyond 7.8 bounds or a run that broke.",
                      .columns = {{.key = "noise_percent", .name = "noise", .unit = "%"},
                                  {.key = "parameter"},
                                  {.key = "rmse", .name = "RMSE"},
                                  {.key = "bias"},
                                  {.key = "crb", .name = "bound"},
                                  {.key = "efficiency"},
                                  {.key = "attainable_sd", .name = "attainable, force unknown"},
                                  {.key = "ratio_low", .name = "RMSE/bound from"},
                                  {.key = "ratio_high", .name = "to"},
                                  {.key = "reported_sd", .name = "sd reported"},
                                  {.key = "sd_ratio_low", .name = "that/RMSE from"},
                                  {.key = "sd_ratio_high", .name = "to"},
                                  {.key = "n"},
                                  {.key = "failures"}},
                      .command = command};
  for (const LimitSummary& level : levels) {
    for (const LimitRow& row : level.rows) {
      const RmsInterval interval = interval_of(row.count);
      const double sd_ratio = row.reported / row.rmse;
      table.rows.push_back({row.noise_percent, row.parameter, row.rmse, row.bias, row.bound,
                            row.bound / row.rmse, number_or_none(row.attainable),
                            row.ratio() * interval.low, row.ratio() * interval.high, row.reported,
                            sd_ratio / interval.high, sd_ratio / interval.low, row.count,
                            row.failures + level.broken});
    }
  }
  return table;
}

report::Table pooled_table(const std::vector<LimitSummary>& levels, const std::string& command) {
  report::Table table{.id = "calibration_limit_pooled",
                      .title = "All noise levels together",
                      .caption = "The law's errors in bounds; every level has its own noise.",
                      .columns = {{.key = "parameter"},
                                  {.key = "ratio", .name = "RMSE/bound", .format = "{:.3f}"},
                                  {.key = "ratio_low", .name = "from", .format = "{:.3f}"},
                                  {.key = "ratio_high", .name = "to", .format = "{:.3f}"},
                                  {.key = "bias", .name = "bias, bounds", .format = "{:.3f}"},
                                  {.key = "sd_ratio", .name = "sd/RMSE", .format = "{:.3f}"},
                                  {.key = "sd_ratio_low", .name = "from", .format = "{:.3f}"},
                                  {.key = "sd_ratio_high", .name = "to", .format = "{:.3f}"},
                                  {.key = "n"}},
                      .command = command};
  for (const PooledRow& row : pooled_rows(levels)) {
    const RmsInterval interval = interval_of(row.count);
    table.rows.push_back({row.parameter, row.ratio, row.ratio * interval.low,
                          row.ratio * interval.high, row.bias, row.sd_ratio,
                          row.sd_ratio / interval.high, row.sd_ratio / interval.low, row.count});
  }
  return table;
}

report::Table level_table(const std::vector<LimitSummary>& levels, const std::string& command) {
  report::Table table{
      .id = "calibration_limit_levels",
      .title = "Noise levels",
      .columns = {{.key = "noise_percent", .name = "noise", .unit = "%"},
                  {.key = "n"},
                  {.key = "failures", .name = "wrong"},
                  {.key = "silent", .name = "wrong and not contradicted"},
                  {.key = "rejected", .name = "contradicted by chi2"},
                  {.key = "priors_rejected", .name = "priors contradicted"},
                  {.key = "mean_chi2", .name = "mean reduced chi2", .format = "{:.4f}"},
                  {.key = "chi2_scatter", .name = "its scatter", .format = "{:.4f}"},
                  {.key = "chi2_deviation", .name = "as stated", .format = "{:.4f}"},
                  {.key = "mean_law_chi2", .name = "that of the law", .format = "{:.4f}"},
                  {.key = "free_rms", .name = "free f_n: rms of RMSE/bound"},
                  {.key = "free_worst", .name = "largest"},
                  {.key = "median_relative_error", .name = "median error, excited modes"},
                  {.key = "median_bound", .name = "median bound"},
                  {.key = "paper_median_relative_error", .name = "the paper's method"},
                  {.key = "force_correlation", .name = "correlation of the identified force"}},
      .command = command};
  for (const LimitSummary& level : levels) {
    table.rows.push_back({100.0 * level.level, level.runs, level.wrong, level.silent,
                          level.contradicted, level.priors_contradicted, level.mean_chi2,
                          level.chi2_scatter, level.chi2_deviation, level.mean_law_chi2,
                          level.free_rms, level.free_worst, level.median_error, level.median_bound,
                          number_or_none(level.paper_error),
                          number_or_none(level.force_correlation)});
  }
  return table;
}

// RMSE, bias and reported deviation of one parameter of the law. B on strings bowed off the nodes
// loses information to the unknown force at high noise: 1.3 bounds are allowed there.
void judge_row(const LimitRow& row, auto miss) {
  const double allowed = row.parameter == "B" && row.noise_percent > 9.0 ? 1.3 : 1.2;
  if (!(row.ratio() <= allowed)) {
    miss(fmt::format("{} at {:.2f} bounds", row.parameter, row.ratio()));
  }
  if (!(std::abs(row.bias) <= 0.3 * row.bound)) {
    miss(fmt::format("bias of {} {:.2f} bounds", row.parameter, row.bias / row.bound));
  }
  if (!(std::abs(row.reported / row.rmse - 1.0) <= 0.25)) {
    miss(fmt::format("sd of {} reported {:.2f} of its RMSE", row.parameter,
                     row.reported / row.rmse));
  }
}

// Targets that 50 seeds can tell (what more of them tell, the intervals say); fewer prove nothing.
// Without noise only right and wrong count. An estimated noise level holds aliases, which χ² below
// 1 tells at low noise.
void judge(const std::vector<LimitSummary>& levels, bool known_noise, StudyResult& result) {
  for (const LimitSummary& level : levels) {
    if (level.runs + level.broken < 50) continue;
    const auto miss = [&](const std::string& text) {
      result.missed.push_back(fmt::format("{:g} % noise: {}", 100.0 * level.level, text));
    };
    if (level.wrong > 0) {
      miss(fmt::format("{} runs wrong, {} of them unsaid", level.wrong, level.silent));
    }
    if (level.level == 0.0) continue;
    for (const LimitRow& row : level.rows) {
      if (row.law) judge_row(row, miss);
    }
    if (!(level.free_rms <= 1.1)) miss(fmt::format("free f_n at {:.2f} bounds", level.free_rms));
    if (!(level.free_worst <= 1.6)) {
      miss(fmt::format("worst free f_n at {:.2f} bounds", level.free_worst));
    }
    if (known_noise && !(std::abs(level.mean_chi2 - 1.0) <= 0.01)) {
      miss(fmt::format("mean chi2 {:.4f}", level.mean_chi2));
    }
  }
}

std::string summary_line(const LimitSummary& level) {
  std::string text = fmt::format("{:g} %: RMSE/bound", 100.0 * level.level);
  for (const LimitRow& row : level.rows) {
    if (row.law) text += fmt::format(" {} {:.2f},", row.parameter, row.ratio());
  }
  text += fmt::format(" free f_n {:.2f} (worst {:.2f}); chi2 {:.4f}; median error {:.2e}",
                      level.free_rms, level.free_worst, level.mean_chi2, level.median_error);
  if (std::isfinite(level.paper_error)) {
    text += fmt::format(", the paper's method {:.2e}", level.paper_error);
  }
  if (std::isfinite(level.force_correlation)) {
    text += fmt::format("; force identified with correlation {:.3f}", level.force_correlation);
  }
  text += fmt::format("; {} runs, {} wrong, {} of them unsaid, {} contradicted", level.runs,
                      level.wrong, level.silent, level.contradicted);
  if (level.priors_contradicted > 0) {
    text += fmt::format(", the priors of {}", level.priors_contradicted);
  }
  return text + "\n";
}

}  // namespace

StudyResult sum_up_limit(const CalibrationLimitOptions& options,
                         const std::vector<LimitLevel>& levels, const StudyContext& context) {
  std::vector<LimitSummary> summaries;
  StudyResult result;
  for (const LimitLevel& level : levels) {
    const LimitTruth truth =
        limit_truth(options.observation, level.noise_level, context.work.truths);
    const ExpectedLimit bound = expected_limit(
        limit_case(limit_question_of(options, level.noise_level), context.work.truths));
    summaries.push_back(summarize_level(level, truth, bound));
    result.failed_tasks += summaries.back().broken;
    result.summary += summary_line(summaries.back());
  }
  judge(summaries, options.known_noise, result);
  report::Figure figure = limit_figure(summaries, context.command);
  if (!figure.panels.empty()) result.blocks.emplace_back(std::move(figure));
  const report::Table rows = row_table(summaries, context.command);
  result.files.emplace_back("calibration_limit.json", report::table_json(rows));
  result.blocks.emplace_back(level_table(summaries, context.command));
  result.blocks.emplace_back(pooled_table(summaries, context.command));
  result.blocks.emplace_back(rows);
  if (result.failed_tasks > 0) result.status = report::Status::kFailed;
  return result;
}

}  // namespace modcal
