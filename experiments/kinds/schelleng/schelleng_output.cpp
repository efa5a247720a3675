// Tables, figures and files of a Schelleng diagram.
#include <cmath>
#include <limits>

#include "experiments/kinds/schelleng/schelleng_study.hpp"
#include "experiments/study/figures.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct RegimeLook {
  const char* label;
  report::ColorRole color;
};

const RegimeLook& look_of(StringRegime regime) {
  static constexpr std::array<RegimeLook, kStringRegimes> kLooks = {
      {{"Helmholtz motion", report::ColorRole::kFirst},
       {"multiple slip", report::ColorRole::kFifth},
       {"raucous", report::ColorRole::kSecond},
       {"not sounding", report::ColorRole::kMuted}}};
  return kLooks.at(static_cast<std::size_t>(regime));
}

bool has_regime(const std::optional<CellOutcome>& outcome) {
  return outcome && outcome->failure.empty();
}

BowForceLimits limits_at(const SchellengOptions& options, std::size_t position) {
  return schelleng_limits(options.cell_scene(position));  // of the first row
}

report::Series limit_series(const SchellengOptions& options, bool highest) {
  report::Series series{
      .label = highest ? "Schelleng's maximum" : "Schelleng's minimum",
      .style = highest ? report::SeriesStyle::kLine : report::SeriesStyle::kDotted,
      .color = report::ColorRole::kReference};
  for (std::size_t i = 0; i < static_cast<std::size_t>(options.positions.count); ++i) {
    const BowForceLimits limits = limits_at(options, i);
    series.x.push_back(options.positions.center(i));
    series.y.push_back(highest ? limits.highest : limits.lowest);
  }
  return series;
}

report::CategoryMap regime_map(const SchellengOptions& options, const CellOutcomes& outcomes) {
  report::CategoryMap map{.x_edges = options.positions.edges(), .y_edges = options.forces.edges()};
  for (std::size_t i = 0; i < kStringRegimes; ++i) {
    const RegimeLook& look = look_of(static_cast<StringRegime>(i));
    map.categories.push_back({look.label, look.color});
  }
  for (const auto& outcome : outcomes) {
    map.cells.push_back(has_regime(outcome) ? static_cast<int>(outcome->regime) : -1);
  }
  return map;
}

report::Figure map_figure(const SchellengOptions& options, const CellOutcomes& outcomes,
                          const StudyContext& context) {
  report::Panel panel{.x = {.label = "bow position x_c/L", .unit = "1", .logarithmic = true},
                      .y = {.label = "bow force", .unit = "N", .logarithmic = true}};
  panel.x.range = {options.positions.lowest, options.positions.highest};
  panel.y.range = {options.forces.lowest, options.forces.highest};
  panel.map = regime_map(options, outcomes);
  panel.series = {limit_series(options, true), limit_series(options, false)};
  return {
      .id = "schelleng",
      .title = fmt::format("Motion of the string, v_bow = {:g} m/s", options.scene.bow.velocity),
      .caption = fmt::format(
          "Motion in the last {:g} periods of {:g} s, started {}. Lines: the bow-force limits "
          "of Schelleng (1973) with the losses of the modes.",
          options.criteria.periods, options.scene.duration,
          options.start == "helmholtz" ? "in ideal Helmholtz motion" : "from rest"),
      .panels = {panel},
      .command = context.command};
}

report::Table count_table(const CellOutcomes& outcomes, const std::string& command) {
  std::array<std::size_t, kStringRegimes> counts{};
  std::size_t failed = 0, pending = 0;
  for (const auto& outcome : outcomes) {
    if (!outcome) {
      ++pending;
    } else if (!outcome->failure.empty()) {
      ++failed;
    } else {
      ++counts[static_cast<std::size_t>(outcome->regime)];
    }
  }
  report::Table table{
      .id = "regimes",
      .title = "Cells of each motion",
      .columns = {{.key = "motion"},
                  {.key = "cells"},
                  {.key = "share_percent", .name = "share", .unit = "%", .format = "{:.1f}"}},
      .command = command};
  const auto add = [&](const char* name, std::size_t count) {
    table.rows.push_back(
        {name, count, 100.0 * static_cast<double>(count) / static_cast<double>(outcomes.size())});
  };
  for (std::size_t i = 0; i < kStringRegimes; ++i) {
    add(look_of(static_cast<StringRegime>(i)).label, counts[i]);
  }
  if (failed > 0) add("failed", failed);
  if (pending > 0) add("not run yet", pending);
  return table;
}

struct Spread {
  std::size_t count = 0;
  double q10 = kNaN, median = kNaN, q90 = kNaN;
};

Spread spread_of(const std::vector<double>& values) {
  std::vector<double> known;
  for (const double value : values) {
    if (std::isfinite(value)) known.push_back(value);
  }
  return {known.size(), quantile(known, 0.1), quantile(known, 0.5), quantile(known, 0.9)};
}

report::Table border_table(const Spread& lowest, const Spread& highest,
                           const std::string& command) {
  report::Table table{
      .id = "borders",
      .title = "Borders of Helmholtz motion over Schelleng's limits",
      .caption = "Over the bow positions at which the border lies on the map.",
      .columns = {{.key = "border"},
                  {.key = "positions"},
                  {.key = "median", .name = "simulated / limit, median", .format = "{:.2f}"},
                  {.key = "q10", .name = "10 %", .format = "{:.2f}"},
                  {.key = "q90", .name = "90 %", .format = "{:.2f}"}},
      .command = command};
  table.rows = {{"lowest force", lowest.count, lowest.median, lowest.q10, lowest.q90},
                {"highest force", highest.count, highest.median, highest.q10, highest.q90}};
  return table;
}

// One row a cell, with everything that was measured.
report::Table cell_table(const SchellengOptions& options, const CellOutcomes& outcomes) {
  report::Table table{.id = "map",
                      .columns = {{.key = "task"},
                                  {.key = "position", .unit = "1"},
                                  {.key = "normal_force", .unit = "N"},
                                  {.key = "motion"},
                                  {.key = "slips_per_period", .unit = "1"},
                                  {.key = "periodicity", .unit = "1"},
                                  {.key = "period", .unit = "1"},
                                  {.key = "adherence", .unit = "1"},
                                  {.key = "amplitude", .unit = "1"},
                                  {.key = "failure"}}};
  for (std::size_t cell = 0; cell < outcomes.size(); ++cell) {
    std::vector<report::Cell> row = {cell, options.positions.center(options.position_of(cell)),
                                     options.forces.center(options.force_of(cell))};
    row.resize(table.columns.size());
    if (has_regime(outcomes[cell])) {
      const RegimeFeatures& f = outcomes[cell]->features;
      row[3] = std::string(name_of(outcomes[cell]->regime));
      row[4] = f.slips_per_period;
      row[5] = f.periodicity;
      row[6] = f.period;
      row[7] = f.adherence;
      row[8] = f.amplitude;
    } else if (outcomes[cell]) {
      row[9] = outcomes[cell]->failure;
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

void add_failures(const CellOutcomes& outcomes, StudyResult& result) {
  const std::string* first = nullptr;
  for (const auto& outcome : outcomes) {
    if (!outcome) {
      ++result.pending_tasks;
    } else if (!outcome->failure.empty()) {
      if (first == nullptr) first = &outcome->failure;
      ++result.failed_tasks;
    }
  }
  if (first == nullptr) return;
  const bool all = result.failed_tasks + result.pending_tasks == outcomes.size();
  result.status = all ? report::Status::kFailed : report::Status::kSomeFailed;
  result.blocks.emplace_back(report::Text{
      .text = fmt::format("{} cells failed; the first: {}", result.failed_tasks, *first),
      .kind = report::Text::Kind::kFailure});
}

std::string summary_of(const report::Table& counts, const Spread& lowest, const Spread& highest) {
  std::string text;
  for (const auto& row : counts.rows) {
    text += fmt::format("{:<18}{:>6} cells  {:>5} %\n", cell_text(row[0], counts.columns[0]),
                        cell_text(row[1], counts.columns[1]), cell_text(row[2], counts.columns[2]));
  }
  const auto line = [](const char* name, const Spread& spread) {
    return spread.count == 0
               ? fmt::format("{} force of Helmholtz motion: not on the map\n", name)
               : fmt::format(
                     "{} force of Helmholtz motion / Schelleng's limit: {:.2f} [{:.2f}, "
                     "{:.2f}] over {} bow positions\n",
                     name, spread.median, spread.q10, spread.q90, spread.count);
  };
  return text + line("lowest", lowest) + line("highest", highest);
}

}  // namespace

StudyResult sum_up_map(const SchellengOptions& options, const CellOutcomes& outcomes,
                       const StudyContext& context) {
  StudyResult result;
  add_failures(outcomes, result);
  std::vector<double> low, high;
  for (const BorderRatios& ratios : border_ratios(options, outcomes)) {
    low.push_back(ratios.lowest);
    high.push_back(ratios.highest);
  }
  const Spread lowest = spread_of(low), highest = spread_of(high);
  report::Table counts = count_table(outcomes, context.command);
  result.summary = summary_of(counts, lowest, highest);
  result.blocks.emplace_back(map_figure(options, outcomes, context));
  result.blocks.emplace_back(std::move(counts));
  result.blocks.emplace_back(border_table(lowest, highest, context.command));
  const report::Table cells = cell_table(options, outcomes);
  result.files.emplace_back("map.csv", report::table_csv(cells));
  result.files.emplace_back("map.json", report::table_json(cells));
  return result;
}

StudyResult show_cell(const SchellengOptions& options, std::size_t cell,
                      const StudyContext& context) {
  const Scene scene = options.cell_scene(cell);
  OutputRequest outputs = OutputRequest::all();
  outputs.switches_from = judged_from(scene, options.criteria);
  const Simulation simulation =
      options.simulator.make()->simulate(scene, options.sample_rate, outputs, context.stop);
  const CellOutcome outcome = judge_cell(scene, simulation, options.criteria);
  StudyResult result;
  if (!outcome.failure.empty()) {
    result.status = report::Status::kFailed;
    result.failed_tasks = 1;
    result.summary = outcome.failure + "\n";
    result.blocks.emplace_back(
        report::Text{.text = outcome.failure, .kind = report::Text::Kind::kFailure});
    return result;
  }
  const double shown = 6.0 / scene.string.fundamental;
  FigureOptions figure{.id = "waveforms", .title = "The last periods"};
  figure.windows = {{.start = scene.duration - shown, .stop = scene.duration}};
  report::Figure drawn = simulation_figure(figure, simulation);
  drawn.command = context.command;
  result.blocks.emplace_back(std::move(drawn));
  const RegimeFeatures& f = outcome.features;
  const BowForceLimits limits = schelleng_limits(scene);
  result.summary = fmt::format(
      "{}: {:.3g} slips a period, periodicity {:.4f} at {:.4f} periods, sticking for {:.1f} % of "
      "the time, {:.3g} times as strong as Helmholtz motion\nbow force {:.4g} N; Schelleng's "
      "limits "
      "{:.4g} N and {:.4g} N\n",
      look_of(outcome.regime).label, f.slips_per_period, f.periodicity, f.period,
      100.0 * f.adherence, f.amplitude, scene.bow.normal_force, limits.lowest, limits.highest);
  result.blocks.emplace_back(report::Text{.text = result.summary});
  result.signal_files.push_back({"signals.csv",
                                 {simulation.displacement, simulation.velocity, simulation.force,
                                  simulation.left_reaction, simulation.right_reaction}});
  return result;
}

}  // namespace modcal
