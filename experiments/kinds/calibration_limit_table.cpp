// Error of the calibration over noise: table, figure and acceptance.
#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/kinds/calibration_limit_experiment.hpp"
#include "libcalib/likelihood/expected_limit.hpp"
#include "libcalib/stiff_string_fit.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

using report::ColorRole;
using report::SeriesStyle;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// Errors beyond this many bounds are failures: wrong minima, not noise.
constexpr double kFailure = 7.8;
constexpr double kWellSeen = 5e-4;
constexpr const char* kLawNames[] = {"f0", "B", "x_c", "damping"};

// Errors of one parameter at one noise level.
struct Row {
  double noise_percent = 0.0;
  std::string parameter;
  double rmse = kNan, bias = kNan, bound = kNan, reported = kNan;
  std::size_t count = 0, failures = 0;
  bool law = false, frequency = false;

  double ratio() const { return rmse / bound; }
};

Row row_of(double level, std::string parameter, const std::vector<double>& errors,
           const std::vector<double>& deviations, double bound) {
  Row row{.noise_percent = 100.0 * level, .parameter = std::move(parameter), .bound = bound};
  row.count = errors.size();
  double square = 0.0, sum = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    square += errors[i] * errors[i];
    sum += errors[i];
    variance += deviations[i] * deviations[i];
    if (std::abs(errors[i]) > kFailure * bound) ++row.failures;
  }
  const auto n = static_cast<double>(errors.size());
  if (errors.empty()) return row;
  row.rmse = std::sqrt(square / n);
  row.bias = sum / n;
  row.reported = std::sqrt(variance / n);
  return row;
}

// Everything one noise level says.
struct LevelSummary {
  double level = 0.0;
  std::vector<Row> rows;
  double mean_chi2 = kNan, mean_law_chi2 = kNan;
  double free_rms = kNan, free_worst = kNan;  // RMSE/bound over the well-seen modes
  double median_error = kNan, paper_error = kNan, median_bound = kNan;
  std::size_t runs = 0, broken = 0, rejected = 0;

  std::size_t failures() const {
    std::size_t worst = 0;
    for (const Row& row : rows) worst = std::max(worst, row.failures);
    return worst + broken;
  }
};

class LevelReader {
 public:
  LevelReader(const LimitLevel& level, const LimitTruth& truth, const ExpectedLimit& bound)
      : truth_(truth), bound_(bound) {
    summary_.level = level.noise_level;
    for (const LimitOutcome& outcome : level.outcomes) {
      if (!outcome.failure.empty()) {
        ++summary_.broken;
      } else {
        outcomes_.push_back(outcome);
        if (!outcome.right) ++summary_.rejected;
      }
    }
    summary_.runs = outcomes_.size();
  }

  LevelSummary read() {
    add_law();
    add_frequencies();
    add_means();
    return std::move(summary_);
  }

 private:
  template <typename Value, typename Deviation>
  Row row(std::string name, double bound, Value error_of, Deviation deviation_of) const {
    std::vector<double> errors, deviations;
    for (const LimitOutcome& outcome : outcomes_) {
      errors.push_back(error_of(outcome));
      deviations.push_back(deviation_of(outcome));
    }
    return row_of(summary_.level, std::move(name), errors, deviations, bound);
  }

  void add_law() {
    std::vector<double> frequencies;
    for (std::size_t n = 0; n < truth_.point.basis.size(); ++n) {
      frequencies.push_back(truth_.point.basis.frequency(n));
    }
    const StiffStringFit fit = fit_stiff_string(frequencies);
    const double values[] = {fit.fundamental, fit.inharmonicity, truth_.point.contact, 1.0};
    for (std::size_t i = 0; i < 4; ++i) {
      Row law = row(
          kLawNames[i], bound_.law[i], [&](const LimitOutcome& o) { return o.law[i] - values[i]; },
          [&](const LimitOutcome& o) { return o.law_deviation[i]; });
      law.law = true;
      summary_.rows.push_back(std::move(law));
    }
  }

  void add_frequencies() {
    double square = 0.0, count = 0.0;
    std::vector<double> bounds;
    for (std::size_t n = 0; n < truth_.point.basis.size(); ++n) {
      const ModeVerdict& mode = bound_.modes[n];
      if (!(mode.deviation < kWellSeen) || mode.source != ModeSource::kIdentified) continue;
      Row free = row(
          fmt::format("f_{}", n + 1), mode.deviation,
          [&](const LimitOutcome& o) {
            return o.frequencies[n] / truth_.point.basis.frequency(n) - 1.0;
          },
          [&](const LimitOutcome& o) { return o.deviations[n]; });
      free.frequency = true;
      bounds.push_back(mode.deviation);
      square += free.ratio() * free.ratio();
      count += 1.0;
      summary_.free_worst = std::fmax(summary_.free_worst, free.ratio());
      summary_.rows.push_back(std::move(free));
    }
    summary_.free_rms = std::sqrt(square / count);
    summary_.median_bound = quantile(bounds, 0.5);
    summary_.rows.push_back(row(
        "x_c, frequencies free", bound_.contact,
        [&](const LimitOutcome& o) { return o.contact - truth_.point.contact; },
        [](const LimitOutcome& o) { return o.contact_deviation; }));
  }

  void add_means() {
    std::vector<double> chi2, law_chi2, medians, paper;
    const std::vector<double> shape = truth_.point.basis.shape_at(truth_.point.contact);
    for (const LimitOutcome& outcome : outcomes_) {
      chi2.push_back(outcome.chi2);
      law_chi2.push_back(outcome.law_chi2);
      std::vector<double> errors;
      for (std::size_t n = 0; n < shape.size(); ++n) {
        if (std::abs(shape[n]) < 0.1) continue;
        errors.push_back(std::abs(outcome.frequencies[n] / truth_.point.basis.frequency(n) - 1.0));
      }
      medians.push_back(quantile(std::move(errors), 0.5));
      if (std::isfinite(outcome.paper_error)) paper.push_back(outcome.paper_error);
    }
    if (outcomes_.empty()) return;
    summary_.mean_chi2 = mean(chi2);
    summary_.mean_law_chi2 = mean(law_chi2);
    summary_.median_error = quantile(medians, 0.5);
    summary_.paper_error = quantile(paper, 0.5);
  }

  const LimitTruth& truth_;
  const ExpectedLimit& bound_;
  std::vector<LimitOutcome> outcomes_;
  LevelSummary summary_;
};

report::Table row_table(const std::vector<LevelSummary>& levels, const std::string& command) {
  report::Table table{.id = "calibration_limit",
                      .title = "Error and bound",
                      .caption =
                          "Frequencies f_n as shares of f_n; efficiency is bound/RMSE; a "
                          "failure is an error beyond 7.8 bounds or a run that broke.",
                      .columns = {{.key = "noise_percent", .name = "noise", .unit = "%"},
                                  {.key = "parameter"},
                                  {.key = "rmse", .name = "RMSE"},
                                  {.key = "bias"},
                                  {.key = "crb", .name = "bound"},
                                  {.key = "efficiency"},
                                  {.key = "reported_sd", .name = "sd reported"},
                                  {.key = "n"},
                                  {.key = "failures"}},
                      .command = command};
  for (const LevelSummary& level : levels) {
    for (const Row& row : level.rows) {
      table.rows.push_back({row.noise_percent, row.parameter, row.rmse, row.bias, row.bound,
                            row.bound / row.rmse, row.reported, row.count,
                            row.failures + level.broken});
    }
  }
  return table;
}

report::Table level_table(const std::vector<LevelSummary>& levels, const std::string& command) {
  report::Table table{
      .id = "calibration_limit_levels",
      .title = "Noise levels",
      .columns = {{.key = "noise_percent", .name = "noise", .unit = "%"},
                  {.key = "n"},
                  {.key = "failures"},
                  {.key = "rejected", .name = "contradicted by chi2"},
                  {.key = "mean_chi2", .name = "mean reduced chi2", .format = "{:.4f}"},
                  {.key = "mean_law_chi2", .name = "that of the law", .format = "{:.4f}"},
                  {.key = "free_rms", .name = "free f_n: rms of RMSE/bound"},
                  {.key = "free_worst", .name = "largest"},
                  {.key = "median_relative_error", .name = "median error, excited modes"},
                  {.key = "median_bound", .name = "median bound"},
                  {.key = "paper_median_relative_error", .name = "the paper's method"}},
      .command = command};
  for (const LevelSummary& level : levels) {
    table.rows.push_back(
        {100.0 * level.level, level.runs, level.failures(), level.rejected, level.mean_chi2,
         level.mean_law_chi2, level.free_rms, level.free_worst, level.median_error,
         level.median_bound,
         std::isfinite(level.paper_error) ? report::Cell(level.paper_error) : report::Cell()});
  }
  return table;
}

report::Panel panel_of(const std::string& title, const std::string& unit) {
  report::Panel panel;
  panel.title = title;
  panel.x = {.label = "noise", .unit = "%", .logarithmic = true};
  panel.y = {.label = "error", .unit = unit, .logarithmic = true};
  return panel;
}

report::Figure error_figure(const std::vector<LevelSummary>& levels, const std::string& command) {
  report::Figure figure{.id = "calibration_limit_figure",
                        .title = "Calibration error against noise",
                        .caption =
                            "Points: RMSE over the seeds, bars: its standard error; line: "
                            "Cramér-Rao bound with the force unknown.",
                        .columns = 3,
                        .command = command};
  const auto add = [&](const std::string& title, const std::string& unit, auto row_of_level) {
    report::Series points{
        .label = "joint likelihood", .style = SeriesStyle::kPoints, .color = ColorRole::kFirst};
    report::Series bound{.label = "bound", .color = ColorRole::kReference};
    for (const LevelSummary& level : levels) {
      const Row* row = row_of_level(level);
      if (!row || !(row->rmse > 0.0)) continue;
      const double error = row->rmse / std::sqrt(2.0 * static_cast<double>(row->count));
      points.x.push_back(row->noise_percent);
      points.y.push_back(row->rmse);
      points.y_low.push_back(row->rmse - error);
      points.y_high.push_back(row->rmse + error);
      bound.x.push_back(row->noise_percent);
      bound.y.push_back(row->bound);
    }
    if (points.x.empty()) return;
    report::Panel panel = panel_of(title, unit);
    panel.series = {std::move(points), std::move(bound)};
    figure.panels.push_back(std::move(panel));
  };
  const auto named = [](std::string name) {
    return [name = std::move(name)](const LevelSummary& level) -> const Row* {
      const auto found = std::find_if(level.rows.begin(), level.rows.end(),
                                      [&](const Row& row) { return row.parameter == name; });
      return found == level.rows.end() ? nullptr : &*found;
    };
  };
  add("f0", "Hz", named("f0"));
  add("B", "1", named("B"));
  add("x_c", "m", named("x_c"));
  add("damping factor", "1", named("damping"));
  add("x_c, frequencies free", "m", named("x_c, frequencies free"));

  report::Series ours{
      .label = "joint likelihood", .style = SeriesStyle::kPoints, .color = ColorRole::kFirst};
  report::Series paper{.label = "spectral peak (the paper)",
                       .style = SeriesStyle::kPoints,
                       .color = ColorRole::kSecond};
  report::Series bound{.label = "bound, median mode", .color = ColorRole::kReference};
  for (const LevelSummary& level : levels) {
    if (!(level.median_error > 0.0)) continue;
    ours.x.push_back(100.0 * level.level);
    ours.y.push_back(level.median_error);
    bound.x.push_back(100.0 * level.level);
    bound.y.push_back(level.median_bound);
    if (!(level.paper_error > 0.0)) continue;
    paper.x.push_back(100.0 * level.level);
    paper.y.push_back(level.paper_error);
  }
  if (!ours.x.empty()) {
    report::Panel panel = panel_of("f_n, median of the excited modes", "1");
    panel.series = {std::move(ours), std::move(bound)};
    if (!paper.x.empty()) panel.series.push_back(std::move(paper));
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

// Targets that 50 seeds can tell; fewer prove nothing.
void judge(const std::vector<LevelSummary>& levels, StudyResult& result) {
  for (const LevelSummary& level : levels) {
    if (level.runs + level.broken < 50) continue;
    const auto miss = [&](const std::string& text) {
      result.missed.push_back(fmt::format("{:g} % noise: {}", 100.0 * level.level, text));
    };
    for (const Row& row : level.rows) {
      if (!row.law) continue;
      if (!(row.ratio() <= 1.2))
        miss(fmt::format("{} at {:.2f} bounds", row.parameter, row.ratio()));
      if (!(std::abs(row.bias) <= 0.3 * row.bound)) {
        miss(fmt::format("bias of {} {:.2f} bounds", row.parameter, row.bias / row.bound));
      }
      if (!(std::abs(row.reported / row.rmse - 1.0) <= 0.25)) {
        miss(fmt::format("sd of {} reported {:.2f} of its RMSE", row.parameter,
                         row.reported / row.rmse));
      }
    }
    if (!(level.free_rms <= 1.1)) miss(fmt::format("free f_n at {:.2f} bounds", level.free_rms));
    if (!(level.free_worst <= 1.6)) {
      miss(fmt::format("worst free f_n at {:.2f} bounds", level.free_worst));
    }
    if (!(std::abs(level.mean_chi2 - 1.0) <= 0.01)) {
      miss(fmt::format("mean chi2 {:.4f}", level.mean_chi2));
    }
    if (level.failures() > 0) miss(fmt::format("{} failures", level.failures()));
  }
}

}  // namespace

StudyResult sum_up_limit(const CalibrationLimitOptions& options,
                         const std::vector<LimitLevel>& levels, const StudyContext& context) {
  const double width = options.continuation.law_width;
  std::vector<LevelSummary> summaries;
  StudyResult result;
  for (const LimitLevel& level : levels) {
    const LimitTruth truth =
        limit_truth(options.observation, level.noise_level, context.work.truths);
    const ExpectedLimit bound =
        expected_limit(truth.point, truth.records, options.continuation.highest_frequency,
                       std::isnan(width) ? 2e-3 : width);
    summaries.push_back(LevelReader(level, truth, bound).read());
    const LevelSummary& summary = summaries.back();
    result.failed_tasks += summary.broken;
    result.summary += fmt::format(
        "{:g} %: RMSE/bound f0 {:.2f}, B {:.2f}, x_c {:.2f}, damping {:.2f}, free f_n {:.2f} "
        "(worst "
        "{:.2f}); chi2 {:.4f}; median error {:.2e}, the paper's method {:.2e}; {} runs, {} "
        "failures, "
        "{} contradicted\n",
        100.0 * summary.level, summary.rows[0].ratio(), summary.rows[1].ratio(),
        summary.rows[2].ratio(), summary.rows[3].ratio(), summary.free_rms, summary.free_worst,
        summary.mean_chi2, summary.median_error, summary.paper_error, summary.runs,
        summary.failures(), summary.rejected);
  }
  judge(summaries, result);
  report::Figure figure = error_figure(summaries, context.command);
  if (!figure.panels.empty()) result.blocks.emplace_back(std::move(figure));
  const report::Table rows = row_table(summaries, context.command);
  result.files.emplace_back("calibration_limit.json", report::table_json(rows));
  result.blocks.emplace_back(level_table(summaries, context.command));
  result.blocks.emplace_back(rows);
  if (result.failed_tasks > 0) result.status = report::Status::kFailed;
  return result;
}

}  // namespace modcal
