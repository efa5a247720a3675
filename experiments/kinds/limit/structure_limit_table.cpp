// Errors of refined modes over noise: figure, tables and acceptance.
#include <algorithm>
#include <cmath>

#include "experiments/kinds/limit/structure_limit.hpp"
#include "experiments/study/sample.hpp"
#include "libcalib/identifiability/rms_interval.hpp"

namespace modcal {
namespace {

constexpr double kTwoSided = 1.959964;

enum class Kind { kFrequency, kDamping, kConstant };
constexpr std::array kKinds = {Kind::kFrequency, Kind::kDamping, Kind::kConstant};
constexpr std::array<std::string_view, 3> kTexts = {"frequencies", "damping ratios",
                                                    "modal constants"};

// The unknowns in their order: ln f_n, ln ζ_n of every mode, two factors of every mode and sensor.
struct Unknown {
  Kind kind;
  std::string name;
};

std::vector<Unknown> unknowns_of(std::size_t modes, const std::vector<std::string>& sensors,
                                 std::size_t count) {
  std::vector<Unknown> all;
  for (std::size_t n = 1; n <= modes; ++n) {
    all.push_back({Kind::kFrequency, fmt::format("f_{}", n)});
    all.push_back({Kind::kDamping, fmt::format("zeta_{}", n)});
  }
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    for (std::size_t n = 1; n <= modes && all.size() < count; ++n) {
      const std::string name = fmt::format("{}_{}", sensors[k], n);
      all.push_back({Kind::kConstant, name});
      all.push_back({Kind::kConstant, name + " imaginary"});
    }
  }
  return all;
}

// All unknowns of one kind at one level.
struct KindSum {
  double noise_percent = 0.0;
  std::string_view kind;
  double bound = 0.0, rmse = 0.0;  // medians over the unknowns
  double ratio = 0.0;              // root of the mean of (RMSE/bound)²
  double held = 0.0;               // share of the errors within 95 % of what is reported
  double largest = 0.0;            // error over the deviation reported
  std::size_t draws = 0, failures = 0;
};

LimitRow row_of(const StructureLimitLevel& level, std::size_t i, const Unknown& unknown) {
  LimitRow row{.noise_percent = 100.0 * level.noise_level,
               .parameter = unknown.name,
               .bound = level.bound[i]};
  double square = 0.0, sum = 0.0, variance = 0.0;
  for (const StructureLimitOutcome& outcome : level.outcomes) {
    if (!outcome.failure.empty()) continue;
    const double error = outcome.errors[i];
    ++row.count;
    square += error * error;
    sum += error;
    variance += outcome.deviations[i] * outcome.deviations[i];
    if (!(std::abs(error) <= kFailure * row.bound)) ++row.failures;
  }
  const auto n = static_cast<double>(row.count);
  if (row.count == 0) return row;
  row.rmse = std::sqrt(square / n);
  row.bias = sum / n;
  row.reported = std::sqrt(variance / n);
  return row;
}

KindSum sum_of(const StructureLimitLevel& level, const std::vector<Unknown>& unknowns,
               const std::vector<LimitRow>& rows, std::size_t kind) {
  KindSum sum{.noise_percent = 100.0 * level.noise_level, .kind = kTexts[kind]};
  Sample bounds, errors;
  double squares = 0.0, held = 0.0, count = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    // Nothing tells the phase of a constant that is 0.
    if (unknowns[i].kind != kKinds[kind] || rows[i].rmse == 0.0) continue;
    bounds.add(rows[i].bound);
    errors.add(rows[i].rmse);
    squares += rows[i].ratio() * rows[i].ratio();
    sum.failures += rows[i].failures;
    for (const StructureLimitOutcome& outcome : level.outcomes) {
      if (!outcome.failure.empty()) continue;
      const double z = std::abs(outcome.errors[i]) / outcome.deviations[i];
      sum.largest = std::max(sum.largest, z);
      held += z <= kTwoSided ? 1.0 : 0.0;
      count += 1.0;
    }
    sum.draws = rows[i].count;
  }
  if (errors.values.empty()) return sum;
  sum.bound = bounds.median();
  sum.rmse = errors.median();
  sum.ratio = std::sqrt(squares / static_cast<double>(errors.values.size()));
  sum.held = held / count;
  return sum;
}

void write_sum(report::RowWriter& row, const KindSum& sum) {
  row({.key = "noise_percent", .name = "noise", .unit = "%"}, sum.noise_percent);
  row({.key = "kind"}, sum.kind);
  row({.key = "bound", .name = "median bound", .format = "{:.2e}"}, sum.bound);
  row({.key = "rmse", .name = "median RMSE", .format = "{:.2e}"}, sum.rmse);
  row({.key = "ratio", .name = "RMSE/bound, rms", .format = "{:.3f}"}, sum.ratio);
  row({.key = "held", .name = "in 95 %", .format = "{:.3f}"}, sum.held);
  row({.key = "largest", .name = "largest error, deviations", .format = "{:.1f}"}, sum.largest);
  row({.key = "n"}, sum.draws);
  row({.key = "failures"}, sum.failures);
}

report::Figure limit_figure(const std::vector<KindSum>& sums) {
  report::Figure figure{.id = "calibration_limit_figure",
                        .title = "Errors of refined modes against noise",
                        .caption =
                            "Points: RMSE over the draws, median of the modes; line: "
                            "Cramér-Rao bound with the force unknown.",
                        .columns = kKinds.size()};
  for (const std::string_view kind : kTexts) {
    report::Series points{.label = "refined",
                          .style = report::SeriesStyle::kPoints,
                          .color = report::ColorRole::kFirst};
    report::Series bound{.label = "bound", .color = report::ColorRole::kReference};
    for (const KindSum& sum : sums) {
      if (sum.kind != kind || sum.draws == 0) continue;
      points.add(sum.noise_percent, sum.rmse);
      bound.add(sum.noise_percent, sum.bound);
    }
    report::Panel panel{.title = std::string(kind),
                        .x = {.label = "noise", .unit = "%", .logarithmic = true},
                        .y = {.label = "relative error", .unit = "1", .logarithmic = true}};
    add_drawn(panel, std::move(points));
    add_drawn(panel, std::move(bound));
    if (!panel.series.empty()) figure.panels.push_back(std::move(panel));
  }
  return figure;
}

std::string line_of(const KindSum& sum) {
  return fmt::format("{:g} %: {} RMSE/bound {:.2f}, {:.1f} % within 95 %, largest {:.1f} sd\n",
                     sum.noise_percent, sum.kind, sum.ratio, 100.0 * sum.held, sum.largest);
}

// What 20 draws and more can tell.
void judge(const KindSum& sum, StudyResult& result) {
  if (sum.draws < 20) return;
  const auto miss = [&](const std::string& text) {
    result.missed.push_back(fmt::format("{:g} % noise, {}: {}", sum.noise_percent, sum.kind, text));
  };
  if (sum.failures > 0) miss(fmt::format("{} errors beyond 7.8 bounds", sum.failures));
  if (!(sum.ratio <= 1.2)) miss(fmt::format("RMSE {:.2f} bounds", sum.ratio));
  if (!(sum.held >= 0.9)) miss(fmt::format("{:.1f} % within 95 %", 100.0 * sum.held));
}

}  // namespace

void StructureLimitOutcome::visit(ResultVisitor& visitor) {
  visitor({.key = "failure", .optional = true}, failure);
  if (!failure.empty()) return;
  visitor({.key = "errors"}, errors);
  visitor({.key = "deviations"}, deviations);
}

void sum_up_structure_limit(const std::vector<double>& frequencies,
                            const std::vector<std::string>& sensors,
                            const std::vector<StructureLimitLevel>& levels, StudyResult& result) {
  std::vector<LimitRow> all;
  std::vector<KindSum> sums;
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  std::size_t runs = 0, failures = 0;
  for (const StructureLimitLevel& level : levels) {
    const std::vector<Unknown> unknowns =
        unknowns_of(frequencies.size(), sensors, level.bound.size());
    std::vector<LimitRow> rows;
    for (std::size_t i = 0; i < level.bound.size(); ++i) {
      rows.push_back(row_of(level, i, unknowns[i]));
    }
    runs += level.outcomes.size();
    for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
      const KindSum& sum = sums.emplace_back(sum_of(level, unknowns, rows, kind));
      if (sum.draws == 0) continue;
      result.summary += line_of(sum);
      failures += sum.failures;
      judge(sum, result);
      if (kKinds[kind] != Kind::kFrequency) continue;
      least = std::min(least, sum.ratio);
      most = std::max(most, sum.ratio);
    }
    std::ranges::move(rows, std::back_inserter(all));
  }
  result.answer = most > 0.0 ? fmt::format(
                                   "Errors of the frequencies are {:.2f} to {:.2f} times their "
                                   "bounds; of {} runs {} errors are beyond 7.8 bounds",
                                   least, most, runs, failures)
                             : "No error could be compared with its bound";
  report::Figure figure = limit_figure(sums);
  if (!figure.panels.empty()) result.blocks.emplace_back(std::move(figure));
  result.blocks.emplace_back(
      report::table_of({.id = "calibration_limit_kinds",
                        .title = "Errors over bounds",
                        .caption = "Relative errors of the refined modes; the bound counts what "
                                   "the table tells, too."},
                       sums, write_sum));
  const report::Table rows = limit_table(all);
  result.files.emplace_back("calibration_limit.json", report::table_json(rows));
  result.blocks.emplace_back(rows);
  if (result.failed_tasks > 0) result.status = report::Status::kFailed;
}

}  // namespace modcal
